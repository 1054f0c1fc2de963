"""One log behind the page: read to its end, followed while it grows, asked for any moment in between."""

import threading
from collections.abc import Callable
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Any

from onehop.analysis.explanation import explain
from onehop.analysis.explanation_text import explanation_text
from onehop.analysis.growing_log import GrowingLog
from onehop.analysis.log import Log
from onehop.analysis.report.narrative import summary_sentence
from onehop.contracts import topics
from onehop.contracts.errors import DecodeError, InputError, LogError, OnehopError
from onehop.contracts.messages import Action, RadioRecord, Truth
from onehop.contracts.printable import printable
from onehop.live.frame import Moment, frame, scan
from onehop.live.road_maps import RoadMaps
from onehop.live.setting import setting
from onehop.live.story import Story
from onehop.mission.rendezvous import way_into
from onehop.wire.log_reader import forged
from onehop.wire.logged import decoded
from onehop.wire.selection import Selected, one_of

LOOK_S = 1.0 / 15.0
"""How often a log that is written is looked at [s]."""

TICKS_AT_ONCE = 200
"""Ticks that are read before others may have a turn."""

LONGEST_LINE = 400


class Source:
    """One log and its story. `changed` is called, from a thread of its own, whenever there is more.

    is_ours: this program has started the mission, and will tell its end (`end`).
    """

    def __init__(self, path: Path, is_ours: bool = False, older_ns: int | None = None) -> None:
        self.path = path
        self.story: Story | None = None
        self.problem = ""
        self._growing = GrowingLog(path, older_ns)
        self._is_ours = is_ours
        self._end = ""
        self._next = 0
        self._setting: dict[str, Any] | None = None
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        self._read_all = False
        self._road_maps = RoadMaps()
        self._planning = threading.Lock()

    def open(self) -> None:
        """Open a log that has to be there. Raises LogError when it is none of ours."""
        self._growing.open()

    def start(self, changed: Callable[[], None]) -> None:
        """Begin to read."""
        self._thread = threading.Thread(target=self._follow, args=(changed,), name="reader", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Read no further."""
        self._ended.set()
        if self._thread is not None:
            self._thread.join()

    def end(self, words: str) -> None:
        """The mission has ended, as these words say; what its log says of it goes before them."""
        self._end = words

    @property
    def log(self) -> Log | None:
        return self._growing.log

    @property
    def last_tick(self) -> int:
        """The last tick that the story tells of: the last one that can be shown."""
        return self.story.last_tick if self.story else -1

    def setting(self) -> dict[str, Any] | None:
        """What the page draws once; None before there is a log."""
        if self._setting is None and self.log is not None:
            self._setting = setting(self.log.bundle)
        return self._setting

    def state(self) -> dict[str, Any]:
        """Whether there is more to come, and how it ended. Plain values."""
        log, story = self.log, self.story
        shown: dict[str, Any] = {"last_tick": self.last_tick, "words": "", "reading": 1.0, "outcome": ""}
        if self.problem:
            return shown | {"state": "broken", "words": self.problem}
        if log is None or story is None:
            return shown | {"state": "starting", "words": "The processes of the mission start."}
        if not self._read_all and self._growing.last_tick > 0:
            shown["reading"] = max(0, self.last_tick) / self._growing.last_tick
        if log.summary is not None:
            story.summary = log.summary
            return shown | {
                "state": "ended", "words": summary_sentence(story), "outcome": log.summary["outcome"]
            }  # fmt: skip
        if self._end:
            return shown | {"state": "ended", "words": self._end, "outcome": "aborted"}
        if self._is_ours or _is_written(self.path):
            return shown | {"state": "running"}
        why = "its recorder was killed" if log.torn else "it has no outcome"
        return shown | {"state": "torn", "words": f"The log ends here, before the mission did: {why}."}

    def frame(self, tick: int, since: int, robot: int) -> dict[str, Any] | None:
        """The frame of a tick; None where the log has none. Raises LogError."""
        log, story = self.log, self.story
        if log is None or story is None or not 0 <= tick <= story.last_tick:
            return None
        moment = Moment(log, story, tick, since, robot if robot in log.robots else 0)
        if moment.truth is None:
            return None
        shown = frame(moment, story)
        if moment.scan is not None:
            shown["scan"] = scan(moment.scan)
        return shown

    def explain(self, robot: int, at_s: float) -> list[str]:
        """The lines of `onehop explain`, or why there are none."""
        log = self.log
        if log is None:
            return ["There is no log yet."]
        try:
            lines = explanation_text(explain(log, robot, at_s))
            return [printable(line, LONGEST_LINE) for line in lines]
        except (InputError, LogError) as error:
            return [printable(str(error))]

    def road_map(self, robot: int, tick: int) -> dict[str, Any]:
        """What a robot had planned last by a tick; empty where that is not to be had. Plain values."""
        log = self.log
        if log is None or robot not in log.robots:
            return {}
        try:
            with self._planning:
                return self._road_maps.of(
                    self._growing.file_number, log, robot, min(tick, self.last_tick)
                )
        except OnehopError:  # frames and `explain` say what is wrong with the log
            return {}

    def _follow(self, changed: Callable[[], None]) -> None:
        while not self._ended.is_set():
            try:
                grown = self._growing.grow() or self.story is None
                more = self._read_on()
            except (LogError, OSError) as error:
                self.problem = printable(str(error))
                changed()
                return
            if grown or more:
                changed()
            if more < TICKS_AT_ONCE:
                self._read_all = True
                self._ended.wait(LOOK_S)

    def _read_on(self) -> int:
        """Take some ticks into the story; how many. Raises LogError."""
        log = self.log
        if log is None:
            return 0
        if self.story is None:
            self.story = Story(log.scenario)
        last = min(self._growing.last_tick, self._next + TICKS_AT_ONCE - 1)
        if last < self._next:
            return 0
        wanted = one_of(topics.TRUTH, topics.RADIO_RECORD, "out/")
        messages = log.file.wire.select(wanted, self._next, last)
        try:
            for _, group in groupby(messages, key=attrgetter("tick")):
                self._take(self.story, list(group))
        except DecodeError as error:
            raise forged(self.path, error) from None
        read, self._next = last + 1 - self._next, last + 1
        return read

    def _take(self, story: Story, messages: list[Selected]) -> None:
        truth: Truth | None = None
        record: RadioRecord | None = None
        actions: dict[int, Action] = {}
        for message in messages:
            value = decoded(message)
            if isinstance(value, Truth):
                truth = value
            elif isinstance(value, RadioRecord):
                record = value
            elif isinstance(value, Action):
                actions[int(message.key.partition("/")[2])] = value
        if truth is not None:
            story.take(truth, record, actions)


def _is_written(path: Path) -> bool:
    """Whether the mission runs whose log this is."""
    try:
        way_into(path.parent)
    except InputError:
        return False
    return True
