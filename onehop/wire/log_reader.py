"""Read a log, sound or torn: what it was made from, and its wire messages tick by tick.

Opening a log reads its metadata, its attachments and the heads of its chunks, but no message. It makes
sure that it is a log of ours with all that a mission is made from, and says in `flaws` what can be seen
from there: ticks that are missing or not in their order, records that are damaged. Whatever is read
after that is checked as it is read (selection.py); whether it is all that was said and as it was said,
audit.py finds by its digest.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

from onehop.contracts.errors import DecodeError, LogError
from onehop.contracts.printable import printable
from onehop.contracts.values import WIRE_VERSION
from onehop.scenario.bundle import Bundle, bundle_from_json
from onehop.wire.contents import damaged, read_contents
from onehop.wire.coverage import coverage_flaws
from onehop.wire.journal import Digest, WireMessage, canonical_rank, keys_of
from onehop.wire.log_writer import MAP_ATTACHMENT, OUTCOME, PROGRAMS, SCENARIO_ATTACHMENT
from onehop.wire.selection import WireMessages
from onehop.wire.summary import decode_summary


@dataclass(frozen=True, slots=True)
class LoggedTick:
    """All wire messages of one tick, in canonical order."""

    tick: int
    messages: list[WireMessage]

    def get(self, key: str) -> bytes | None:
        """The bytes that crossed a bus key in this tick."""
        return next((data for name, data in self.messages if name == key), None)


class LogFile:
    """One log. Raises LogError when it is none of ours or of a wire version that is not known.

    summary: what `onehop run` printed, None if the log ends before the mission did. torn: its recorder
    was killed. wire: its messages. unreadable: records that are damaged, in sentences. flaws: these, and
    what is wrong with the row of its ticks.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.contents = read_contents(path)
        self.torn = self.contents.torn
        self.metadata = self.contents.metadata.get("onehop", {})
        self.bundle = self._read_bundle()
        scenario = self.bundle.scenario
        self.wire = WireMessages(
            path, self.contents, keys_of(scenario.team.robots, scenario.bases), scenario.clock.period_ns
        )
        self.unreadable = [
            f"it is damaged in the record at byte {error.at} ({error.why})"
            for error in (*self.contents.unreadable, *filter(None, (self.contents.broken,)))
        ]
        self.summary = self._read_summary()
        ticks = None if self.summary is None else self.summary["ticks"]
        coverage = coverage_flaws(self.contents.stretches, scenario.clock.period_ns, ticks)
        self.flaws = [*self.unreadable, *coverage]

    def _read_bundle(self) -> Bundle:
        version = self.metadata.get("wire_version")
        attachments = self.contents.attachments
        if version is None or SCENARIO_ATTACHMENT not in attachments:
            for error in self.contents.unreadable:
                raise damaged(self.path, error.at, error.why)
            raise LogError(str(self.path), "not a log of a mission", "give a file that onehop run wrote")
        if version != str(WIRE_VERSION):
            raise LogError(
                str(self.path),
                f"wire schema version {printable(version, 20)}",
                f"this program reads version {WIRE_VERSION}; use the onehop that wrote it "
                f"({printable(self.metadata.get('onehop', 'unknown'), 40)})",
            )
        files = {
            name.removeprefix(MAP_ATTACHMENT): data
            for name, data in attachments.items()
            if name.startswith(MAP_ATTACHMENT)
        }
        origin = f"{self.path}: {SCENARIO_ATTACHMENT}"
        try:
            text, folder = attachments[SCENARIO_ATTACHMENT].decode(), self.metadata.get(PROGRAMS, "")
            return bundle_from_json(text, files, origin, folder)
        except (UnicodeDecodeError, RecursionError) as error:
            raise LogError(origin, f"not JSON ({error})", "an attachment written by onehop") from None

    def _read_summary(self) -> dict[str, Any] | None:
        outcome = self.contents.metadata.get(OUTCOME)
        if outcome is None:
            return None
        try:
            return decode_summary(outcome.get("summary", ""))
        except DecodeError as error:
            self.unreadable.append(f"its outcome cannot be read ({error})")
            return None

    def ticks(self) -> Iterator[LoggedTick]:
        """Every tick with its wire messages, up to where the log is torn. Raises LogError."""
        order: list[str] = []
        for number, group in groupby(self.wire.select(lambda _: True), key=itemgetter(0)):
            messages = [(key, data) for _, key, data in group]
            keys = [key for key, _ in messages]
            if keys != order:  # most ticks have the keys of the one before, already in order
                messages.sort(key=_rank)
                order = [key for key, _ in messages]
            yield LoggedTick(number, messages)


def _rank(message: WireMessage) -> tuple[int, int]:
    return canonical_rank(message[0])


def forged(path: Path, why: object) -> LogError:
    """The error of a log with a message that cannot have been recorded."""
    return LogError(str(path), str(why), "it is not as it was recorded; use a copy of it")


def digest(log: LogFile) -> str:
    """SHA-256 over the wire channels of a log: the same as the run printed."""
    sha = Digest()
    for tick in log.ticks():
        sha.add(tick.tick, tick.messages)
    return sha.hex()
