"""Messages of a log as columns: one NumPy array a field, one row a message or a part of one.

Every table has the columns tick and time_s (simulated). Ids are int64, quantities float64 in SI units or
with the unit in the name, words are text, and what varies in length (members, path, payload, data) is an
object column of tuples, bytes or maps.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import msgpack
import numpy as np
import numpy.typing as npt

from onehop.wire.selection import Selected

Column = npt.NDArray[Any]
Row = tuple[Any, ...]
Rows = Callable[[dict[str, Any], int], Iterator[Row]]


class Table(dict[str, Column]):
    """Columns of equal length by name."""

    def __len__(self) -> int:
        """Number of rows, not of columns."""
        return len(next(iter(self.values()))) if self.keys() else 0

    def where(self, mask: Column) -> "Table":
        """The rows that a boolean array or an array of indices picks."""
        return Table({name: column[mask] for name, column in self.items()})

    def of(self, robot: int) -> "Table":
        """The rows of one robot."""
        return self.where(self["robot"] == robot)

    def to_polars(self) -> Any:
        """The same as a polars.DataFrame; needs the extra `tables`."""
        import polars

        return polars.DataFrame({name: column.tolist() for name, column in self.items()})


def _poses(truth: dict[str, Any], _: int) -> Iterator[Row]:
    for one in truth["present"]:
        pose, twist = one["pose"], one["twist"]
        yield (
            one["robot"], one["incarnation"], pose["x"], pose["y"], pose["heading"],
            twist["v"], twist["w"], one["held"],
        )  # fmt: skip


def _status(action: dict[str, Any], robot: int) -> Iterator[Row]:
    status, twist = action["status"], action["twist"]
    yield (
        robot, action["incarnation"], status["mode"], status["epoch"], status["leader"],
        tuple(status["members"]), status["shape"], status["throughput_bps"], status["threshold_bps"],
        status["k_rho"], status["error"], status["target_x"], status["target_y"],
        twist["v"], twist["w"], action["remaining_distance"],
    )  # fmt: skip


def _notes(action: dict[str, Any], robot: int) -> Iterator[Row]:
    for note in action["notes"]:
        yield robot, note["kind"], note["data"]


def _verdicts(record: dict[str, Any], _: int) -> Iterator[Row]:
    for one in record["verdicts"]:
        yield (
            one["source"], one["message"], one["destination"], one["receiver"], one["status"],
            one["msdu_bytes"], tuple(one["path"]), sum(one["attempts"]), one["offered_ns"] / 1e9,
            one["service_start_ns"] / 1e9, one["arrival_ns"] / 1e9 if one["arrival_ns"] >= 0 else np.nan,
            one["discovery_ns"] / 1e9, one["queueing_ns"] / 1e9, one["snr_db"], one["bit_error_rate"],
        )  # fmt: skip


def _control(record: dict[str, Any], _: int) -> Iterator[Row]:
    yield from sorted(record["control_bytes"].items())


def _receptions(inbox: dict[str, Any], robot: int) -> Iterator[Row]:
    for one in inbox["receptions"]:
        yield (
            robot, one["source"], one["service_start_ns"] / 1e9, one["arrival_ns"] / 1e9, one["hops"],
            one["attempts"], one["snr_db"], one["bit_error_rate"], one["msdu_bytes"], one["payload"],
        )  # fmt: skip


def _offers(truth: dict[str, Any], _: int) -> Iterator[Row]:
    for offer in truth["transmit_requests"]:
        for sent in offer["outbox"]:
            yield offer["robot"], sent["destination"], sent["msdu_bytes"], sent["payload"]


def _contacts(truth: dict[str, Any], _: int) -> Iterator[Row]:
    for one in truth["contacts"]:
        yield one["robot"], one["other"], one["x"], one["y"]


def _departures(truth: dict[str, Any], _: int) -> Iterator[Row]:
    for one in truth["departures"]:
        yield one["robot"], one["why"]


def _cuts(truth: dict[str, Any], _: int) -> Iterator[Row]:
    for one in truth["cuts"]:
        yield tuple(one["side_a"]), tuple(one["side_b"])


def _jams(truth: dict[str, Any], _: int) -> Iterator[Row]:
    for one in truth["jams"]:
        yield one["x"], one["y"], one["radius"], one["noise_dbm"]


def _scans(seen: dict[str, Any], robot: int) -> Iterator[Row]:
    yield robot, np.frombuffer(seen["scan"], dtype="<f4")


_INTEGERS = frozenset(
    {
        "robot", "incarnation", "epoch", "leader", "source", "message", "destination", "receiver",
        "msdu_bytes", "attempts", "hops", "other", "bytes",
    }
)  # fmt: skip
_WORDS = frozenset({"mode", "shape", "kind", "status", "why"})
_OBJECTS = frozenset({"members", "path", "payload", "data", "side_a", "side_b"})

TABLES: dict[str, tuple[str, Rows, tuple[str, ...]]] = {
    "poses": (
        "truth", _poses, ("robot", "incarnation", "x", "y", "heading", "v", "w", "held"),
    ),
    "status": (
        "out/", _status,
        ("robot", "incarnation", "mode", "epoch", "leader", "members", "shape", "throughput_bps",
         "threshold_bps", "k_rho", "error", "target_x", "target_y", "v", "w", "remaining_distance"),
    ),
    "notes": ("out/", _notes, ("robot", "kind", "data")),
    "verdicts": (
        "radio", _verdicts,
        ("source", "message", "destination", "receiver", "status", "msdu_bytes", "path", "attempts",
         "offered_s", "service_start_s", "arrival_s", "discovery_s", "queueing_s", "snr_db",
         "bit_error_rate"),
    ),
    "control": ("radio", _control, ("kind", "bytes")),
    "receptions": (
        "rx/", _receptions,
        ("robot", "source", "service_start_s", "arrival_s", "hops", "attempts", "snr_db",
         "bit_error_rate", "msdu_bytes", "payload"),
    ),
    "transmit_requests": ("truth", _offers, ("robot", "destination", "msdu_bytes", "payload")),
    "contacts": ("truth", _contacts, ("robot", "other", "x", "y")),
    "departures": ("truth", _departures, ("robot", "why")),
    "cuts": ("truth", _cuts, ("side_a", "side_b")),
    "jams": ("truth", _jams, ("x", "y", "radius", "noise_dbm")),
    "scans": ("obs/", _scans, ("robot", "ranges")),
}  # fmt: skip
"""Table -> the bus keys that it is made from, how rows come from one message, and its columns."""


def build(names: Iterable[str], messages: Iterable[Selected], period_ns: int) -> dict[str, Table]:
    """Several tables in one pass over the messages; each message is unpacked once."""
    makers = {name: TABLES[name] for name in names}
    by_stem: dict[str, list[tuple[str, Rows]]] = {}
    for name, (stem, rows, _) in makers.items():
        by_stem.setdefault(stem.rstrip("/"), []).append((name, rows))
    stamps: dict[str, list[int]] = {name: [] for name in makers}
    content: dict[str, list[Row]] = {name: [] for name in makers}
    for tick, key, data in messages:
        stem, _, robot = key.partition("/")
        fields = msgpack.unpackb(data)
        for name, rows in by_stem.get(stem, ()):
            for row in rows(fields, int(robot or 0)):
                stamps[name].append(tick)
                content[name].append(row)
    return {name: _table(makers[name][2], stamps[name], content[name], period_ns) for name in makers}


def _table(columns: tuple[str, ...], stamps: list[int], rows: list[Row], period_ns: int) -> Table:
    ticks = np.array(stamps, dtype=np.int64)
    table = Table({"tick": ticks, "time_s": ticks * (period_ns / 1e9)})
    values: Iterable[tuple[Any, ...]] = zip(*rows, strict=True) if rows else ((),) * len(columns)
    for name, column in zip(columns, values, strict=True):
        table[name] = _column(name, column)
    return table


def _column(name: str, values: tuple[Any, ...]) -> Column:
    if name in _OBJECTS:
        packed = np.empty(len(values), dtype=object)
        packed[:] = values
        return packed
    if name in _WORDS:
        return np.array(values, dtype=np.str_)
    if name == "held":
        return np.array(values, dtype=np.bool_)
    if name == "ranges":
        return np.array(values, dtype=np.float32)
    return np.array(values, dtype=np.int64 if name in _INTEGERS else np.float64)
