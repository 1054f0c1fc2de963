"""Logs in every form that MCAP allows, and logs that were damaged or forged on the way."""

from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import msgpack
from mcap.opcode import Opcode
from mcap.writer import CompressionType, Writer

from onehop.contracts import topics
from onehop.wire.journal import WireMessage
from onehop.wire.log_reader import LogFile
from onehop.wire.log_writer import LOG_EPOCH_NS, OUTCOME
from onehop.wire.records import Record, walk

Ticks = Iterable[tuple[int, list[WireMessage]]]


class Form(NamedTuple):
    """How the messages of a file are kept. flush_every: ticks in a chunk."""

    chunked: bool = True
    compression: CompressionType = CompressionType.ZSTD
    crcs: bool = True
    flush_every: int = 3


FORMS = {
    "zstd": Form(),
    "lz4": Form(compression=CompressionType.LZ4),
    "plain chunks": Form(compression=CompressionType.NONE),
    "no checksums": Form(compression=CompressionType.NONE, crcs=False),
    "no chunks": Form(chunked=False),
}


def ticks_of(path: Path) -> list[tuple[int, list[WireMessage]]]:
    """All wire messages of a log."""
    return [(tick.tick, tick.messages) for tick in LogFile(path).ticks()]


def write_form(source: Path, target: Path, form: Form, ticks: Ticks, outcome: bool = True) -> None:
    """A log of the mission of another one in this form, with these wire messages."""
    log = LogFile(source)
    period_ns = log.bundle.scenario.clock.period_ns
    with target.open("wb") as stream:
        writer = Writer(
            stream, use_chunking=form.chunked, compression=form.compression, enable_crcs=form.crcs
        )
        writer.start()
        writer.add_metadata("onehop", log.metadata)
        for name, data in log.contents.attachments.items():
            writer.add_attachment(0, 0, name, "", data)
        channels: dict[str, int] = {}
        for number, (tick, messages) in enumerate(ticks):
            stamp = LOG_EPOCH_NS + tick * period_ns
            for key, data in messages:
                if key not in channels:
                    channels[key] = writer.register_channel(topics.wire(key), "msgpack", 0)
                writer.add_message(channels[key], stamp, data, stamp, tick)
            if number % form.flush_every == 0:
                writer.flush()  # type: ignore[no-untyped-call]
        writer.flush()  # type: ignore[no-untyped-call]
        if outcome:
            writer.add_metadata(OUTCOME, log.contents.metadata[OUTCOME])
        writer.finish()  # type: ignore[no-untyped-call]


def chunks(data: bytes, path: Path) -> list[bytes]:
    """Head, every chunk with its index, and tail of a file."""
    path.write_bytes(data)
    with path.open("rb") as stream:
        records = list(walk(stream))
    starts = [record.at for record in records if record.opcode == Opcode.CHUNK]
    end = next(r.at for r in records if r.at > starts[-1] and not _of_chunks(r))
    places = [0, *starts, end, len(data)]
    return [data[a:b] for a, b in pairwise(places)]


def _of_chunks(record: Record) -> bool:
    return record.opcode in (Opcode.CHUNK, Opcode.MESSAGE_INDEX)


EXTREMES: tuple[Any, ...] = (
    float("nan"), float("inf"), float("-inf"), 1e308, -1, 0, 2**31, 2**63, 2**64 - 1, -(2**63), "",
    "\x1b[31m<script>alert(1)</script>\n\0$\\frac{$", "x" * 5000, b"", b"\xff" * 50, None, True, [], {},
    [1, 2], list(range(3000)), {"": 0}, {1: 2}, {"kind": "a", "at_s": "b"}, [[[[]]]],
)  # fmt: skip


def with_extreme(data: bytes, random: Random) -> bytes:
    """A wire message with something else in one place."""
    fields = msgpack.unpackb(data, strict_map_key=False)
    holder, key = random.choice(list(_places(fields)))
    holder[key] = random.choice(EXTREMES)
    packed: bytes = msgpack.packb(fields)
    return packed


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    keys = value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for key in list(keys):
        yield value, key
        yield from _places(value[key])


def mutated(data: bytes, random: Random, scratch: Path) -> bytes:
    """A file that was damaged: bits, bytes, chunks."""
    return random.choice(_DAMAGES)(data, random, scratch)


def _flip(data: bytes, random: Random, _: Path) -> bytes:
    changed = bytearray(data)
    for _number in range(random.choice((1, 1, 3, 50))):
        changed[random.randrange(len(changed))] ^= 1 << random.randrange(8)
    return bytes(changed)


def _cut(data: bytes, random: Random, _: Path) -> bytes:
    at = random.randrange(len(data))
    return data[:at] + data[at + random.choice((1, 8, 100, 5000)) :]


def _tear(data: bytes, random: Random, _: Path) -> bytes:
    return data[: random.randrange(len(data))]


def _insert(data: bytes, random: Random, _: Path) -> bytes:
    at = random.randrange(len(data))
    return data[:at] + random.randbytes(random.choice((1, 8, 100, 5000))) + data[at:]


def _repeat(data: bytes, random: Random, _: Path) -> bytes:
    at, length = random.randrange(len(data)), random.randrange(5000)
    return data[: at + length] + data[at:]


def _lie_about_length(data: bytes, random: Random, scratch: Path) -> bytes:
    scratch.write_bytes(data)
    with scratch.open("rb") as stream:
        record = random.choice(list(walk(stream)))
    length = random.choice((0, 1, record.length - 1, record.length + 1, 2**31, 2**40, 2**64 - 1))
    return data[: record.at + 1] + max(0, length).to_bytes(8, "little") + data[record.start :]


def _of_parts(change: Callable[[list[bytes], Random], list[bytes]]) -> Callable[..., bytes]:
    def damage(data: bytes, random: Random, scratch: Path) -> bytes:
        head, *middle, tail = chunks(data, scratch)
        return b"".join((head, *change(middle, random), tail))

    return damage


def swapped(parts: list[bytes], random: Random) -> list[bytes]:
    """Two chunks in each other's place."""
    one, other = random.sample(range(len(parts)), 2)
    parts[one], parts[other] = parts[other], parts[one]
    return parts


def doubled(parts: list[bytes], random: Random) -> list[bytes]:
    """A chunk twice."""
    at = random.randrange(len(parts))
    return [*parts[: at + 1], *parts[at:]]


def deleted(parts: list[bytes], random: Random) -> list[bytes]:
    """A chunk gone."""
    at = random.randrange(len(parts))
    return [*parts[:at], *parts[at + 1 :]]


_DAMAGES: tuple[Callable[[bytes, Random, Path], bytes], ...] = (
    _flip, _flip, _cut, _tear, _insert, _repeat, _lie_about_length,
)  # fmt: skip
CHUNK_DAMAGES = {
    "swapped": _of_parts(swapped), "doubled": _of_parts(doubled), "deleted": _of_parts(deleted),
}  # fmt: skip
