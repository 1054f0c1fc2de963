"""Write a mission into one MCAP file that survives the death of its writer.

Layout: metadata `onehop` (scenario name, seed, versions, driver) and the attachments (resolved scenario,
map files) come first, so that even a torn file can be re-executed; then the wire channels `/wire/...`
(encoding msgpack, no schema), ticks in canonical order; metadata `outcome` last. log_time is simulated
time on a fixed epoch, sequence is the tick.
"""

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Self

import numpy
from mcap.data_stream import RecordBuilder
from mcap.records import ChunkIndex
from mcap.writer import CompressionType, Writer

from onehop import __version__
from onehop.contracts import topics
from onehop.contracts.values import WIRE_VERSION
from onehop.scenario.bundle import Bundle
from onehop.wire.journal import WireMessage

LOG_EPOCH_NS = 1_000_000_000 * 1_000_000_000
"""Log time of simulated time 0: 2001-09-09T01:46:40Z, so that viewers show a date, not 1970."""

SCENARIO_ATTACHMENT = "scenario.json"
MAP_ATTACHMENT = "map/"
OUTCOME = "outcome"
"""Names in the file; the last is that of the metadata that end a log."""

PROGRAMS = "programs"
"""Where programs and plugins lay, if they are not ours: a re-execution looks for them there again."""


class _Index:
    """The index of all chunks so far, as the bytes that end the file, in place of the writer's own list.

    A log has a chunk for every three ticks, and as values their index would take 1.3 kB of each with
    three robots, 10 kB with fifty, until the file is closed; as bytes it takes a sixth.
    """

    def __init__(self) -> None:
        self._bytes = bytearray()

    def append(self, index: ChunkIndex) -> None:
        """Take the index of a chunk."""
        builder = RecordBuilder()
        index.write(builder)
        self._bytes += builder.end()  # type: ignore[no-untyped-call]

    def __iter__(self) -> Iterator[Self]:
        yield self

    def write(self, stream: RecordBuilder) -> None:
        """Write all of it, as if it were one record."""
        stream.write(self._bytes)


INDEX_OF_WRITER = "_Writer__chunk_indices"
"""Where the package keeps the list, and has no other way to it."""


class LogWriter:
    """One log in the making. flush() bounds what a kill -9 of this process can take."""

    def __init__(self, path: Path, bundle: Bundle, driver: str) -> None:
        self._stream = path.open("wb")
        self._writer = Writer(self._stream, chunk_size=1 << 20, compression=CompressionType.ZSTD)
        setattr(self._writer, INDEX_OF_WRITER, _Index())
        self._writer.start(profile="", library=f"onehop {__version__}")
        self._period_ns = bundle.scenario.clock.period_ns
        self._channels: dict[str, int] = {}
        self._writer.add_metadata(
            "onehop",
            {
                "wire_version": str(WIRE_VERSION),
                "onehop": __version__,
                "numpy": numpy.__version__,
                "scenario": bundle.scenario.name,
                "seed": str(bundle.scenario.seed),
                "driver": driver,
                **({PROGRAMS: bundle.folder} if bundle.scenario.has_own_programs() else {}),
            },
        )
        self._attach(SCENARIO_ATTACHMENT, bundle.scenario_json().encode(), "application/json")
        for name, data in sorted(bundle.files.items()):
            self._attach(MAP_ATTACHMENT + name, data, "application/octet-stream")
        self.flush()

    def _attach(self, name: str, data: bytes, media_type: str) -> None:
        self._writer.add_attachment(0, 0, name, media_type, data)

    def write(self, tick: int, messages: list[WireMessage]) -> None:
        """Append one tick's wire messages, in the order given."""
        stamp = LOG_EPOCH_NS + tick * self._period_ns
        for key, data in messages:
            channel = self._channels.get(key)
            if channel is None:
                channel = self._writer.register_channel(topics.wire(key), "msgpack", 0)
                self._channels[key] = channel
            self._writer.add_message(channel, stamp, data, stamp, tick)

    @property
    def is_deleted(self) -> bool:
        """Whether the file has no name any more: what is written is lost when it is closed."""
        return os.fstat(self._stream.fileno()).st_nlink == 0

    def flush(self) -> None:
        """Hand everything so far to the operating system (not to the disk: no fsync)."""
        self._writer.flush()  # type: ignore[no-untyped-call]

    def close(self, summary: Mapping[str, Any] | None) -> None:
        """Finish the file; summary is what `onehop run` will print, None if there is none."""
        self.flush()  # the writer holds messages back, and the outcome must not overtake them
        if summary is not None:
            self._writer.add_metadata(OUTCOME, {"summary": json.dumps(summary, sort_keys=True)})
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._stream.close()
