"""The bridge: it reads the log of a running mission as it grows, and publishes it as ROS 2 topics.

It has no place on the mission's bus, and nobody waits for it. Of a mission that is faster than people
look some ticks a second are published whole, and of all others events and changes.
"""

import time
from collections.abc import Callable
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Any

from onehop.analysis.growing_log import GrowingLog
from onehop.analysis.log import Log
from onehop.analysis.ros2.publications import DEPTH, LASTING_DEPTH, Publications, lasts
from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.node import startup
from onehop.ros2.node import RosNode
from onehop.ros2.rmw import Qos
from onehop.wire.log_reader import LoggedTick, forged
from onehop.wire.selection import one_of
from world_server.recording import BATCH_TICKS

LOOK_S = 1.0 / 30.0
"""How often it is looked for more [s]."""

FAST_LOOK_S = 1.0 / 10.0
"""The same when there has been more than can be published: it is the mission's turn [s]."""

MOST_WHOLE = BATCH_TICKS
"""Ticks that may come at a look with everything of them published, since so many are written at once. Of
more, which a mission faster than people look brings, the newest alone is published whole."""


class Bridge:
    """Publishes one log. older_ns: when a file of its name was written that is another mission's."""

    def __init__(self, path: Path, node: RosNode, store: Any, older_ns: int | None = None) -> None:
        self._growing = GrowingLog(path, older_ns)
        self._node = node
        self._store = store
        self._publications: Publications | None = None
        self._publish: dict[str, Callable[[Any], None]] = {}
        self._next = 0

    def run(self, ended: Callable[[], bool]) -> int:
        """Until the mission has its outcome, or ended(); returns ticks read. Raises LogError."""
        while True:
            is_last = ended()
            started = time.monotonic()
            self._growing.grow()
            log = self._growing.log
            pause_s = LOOK_S
            if log is not None:
                if not self._read_on(log):
                    pause_s = FAST_LOOK_S
                is_last = is_last or log.summary is not None
            if is_last:
                return self._next
            time.sleep(max(0.0, pause_s - (time.monotonic() - started)))

    def _read_on(self, log: Log) -> bool:
        """Publish what is new; whether all of it was published whole."""
        if self._publications is None:
            if log.torn and not log.scenario.clock.is_realtime:
                startup.give_way()
            self._publications = Publications(log, self._store)
        last = self._growing.last_tick
        whole_from = self._next if last - self._next < MOST_WHOLE else last
        wire = log.file.wire
        try:
            if self._next < whole_from:
                said = one_of(topics.TRUTH, topics.out(""), topics.rx(""))
                self._take(self._publications, wire.select(said, self._next, whole_from - 1), False)
            if whole_from <= last:
                self._take(self._publications, wire.select(lambda _: True, whole_from, last), True)
        except DecodeError as error:
            raise forged(log.path, error) from None
        is_whole = whole_from == self._next
        self._next = max(self._next, last + 1)
        return is_whole

    def _take(self, publications: Publications, messages: Any, whole: bool) -> None:
        for tick, group in groupby(messages, key=attrgetter("tick")):
            logged = LoggedTick(tick, [(one.key, one.data) for one in group])
            for topic, kind, _, message in publications.of(logged, whole):
                if topic not in self._publish:
                    qos = Qos(lasts(topic), LASTING_DEPTH if lasts(topic) else DEPTH)
                    self._publish[topic] = self._node.publisher(topic, kind, qos)
                self._publish[topic](message)
