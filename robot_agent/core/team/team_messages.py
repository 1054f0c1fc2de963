"""What robots of a team say to each other: schema version, encoding, strict decoding.

One msgpack array a message, [schema, kind, fields...], and a checksum over it: bytes may be altered past
the checks of the link. Nothing is coerced; whatever is not exactly one of these messages raises
DecodeError, which the receiver counts and drops. Lengths are in centimetres as integers inside a trail
and a lane only, so that a Next of a large team stays within one MSDU of 800 B.
"""

import math
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias, TypeVar

import msgpack

from onehop.contracts.errors import DecodeError
from onehop.contracts.geometry import Pose
from onehop.contracts.serial_numbers import LIMIT
from robot_agent.core.team.roster import Roster

SCHEMA = 3
"""Version of the team's messages; any other is refused."""

CHECKSUM_BYTES = 4
"""CRC-32 (ISO 3309, as zlib computes it), little-endian, of all that stands before it [B]."""

MAX_ID = 2**31
MAX_MEMBERS = 1024
MAX_TRAIL = 64
MAX_COORDINATE = 1e7
"""Bounds of what a sane team can say; [m] for the coordinate."""


class CommandKind(StrEnum):
    """The modes that a leader commands (thesis Algorithm 1, step 2); Lost_Leader needs no message.

    Make room is ours (lane.py).
    """

    NEXT = "next"
    LOST_FOLLOWER = "lost follower"
    NARROW = "narrow"
    MAKE_ROOM = "make room"


class MissionPhase(StrEnum):
    """How far the mission is: gathering, on the way, or at its end."""

    SETUP = "setup"
    DRIVING = "driving"
    FINAL = "final"


@dataclass(frozen=True, slots=True)
class Command:
    """Next, Lost_Follower or Narrow: the roster, the shape (narrow or not) and the leader's pose.

    sequence: counts a leader's commands; an acknowledgement names it. lost: ids given up with this
    roster. trail: where the leader came from, oldest first [m]; empty in profile `thesis`. lane: the
    two ends of the piece of its way that is to be kept clear [m]; empty when none is.
    """

    kind: CommandKind
    roster: Roster
    sequence: int
    phase: MissionPhase
    narrow: bool
    pose: Pose
    lost: tuple[int, ...]
    trail: tuple[tuple[float, float], ...]
    lane: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Ack:
    """A follower's answer to a command: where it is, and whether it is in its slot."""

    epoch: int
    sequence: int
    in_position: bool
    pose: Pose


@dataclass(frozen=True, slots=True)
class Beacon:
    """A leader's word to everyone in range, once a period (profile `team`)."""

    roster: Roster
    phase: MissionPhase
    narrow: bool
    pose: Pose


@dataclass(frozen=True, slots=True)
class Join:
    """A robot without a leader asks one to take it in, and says how far its own epochs went."""

    epoch: int
    pose: Pose


TeamMessage: TypeAlias = Command | Ack | Beacon | Join
Fields: TypeAlias = list[object]
Word = TypeVar("Word", bound=StrEnum)


def encode(message: TeamMessage) -> bytes:
    """The payload of a message."""
    kind, fields = _ENCODERS[type(message)](message)
    return sealed(msgpack.packb([SCHEMA, kind, *fields]))


def sealed(content: bytes) -> bytes:
    """Content and its checksum: a payload."""
    return content + zlib.crc32(content).to_bytes(CHECKSUM_BYTES, "little")


def decode(payload: bytes) -> TeamMessage:
    """The message in a payload; DecodeError for anything that is not exactly one."""
    packed = payload[:-CHECKSUM_BYTES]
    if sealed(packed) != payload:
        raise DecodeError("altered on its way, or no team message: its checksum is wrong")
    try:
        content = msgpack.unpackb(packed, strict_map_key=True)
    except (ValueError, TypeError, msgpack.UnpackException, RecursionError) as error:
        raise DecodeError("not msgpack") from error
    if type(content) is not list or len(content) < 2:
        raise DecodeError("not a team message")
    if type(content[0]) is not int or content[0] != SCHEMA:
        raise DecodeError("unknown schema version")
    decoder = _DECODERS.get(content[1]) if type(content[1]) is str else None
    if decoder is None:
        raise DecodeError("unknown kind of message")
    length, build = decoder
    fields = content[2:]
    if len(fields) != length:
        raise DecodeError("wrong number of fields")
    return build(fields)


def _pose_fields(pose: Pose) -> Fields:
    return [pose.x, pose.y, pose.heading]


def _centimetres(points: tuple[tuple[float, float], ...]) -> list[int]:
    return [round(100.0 * value) for point in points for value in point]


def _encode_command(message: Command) -> tuple[str, Fields]:
    return "command", [
        message.kind.value, message.roster.epoch, message.roster.members, message.sequence,
        message.phase.value, message.narrow, *_pose_fields(message.pose), message.lost,
        _centimetres(message.trail), _centimetres(message.lane),
    ]  # fmt: skip


def _encode_ack(message: Ack) -> tuple[str, Fields]:
    return "ack", [message.epoch, message.sequence, message.in_position, *_pose_fields(message.pose)]


def _encode_beacon(message: Beacon) -> tuple[str, Fields]:
    roster = message.roster
    return "beacon", [
        roster.epoch, roster.members, message.phase.value, message.narrow, *_pose_fields(message.pose),
    ]  # fmt: skip


def _encode_join(message: Join) -> tuple[str, Fields]:
    return "join", [message.epoch, *_pose_fields(message.pose)]


def _decode_command(fields: Fields) -> Command:
    kind, epoch, members, sequence, phase, narrow, x, y, heading, lost, trail, lane = fields
    return Command(
        kind=_word(CommandKind, kind),
        roster=_roster(epoch, members),
        sequence=_whole(sequence),
        phase=_word(MissionPhase, phase),
        narrow=_flag(narrow),
        pose=_pose(x, y, heading),
        lost=_ids(lost),
        trail=_points(trail),
        lane=_lane(lane),
    )


def _decode_ack(fields: Fields) -> Ack:
    epoch, sequence, in_position, x, y, heading = fields
    return Ack(_whole(epoch), _whole(sequence), _flag(in_position), _pose(x, y, heading))


def _decode_beacon(fields: Fields) -> Beacon:
    epoch, members, phase, narrow, x, y, heading = fields
    return Beacon(
        _roster(epoch, members), _word(MissionPhase, phase), _flag(narrow), _pose(x, y, heading)
    )


def _decode_join(fields: Fields) -> Join:
    epoch, x, y, heading = fields
    return Join(_whole(epoch), _pose(x, y, heading))


def _whole(value: object) -> int:
    if type(value) is not int or not 0 <= value < LIMIT:
        raise DecodeError("a count is not a whole number in range")
    return value


def _flag(value: object) -> bool:
    if type(value) is not bool:
        raise DecodeError("a flag is not true or false")
    return value


def _word(words: type[Word], value: object) -> Word:
    if type(value) is not str:
        raise DecodeError("a word is not text")
    try:
        return words(value)
    except ValueError as error:
        raise DecodeError(f"unknown word for {words.__name__}") from error


def _ids(value: object) -> tuple[int, ...]:
    if type(value) is not list or len(value) > MAX_MEMBERS:
        raise DecodeError("ids are not a list")
    previous = 0
    for robot in value:
        if type(robot) is not int or not previous < robot < MAX_ID:
            raise DecodeError("ids are not whole numbers in rising order")
        previous = robot
    return tuple(value)


def _roster(epoch: object, members: object) -> Roster:
    ids = _ids(members)
    if not ids:
        raise DecodeError("a roster of nobody")
    return Roster(_whole(epoch), ids)


def _metres(value: object) -> float:
    if type(value) is not float or not math.isfinite(value) or abs(value) > MAX_COORDINATE:
        raise DecodeError("a coordinate is not a finite number in range")
    return value


def _pose(x: object, y: object, heading: object) -> Pose:
    return Pose(_metres(x), _metres(y), _metres(heading))


def _points(value: object) -> tuple[tuple[float, float], ...]:
    if type(value) is not list or len(value) % 2 or len(value) > 2 * MAX_TRAIL:
        raise DecodeError("points are not a list of pairs")
    for coordinate in value:
        if type(coordinate) is not int or abs(coordinate) > 100 * MAX_COORDINATE:
            raise DecodeError("a point holds something that is no coordinate")
    return tuple((x / 100.0, y / 100.0) for x, y in zip(value[::2], value[1::2], strict=True))


def _lane(value: object) -> tuple[tuple[float, float], ...]:
    lane = _points(value)
    if len(lane) not in (0, 2):
        raise DecodeError("a lane has two ends")
    return lane


_ENCODERS: dict[type, Callable[..., tuple[str, Fields]]] = {
    Command: _encode_command,
    Ack: _encode_ack,
    Beacon: _encode_beacon,
    Join: _encode_join,
}
_DECODERS: dict[str, tuple[int, Callable[[Fields], TeamMessage]]] = {
    "command": (12, _decode_command),
    "ack": (6, _decode_ack),
    "beacon": (7, _decode_beacon),
    "join": (4, _decode_join),
}
