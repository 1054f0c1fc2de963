"""The recorder process: everything on the bus into one MCAP file, as it happens.

The world hands it a few ticks at a time. It writes them in canonical order, flushes them to the
operating system and tells the world how far the file is; the world never runs more than a few ticks
ahead. With --no-file it only makes the digest. Last it writes the mission's summary. When it cannot
write any more it tells the world why, and leaves the log as far as it is.
"""

import argparse
import contextlib
import errno
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from onehop.contracts import topics
from onehop.contracts.briefings import LogBriefing
from onehop.contracts.errors import InputError
from onehop.contracts.operation import End
from onehop.node import startup
from onehop.node.bus import GONE, Bus
from onehop.scenario.bundle import bundle_from_json
from onehop.wire.batch import unpack_ticks
from onehop.wire.codec import decode
from onehop.wire.journal import Journal, WireMessage
from onehop.wire.log_writer import LogWriter
from onehop.wire.output_folder import LOG, REMEDY, claimed, explained
from onehop.wire.summary import summarize, write_summary

LAST_TICKS_S = 2.0
"""How long to wait for the last ticks after the end of the mission was announced [s]."""


def main() -> int:
    parser = startup.arguments("onehop.recorder", "Writes the log of a mission.")
    startup.add_connect(parser)
    parser.add_argument("--out", type=Path, required=True, help="folder for mission.mcap")
    parser.add_argument("--no-file", action="store_true", help="make the digest, write no log")
    options = parser.parse_args()
    startup.start(options)
    held_by_launcher = options.lifeline is not None
    with contextlib.nullcontext() if held_by_launcher else claimed(options.out):
        return _record(options)


def _record(options: argparse.Namespace) -> int:
    with startup.connect(options, topics.RECORDER) as bus:
        bus.watch(topics.WORLD)
        briefing = decode(LogBriefing, startup.briefing(bus, topics.RECORDER))
        try:
            return _Recorder(bus, briefing, options).serve()
        except InputError as error:
            bus.publisher(topics.by(topics.RECORDER, topics.FAILED))(str(error).encode())
            raise


class _Recorder:
    def __init__(self, bus: Bus, briefing: LogBriefing, options: argparse.Namespace) -> None:
        self._bus = bus
        self._folder: Path = options.out
        self._path = None if options.no_file else options.out / LOG
        self._log: LogWriter | None = None
        files = dict(briefing.files)
        bundle = bundle_from_json(briefing.scenario_json, files, "briefing", briefing.programs)
        self._in_real_time = bundle.scenario.clock.is_realtime
        if self._path is not None:
            with explained(self._path, REMEDY):
                self._log = LogWriter(self._path, bundle, briefing.driver)
        self._journal = Journal(self._write)
        self._acknowledge = bus.publisher(topics.by(topics.RECORDER, topics.RECORDED))
        self._put_digest = bus.publisher(topics.to(topics.OPERATOR, topics.DIGEST))
        self._end: End | None = None

    def _write(self, tick: int, messages: list[WireMessage]) -> None:
        if self._log is not None:
            self._log.write(tick, messages)

    def serve(self) -> int:
        """Record until the end of the mission, or of the world."""
        self._bus.announce(topics.RECORDER)
        self._record_until_end()
        deadline = time.monotonic() + LAST_TICKS_S
        while self._end is not None and self._journal.last_tick < self._end.last_tick:
            received = self._bus.receive_by(deadline)
            if received is None:
                break
            self._take(*received)
        return self._finish()

    def _record_until_end(self) -> None:
        """Until the world says that it is over, or is gone for good."""
        away_until: float | None = None
        while self._end is None:
            received = self._bus.receive() if away_until is None else self._bus.receive_by(away_until)
            if received is None:
                return
            what, data = received
            if what == topics.alive(topics.WORLD):
                if data == GONE and self._journal.last_tick >= 0 and not self._in_real_time:
                    return
                away_until = time.monotonic() + startup.REUNION_S if data == GONE else None
            else:
                self._take(what, data)

    def _take(self, what: str, data: bytes) -> None:
        if what == topics.END:
            self._end = decode(End, data)
        elif what == topics.TICKS:
            with self._writing():
                for tick, messages in unpack_ticks(data):
                    if tick > self._journal.last_tick:  # else it has come again
                        self._journal.add(tick, messages)
                if self._log is not None:
                    self._log.flush()
            self._acknowledge(self._journal.last_tick.to_bytes(8, "little"))

    @contextlib.contextmanager
    def _writing(self) -> Iterator[None]:
        """Say which file it was that could not be written, or that nobody can find any more."""
        with explained(self._path or self._folder, REMEDY):
            if self._log is not None and self._log.is_deleted:
                raise OSError(errno.ENOENT, "deleted while it was written")
            yield

    def _finish(self) -> int:
        if self._end is None:
            with self._writing():
                self._close(None)
            return startup.WORLD_IS_GONE
        log = None if self._path is None else str(self._path)
        end, digest = self._end, self._journal.digest()
        summary = summarize(end.outcome, end.wall_s, digest, log, punctuality=end.punctuality)
        with self._writing():
            self._close(summary)
        self._put_digest(self._journal.digest().encode())
        write_summary(self._folder, summary)
        return 0

    def _close(self, summary: dict[str, Any] | None) -> None:
        if self._log is not None:
            self._log.close(summary)


if __name__ == "__main__":
    startup.main(main)
