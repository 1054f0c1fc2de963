"""What a robot put, as the action that it should be: read in the same way whoever carried it."""

from onehop.contracts.action_limits import ActionLimits
from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import Action
from onehop.contracts.printable import LONGEST, printable
from onehop.wire.codec import decode


def action_in(data: bytes, limits: ActionLimits) -> Action:
    """Raises DecodeError, with the reason for which its robot is fenced, for anything else."""
    most = limits.action_bytes
    try:
        if len(data) > most:
            raise DecodeError(f"{len(data)} bytes, and an action has at most {most}")
        return decode(Action, data)
    except DecodeError as error:
        raise DecodeError(f"put no action: {error}") from None


def failed(reason: str) -> str:
    """Why a robot is fenced whose program says that it has failed."""
    return printable(f"its program failed: {reason}", LONGEST)
