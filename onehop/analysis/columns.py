"""The tables of a log: each column once, with its name, its place in the message and its kind.

TABLES is all that there is to say about a table; reading (tables.py), the page docs/reading-logs.md and
its test follow from it.
"""

from collections.abc import Callable, Sequence
from functools import partial
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from onehop.contracts.messages import Action, RadioRecord, Truth

Column = npt.NDArray[Any]
"""One value a row."""

Parts = Callable[[Any], Sequence[Any]]
"""Takes a message, gives the part of it from which each row is made."""

BUS_KEY = "the bus key"
"""Place of the id of the robot whose message it is: in the key, not in the message."""


class Kind(NamedTuple):
    """column: makes a column of values. value: applied to each value as it is read, if anything is."""

    column: Callable[[Sequence[Any]], Column]
    value: Callable[[Any], Any] | None = None


def _array(dtype: npt.DTypeLike) -> Callable[[Sequence[Any]], Column]:
    return partial(np.array, dtype=dtype)


_INT64 = np.iinfo(np.int64)


def _integers(values: Sequence[int]) -> Column:
    """The wire carries whole numbers up to 2^64: beyond int64 the nearest that there is."""
    try:
        return np.array(values, dtype=np.int64)
    except OverflowError:
        return np.array([min(max(value, _INT64.min), _INT64.max) for value in values], dtype=np.int64)


def _objects(values: Sequence[Any]) -> Column:
    column = np.empty(len(values), dtype=object)
    column[:] = values
    return column


def _seconds(values: Sequence[int]) -> Column:
    return _integers(values) / 1e9


def _seconds_if_any(values: Sequence[int]) -> Column:
    times = _integers(values)
    return np.where(times >= 0, times / 1e9, np.nan)


def _matrix(scans: Sequence[npt.NDArray[np.float32]]) -> Column:
    longest = max(map(len, scans), default=0)
    matrix = np.full((len(scans), longest), np.nan, dtype=np.float32)
    for row, scan in enumerate(scans):
        matrix[row, : len(scan)] = scan
    return matrix


INTEGER = Kind(_integers)
REAL = Kind(_array(np.float64))
WORD = Kind(_array(np.str_))
FLAG = Kind(_array(np.bool_))
OBJECT = Kind(_objects)
"""Bytes and maps as they are."""

INTEGERS = Kind(_objects)
"""Tuples of different length."""

TOTAL = Kind(_integers, sum)
"""Sum of a list of whole numbers."""

SECONDS = Kind(_seconds)
"""From ns."""

SECONDS_IF_ANY = Kind(_seconds_if_any)
"""From ns; a negative time stands for never, and is nan."""

RANGES = Kind(_matrix)
"""Laser scans as a matrix, (rows, n_beams) float32 [m]; nan behind the beams of who has fewer."""


class ColumnSpec(NamedTuple):
    """place: where it is in the part of its row, e.g. "pose.x", or BUS_KEY; "" is its own name."""

    name: str
    kind: Kind
    place: str = ""


class TableSpec(NamedTuple):
    """row: what a row is, for people. key: bus key of its messages; "/" at its end: of each robot."""

    row: str
    key: str
    parts: Parts
    columns: tuple[ColumnSpec, ...]


def _whole(message: Any) -> Sequence[Any]:
    """One row a message."""
    return (message,)


def _of_team(action: Action) -> Sequence[Action]:
    """Nothing of a robot whose program has no team."""
    return (action,) if action.status is not None else ()


def _values(action: Action) -> Sequence[tuple[str, float]]:
    return [_ShownValue(*item) for item in action.values.items()]


class _ShownValue(NamedTuple):
    name: str
    value: float


class _Request(NamedTuple):
    robot: int
    destination: int
    msdu_bytes: int
    lifetime_ns: int
    payload: bytes


def _requests(truth: Truth) -> Sequence[_Request]:
    return [
        _Request(request.robot, sent.destination, sent.msdu_bytes, sent.lifetime_ns, sent.payload)
        for request in truth.transmit_requests
        for sent in request.outbox
    ]


class _Impairment(NamedTuple):
    robot: int
    how: str
    delay_ticks: int


def _impaired(truth: Truth) -> Sequence[_Impairment]:
    return [
        *(_Impairment(robot, "stopped", 0) for robot in truth.stopped),
        *(_Impairment(robot, "blind", 0) for robot in truth.blind),
        *(_Impairment(one.robot, "slow", one.delay_ticks) for one in truth.slow),
    ]


class _ControlBytes(NamedTuple):
    kind: str
    bytes: int


def _control(record: RadioRecord) -> Sequence[_ControlBytes]:
    return [_ControlBytes(*item) for item in sorted(record.control_bytes.items())]


_C = ColumnSpec

TABLES: dict[str, TableSpec] = {
    "poses": TableSpec(
        "a robot at a tick, ground truth", "truth", attrgetter("present"),
        (
            _C("robot", INTEGER), _C("incarnation", INTEGER),
            _C("x", REAL, "pose.x"), _C("y", REAL, "pose.y"), _C("heading", REAL, "pose.heading"),
            _C("v", REAL, "twist.v"), _C("w", REAL, "twist.w"), _C("held", FLAG),
        ),
    ),
    "status": TableSpec(
        "what a robot says of its team", "out/", _of_team,
        (
            _C("robot", INTEGER, BUS_KEY), _C("incarnation", INTEGER), _C("mode", WORD, "status.mode"),
            _C("epoch", INTEGER, "status.epoch"), _C("leader", INTEGER, "status.leader"),
            _C("members", INTEGERS, "status.members"), _C("shape", WORD, "status.shape"),
            _C("throughput_bps", REAL, "status.throughput_bps"),
            _C("threshold_bps", REAL, "status.threshold_bps"),
            _C("k_rho", REAL, "status.k_rho"), _C("error", REAL, "status.error"),
            _C("target_x", REAL, "status.target_x"), _C("target_y", REAL, "status.target_y"),
            _C("v", REAL, "twist.v"), _C("w", REAL, "twist.w"), _C("remaining_distance", REAL),
        ),
    ),
    "values": TableSpec(
        "a number that a program shows", "out/", _values,
        (_C("robot", INTEGER, BUS_KEY), _C("name", WORD), _C("value", REAL)),
    ),
    "notes": TableSpec(
        "an event that a robot notes", "out/", attrgetter("notes"),
        (_C("robot", INTEGER, BUS_KEY), _C("kind", WORD), _C("data", OBJECT)),
    ),
    "verdicts": TableSpec(
        "what became of a message", "radio", attrgetter("verdicts"),
        (
            _C("source", INTEGER), _C("message", INTEGER), _C("destination", INTEGER),
            _C("receiver", INTEGER), _C("status", WORD), _C("msdu_bytes", INTEGER),
            _C("path", INTEGERS), _C("attempts", TOTAL), _C("offered_s", SECONDS, "offered_ns"),
            _C("service_start_s", SECONDS, "service_start_ns"),
            _C("arrival_s", SECONDS_IF_ANY, "arrival_ns"),
            _C("discovery_s", SECONDS, "discovery_ns"), _C("queueing_s", SECONDS, "queueing_ns"),
            _C("snr_db", REAL), _C("bit_error_rate", REAL),
        ),
    ),
    "receptions": TableSpec(
        "a message that arrived", "rx/", attrgetter("receptions"),
        (
            _C("robot", INTEGER, BUS_KEY), _C("source", INTEGER),
            _C("service_start_s", SECONDS, "service_start_ns"), _C("arrival_s", SECONDS, "arrival_ns"),
            _C("hops", INTEGER), _C("attempts", INTEGER), _C("snr_db", REAL),
            _C("bit_error_rate", REAL), _C("msdu_bytes", INTEGER), _C("payload", OBJECT),
        ),
    ),
    "neighbours": TableSpec(
        "a robot that another one's card heard (`radio.neighbours`)", "rx/", attrgetter("neighbours"),
        (
            _C("robot", INTEGER, BUS_KEY), _C("neighbour", INTEGER, "robot"), _C("snr_db", REAL),
            _C("rssi_dbm", REAL), _C("heard_s", SECONDS, "time_ns"), _C("frames", INTEGER),
        ),
    ),
    "transmit_requests": TableSpec(
        "a message handed to the radio", "truth", _requests,
        (
            _C("robot", INTEGER), _C("destination", INTEGER), _C("msdu_bytes", INTEGER),
            _C("lifetime_s", SECONDS, "lifetime_ns"), _C("payload", OBJECT),
        ),
    ),
    "control": TableSpec(
        "what routing cost since the start", "radio", _control,
        (_C("kind", WORD), _C("bytes", INTEGER)),
    ),
    "contacts": TableSpec(
        "a collision", "truth", attrgetter("contacts"),
        (_C("robot", INTEGER), _C("other", INTEGER), _C("x", REAL), _C("y", REAL)),
    ),
    "departures": TableSpec(
        "a robot that left", "truth", attrgetter("departures"), (_C("robot", INTEGER), _C("why", WORD)),
    ),
    "cuts": TableSpec(
        "a cut in force", "truth", attrgetter("cuts"),
        (_C("side_a", INTEGERS), _C("side_b", INTEGERS), _C("one_way", FLAG)),
    ),
    "jams": TableSpec(
        "a jam in force", "truth", attrgetter("jams"),
        (_C("x", REAL), _C("y", REAL), _C("radius", REAL), _C("noise_dbm", REAL)),
    ),
    "corruptions": TableSpec(
        "a corruption in force", "truth", attrgetter("corruptions"),
        (_C("robots", INTEGERS), _C("probability", REAL)),
    ),
    "impaired": TableSpec(
        "a robot that is stopped, blind or slow", "truth", _impaired,
        (_C("robot", INTEGER), _C("how", WORD), _C("delay_ticks", INTEGER)),
    ),
    "faults": TableSpec(
        "a fault that begins, by script or by hand", "truth", attrgetter("faults"),
        (
            _C("kind", WORD), _C("at_s", REAL), _C("robots", INTEGERS), _C("others", INTEGERS),
            _C("duration_s", REAL), _C("x", REAL), _C("y", REAL), _C("heading_deg", REAL),
            _C("radius", REAL), _C("noise_dbm", REAL), _C("direction", WORD), _C("probability", REAL),
            _C("delay_ticks", INTEGER),
        ),
    ),
    "scans": TableSpec(
        "a laser scan (`ranges` is a matrix)", "obs/", _whole,
        (_C("robot", INTEGER, BUS_KEY), _C("ranges", RANGES, "scan")),
    ),
}  # fmt: skip


def markdown() -> str:
    """The tables and their columns as docs/reading-logs.md shows them."""
    rows = [
        f"| `{name}` | {table.row} | `{' '.join(column.name for column in table.columns)}` |"
        for name, table in TABLES.items()
    ]
    return "\n".join(["| table | a row is | columns |", "|---|---|---|", *rows])
