"""One program in its robot: asked for each tick, and held to be anybody's.

What it does is what would travel from its process to the world, also where all runs in one process. What
it fails at becomes a ProgramError, with a reason in one line that is the same in every driver: no path,
no address, no line of ours.
"""

import re
import traceback
from collections.abc import Iterable
from types import FrameType

import msgspec

from onehop.contracts import messages
from onehop.contracts.briefings import Briefing
from onehop.contracts.errors import InputError
from onehop.contracts.geometry import Twist
from onehop.contracts.messages import Percept
from onehop.contracts.printable import printable
from onehop.plugins import plugged
from onehop.programs.find import find, parameters_of
from onehop.robot import Action
from onehop.wire.codec import encode

REASON_LETTERS = 300
"""Of a reason; the log of a mission has it whole."""

ACCOUNT_LINES = 60
"""Of a traceback that people are shown."""

_FRAMES = 3
"""Of the first and of the last calls that a reason names."""

_ADDRESS = re.compile(r"0x[0-9a-f]{6,}", re.IGNORECASE)


class ProgramError(Exception):
    """A program has failed: nothing more can be had of it.

    reason: what and where, in one printable line. account: the same for whoever has to mend it, as a
    block of lines.
    """

    def __init__(self, reason: str, account: str) -> None:
        super().__init__(reason)
        self.reason = printable(_ADDRESS.sub("0x...", reason), REASON_LETTERS)
        self.account = _shortened(account)


class Host:
    """One process of one robot. A program that cannot start fails at its first tick."""

    def __init__(self, briefing: Briefing) -> None:
        self._incarnation = briefing.incarnation
        self._failure: ProgramError | None = None
        try:
            kind = find(briefing.program)
            own = parameters_of(kind, briefing.parameters, briefing.program, "parameters")
            self._program = kind(msgspec.structs.replace(plugged(briefing), parameters=own))
        except InputError as error:
            self._failure = ProgramError(str(error), str(error))
        except (Exception, SystemExit) as error:
            self._failure = _failure(error)

    def step(self, percept: Percept) -> bytes:
        """Its action at this tick, as it goes on the wire. Raises ProgramError."""
        if self._failure is not None:
            raise self._failure
        try:
            said = self._program.step(percept)
        except (Exception, SystemExit) as error:
            self._failure = _failure(error)
            raise self._failure from None
        try:
            return encode(self._on_wire(said, percept.tick))
        except (TypeError, ValueError, AttributeError, OverflowError, RecursionError) as error:
            what = f"its step gave what is no Action that can be sent: {error}"
            self._failure = ProgramError(what, f"{what}\n{printable(repr(said))}")
            raise self._failure from None

    def _on_wire(self, said: Action, tick: int) -> messages.Action:
        if not isinstance(said, Action):
            raise TypeError(f"{type(said).__name__}")
        v, w = float(said.twist.v), float(said.twist.w)
        values = said.values
        return messages.Action(
            tick=tick,
            incarnation=self._incarnation,
            twist=Twist(v, w),
            outbox=said.outbox,  # type: ignore[arg-type]  # a list becomes a tuple on the way
            speed=abs(v),
            remaining_distance=float(said.remaining_distance),
            status=said.status,
            notes=said.notes,  # type: ignore[arg-type]
            values={name: float(value) for name, value in values.items()} if values else {},
        )


def hang_of(frame: FrameType, limit_s: float) -> ProgramError:
    """What to say of a program that does not come back. frame: where its thread is now."""
    stack = [(one, line) for one, line in traceback.walk_stack(frame)][::-1]
    inside = next((n for n, (one, _) in enumerate(stack) if one.f_code is Host.step.__code__), -1)
    own = stack[inside + 1 :]
    reason = f"no answer for {limit_s:g} s, {_places(own)}"
    lines = traceback.StackSummary.extract(iter(own)).format()
    return ProgramError(reason, f"{reason}\nTraceback (most recent call last):\n{''.join(lines)}")


def _failure(error: BaseException) -> ProgramError:
    """What a program has raised, told without our own frames."""
    trace = error.__traceback__
    trace = trace.tb_next if trace is not None else None
    words = " ".join("".join(traceback.format_exception_only(error)).split())
    is_deep = isinstance(error, RecursionError)  # how deep it got depends on who called it
    place = _places(list(traceback.walk_tb(trace)), with_last=not is_deep)
    account = "".join(traceback.format_exception(type(error), error, trace))
    return ProgramError(f"{words[: REASON_LETTERS // 2]} {place}", account)


def _places(calls: list[tuple[FrameType, int]], with_last: bool = True) -> str:
    """The first and the last calls by module, line and function; the innermost one stands last."""
    names = [
        f"{frame.f_globals.get('__name__', '?')}:{line} {frame.f_code.co_name}" for frame, line in calls
    ]
    if len(names) > 2 * _FRAMES:
        names = [*names[:_FRAMES], "...", *(names[-_FRAMES:] if with_last else ())]
    return f"in {' > '.join(names)}" if names else "before its first line"


def _shortened(account: str) -> str:
    lines: Iterable[str] = account.rstrip().splitlines()
    shown = [printable(line) for line in lines]
    if len(shown) > ACCOUNT_LINES:
        half = ACCOUNT_LINES // 2
        shown = [*shown[:half], f"  ... {len(shown) - 2 * half} lines more", *shown[-half:]]
    return "\n".join(shown)
