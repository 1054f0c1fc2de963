"""The recorder process: everything on the bus into one MCAP file, as it happens.

The world hands it a few ticks at a time. It writes them in canonical order, flushes them to the
operating system and tells the world how far the file is; the world never runs more than a few ticks
ahead. With --no-file it only makes the digest.
"""

import json
import time
from pathlib import Path
from typing import Any

from onehop.contracts import topics
from onehop.contracts.briefings import LogBriefing
from onehop.contracts.messages import End
from onehop.node import startup
from onehop.node.bus import GONE, Bus
from onehop.scenario.bundle import bundle_from_json
from onehop.wire.batch import unpack_ticks
from onehop.wire.codec import decode
from onehop.wire.journal import Journal, WireMessage
from onehop.wire.log_writer import LogWriter
from onehop.wire.summary import summarize

LAST_WORDS_S = 2.0
"""How long to wait for the last records after the end of the mission was announced."""


def main() -> int:
    parser = startup.arguments("onehop.recorder", "Writes the log of a mission.")
    startup.add_connect(parser)
    parser.add_argument(
        "--out", type=Path, required=True, help="folder for mission.mcap and summary.json"
    )
    parser.add_argument("--no-file", action="store_true", help="make the digest, write no log")
    options = parser.parse_args()
    startup.start(options)
    with startup.connect(options, topics.RECORDER) as bus:
        bus.watch(topics.WORLD)
        briefing = decode(LogBriefing, startup.briefing(bus, topics.RECORDER))
        options.out.mkdir(parents=True, exist_ok=True)
        return _Recorder(bus, briefing, options.out, not options.no_file).serve()


class _Recorder:
    def __init__(self, bus: Bus, briefing: LogBriefing, out: Path, with_file: bool) -> None:
        self._bus = bus
        self._out = out
        self._path = out / "mission.mcap" if with_file else None
        self._log: LogWriter | None = None
        if self._path is not None:
            bundle = bundle_from_json(briefing.scenario_json, dict(briefing.files), "briefing")
            self._log = LogWriter(self._path, bundle, briefing.driver)
        self._journal = Journal(self._write)
        self._acknowledge = bus.publisher(topics.by(topics.RECORDER, topics.RECORDED))
        self._end: End | None = None

    def _write(self, tick: int, messages: list[WireMessage]) -> None:
        if self._log is not None:
            self._log.write(tick, messages)

    def serve(self) -> int:
        """Record until the end of the mission, or of the world."""
        self._bus.announce(topics.RECORDER)
        while self._end is None:
            what, data = self._bus.receive()
            if what == topics.alive(topics.WORLD) and data == GONE:
                break
            self._take(what, data)
        deadline = time.monotonic() + LAST_WORDS_S
        while self._end is not None and self._journal.last_tick < self._end.last_tick:
            received = self._bus.receive_by(deadline)
            if received is None:
                break
            self._take(*received)
        return self._finish()

    def _take(self, what: str, data: bytes) -> None:
        if what == topics.END:
            self._end = decode(End, data)
        elif what == topics.TICKS:
            for record in unpack_ticks(data):
                self._journal.add(*record)
            if self._log is not None:
                self._log.flush()
            self._acknowledge(self._journal.last_tick.to_bytes(8, "little"))

    def _finish(self) -> int:
        summary: dict[str, Any] | None = None
        if self._end is not None:
            log = str(self._path) if self._path is not None else None
            summary = summarize(self._end.outcome, self._end.wall_s, self._journal.digest(), log)
        if self._log is not None:
            self._log.close(summary)
        if summary is None:
            return 1
        text = json.dumps(summary, indent=1)
        (self._out / "summary.json").write_text(text + "\n")
        self._bus.publisher(topics.to(topics.OPERATOR, topics.RESULT))(text.encode())
        return 0


if __name__ == "__main__":
    startup.main(main)
