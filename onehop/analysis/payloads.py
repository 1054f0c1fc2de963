"""Wire messages for people: payloads between robots decoded, scans as numbers, names of the thesis."""

from collections.abc import Mapping
from typing import Any

import msgpack
import numpy as np

from onehop.contracts.errors import DecodeError
from onehop.contracts.printable import ids_in_words
from onehop.wire.codec import UNPACK_REFUSALS, as_map
from robot_agent.core.team.team_messages import (
    Ack,
    Beacon,
    Command,
    CommandKind,
    Join,
    MissionPhase,
    TeamMessage,
    decode,
)

_COMMANDS = {
    CommandKind.NEXT: "Next",
    CommandKind.LOST_FOLLOWER: "Lost_Follower",
    CommandKind.NARROW: "Narrow",
    CommandKind.MAKE_ROOM: "Make_Room",
}


def decoded_fields(data: bytes) -> Any:
    """A wire message as maps and lists, scan and payloads included. Raises DecodeError."""
    try:
        return _decoded(msgpack.unpackb(data))
    except UNPACK_REFUSALS as error:
        raise DecodeError(f"not msgpack: {error}") from None


def _decoded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _decoded_field(key, inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_decoded(inner) for inner in value]
    return value


def _decoded_field(key: str, value: Any) -> Any:
    if key == "scan" and isinstance(value, bytes) and len(value) % 4 == 0:
        return np.frombuffer(value, dtype="<f4").tolist()
    if key == "payload" and isinstance(value, bytes):
        message = decode_payload(value)
        return value.hex() if message is None else {"kind": kind_of(message), **_plain(message)}
    return _decoded(value)


def decode_payload(payload: bytes) -> TeamMessage | None:
    """The team message in a payload, None if it is none."""
    try:
        return decode(payload)
    except DecodeError:
        return None


def kind_of(message: TeamMessage | None) -> str:
    """Name of a team message as the thesis has it: Setup, Next, Narrow, Lost_Follower, Ack, ...

    "other" is what another program says.
    """
    if isinstance(message, Command):
        if message.kind is CommandKind.NEXT and message.phase is MissionPhase.SETUP:
            return "Setup"
        return _COMMANDS[message.kind]
    return "other" if message is None else type(message).__name__


def summary_of(message: TeamMessage | None) -> str:
    """What a team message says, in a few words."""
    if isinstance(message, Command):
        roster = message.roster
        lost = f", lost {ids_in_words(message.lost)}" if message.lost else ""
        return f"epoch {roster.epoch}, leader {roster.leader} of {ids_in_words(roster.members)}{lost}"
    if isinstance(message, Ack):
        return f"epoch {message.epoch}, {'in its slot' if message.in_position else 'on its way'}"
    if isinstance(message, Beacon):
        roster = message.roster
        return f"epoch {roster.epoch}, leader {roster.leader} of {ids_in_words(roster.members)}"
    if isinstance(message, Join):
        return f"asks to be taken in, epoch {message.epoch}"
    return ""


def _plain(message: TeamMessage) -> Mapping[str, Any]:
    plain: Mapping[str, Any] = as_map(message)
    return plain
