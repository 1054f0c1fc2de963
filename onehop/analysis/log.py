"""Open a log for reading in Python: typed messages, and tables of columns, of any stretch of time.

    from onehop.analysis import open_log

    log = open_log("runs/map1/mission.mcap")
    log.scenario.team.robots              # what was run
    status = log.table("status", robots=[5])
    status["time_s"], status["error"]     # NumPy columns
    for tick, truth in log.truths(60, 70): ...

Nothing is held in memory but what was asked for; a stretch of time is found without unpacking the rest.
"""

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from onehop.analysis.columns import TABLES, Column
from onehop.analysis.derived import DERIVED, derive
from onehop.analysis.tables import Table, build
from onehop.contracts import topics
from onehop.contracts.errors import DecodeError, InputError
from onehop.contracts.messages import Action, Inbox, Observation, RadioRecord, Truth
from onehop.contracts.scenario import Scenario
from onehop.scenario.bundle import Bundle
from onehop.wire.log_reader import LogFile, forged
from onehop.wire.logged import M, value_of
from onehop.wire.selection import Selected, one_of


class Log:
    """One mission's log, sound or torn.

    scenario, bundle: what was run. metadata: versions, driver. summary: what `onehop run` printed, None
    if the log ends before the mission did.
    torn: its recorder was killed. flaws: what is wrong with it beyond that, as far as it can be seen
    without reading all of it (log_reader.py says how far). file: the same log, tick by tick.
    """

    def __init__(self, file: LogFile) -> None:
        self.path = file.path
        self.bundle: Bundle = file.bundle
        self.scenario: Scenario = file.bundle.scenario
        self.metadata = file.metadata
        self.period_ns = self.scenario.clock.period_ns
        self.summary: dict[str, Any] | None = file.summary
        self.torn = file.torn
        self.flaws = tuple(file.flaws)
        self.file = file

    @property
    def robots(self) -> tuple[int, ...]:
        """Ids of the team, sorted."""
        return self.scenario.team.robots

    def tick_at(self, time_s: float) -> int:
        """The tick of a simulated time [s]. Raises InputError for a time that is no finite number."""
        if not math.isfinite(time_s):
            raise InputError(f"time {time_s}", "is no moment of a mission", "a number of seconds")
        return round(time_s * 1e9 / self.period_ns)

    def messages(
        self, *keys: str, start_s: float = 0.0, end_s: float | None = None
    ) -> Iterator[Selected]:
        """Raw wire messages of bus keys, e.g. "truth", "out/3", "out/" (all robots), within a time."""
        last = None if end_s is None else self.tick_at(end_s)
        return self.file.wire.select(one_of(*keys), self.tick_at(start_s), last)

    def truths(self, start_s: float = 0.0, end_s: float | None = None) -> Iterator[tuple[int, Truth]]:
        """(tick, ground truth)."""
        return self._typed(Truth, topics.TRUTH, start_s, end_s)

    def radio_records(
        self, start_s: float = 0.0, end_s: float | None = None
    ) -> Iterator[tuple[int, RadioRecord]]:
        """(tick, what the radio did)."""
        return self._typed(RadioRecord, topics.RADIO_RECORD, start_s, end_s)

    def observations(
        self, robot: int, start_s: float = 0.0, end_s: float | None = None
    ) -> Iterator[tuple[int, Observation]]:
        """(tick, what a robot saw)."""
        return self._typed(Observation, topics.obs(robot), start_s, end_s)

    def inboxes(
        self, robot: int, start_s: float = 0.0, end_s: float | None = None
    ) -> Iterator[tuple[int, Inbox]]:
        """(tick, what a robot heard)."""
        return self._typed(Inbox, topics.rx(robot), start_s, end_s)

    def actions(
        self, robot: int, start_s: float = 0.0, end_s: float | None = None
    ) -> Iterator[tuple[int, Action]]:
        """(tick, what a robot did)."""
        return self._typed(Action, topics.out(robot), start_s, end_s)

    @property
    def in_lock_step(self) -> bool:
        """Whether each robot acted on what it was told in the same tick."""
        return not self.scenario.clock.is_realtime

    def _typed(
        self, kind: type[M], key: str, start_s: float, end_s: float | None
    ) -> Iterator[tuple[int, M]]:
        for message in self.messages(key, start_s=start_s, end_s=end_s):
            try:
                value = value_of(kind, message, self.in_lock_step)
            except DecodeError as error:
                raise forged(self.path, error) from None
            yield message.tick, value

    def table(
        self,
        name: str,
        robots: Iterable[int] | None = None,
        start_s: float = 0.0,
        end_s: float | None = None,
    ) -> Table:
        """One table of columns; robots only where the messages are a robot's own (columns.TABLES)."""
        return self.tables(name, robots=robots, start_s=start_s, end_s=end_s)[name]

    def tables(
        self,
        *names: str,
        robots: Iterable[int] | None = None,
        start_s: float = 0.0,
        end_s: float | None = None,
    ) -> dict[str, Table]:
        """Several tables in one pass over the log. Raises InputError for a table that there is not."""
        for name in names:
            if name not in TABLES and name not in DERIVED:
                raise InputError(
                    f"table {name}", "there is no such table", f"one of {', '.join([*TABLES, *DERIVED])}"
                )
        spoken = [name for name in names if name in TABLES]
        stems = sorted({TABLES[name].key for name in spoken})
        keys = [key for stem in stems for key in _keys(stem, robots)]
        found = self.build(spoken, self.messages(*keys, start_s=start_s, end_s=end_s)) if keys else {}
        for name in names:
            if name in DERIVED:
                try:
                    found[name] = derive(name, self.bundle, self._watched(start_s, end_s))
                except (ArithmeticError, ValueError) as error:
                    raise forged(self.path, f"{name} cannot be computed: {error}") from None
        return found

    def _watched(self, start_s: float, end_s: float | None) -> Iterator[tuple[Truth, RadioRecord]]:
        """Truth and radio of every tick that has both."""
        records = self.radio_records(start_s, end_s)
        last = next(records, None)
        for tick, truth in self.truths(start_s, end_s):
            while last is not None and last[0] < tick:
                last = next(records, None)
            if last is None or last[0] > tick:
                continue
            self._check_team("poses", np.array([one.robot for one in truth.present]))
            yield truth, last[1]

    def build(self, names: Iterable[str], messages: Iterable[Selected]) -> dict[str, Table]:
        """Several tables of messages of this log. Raises LogError for a message that cannot be one."""
        try:
            tables = build(names, messages, self.period_ns, self.in_lock_step)
        except DecodeError as error:
            raise forged(self.path, error) from None
        for name, table in tables.items():
            for column in _OF_THE_TEAM.get(name, ()):
                self._check_team(name, table[column])
        if "scans" in tables:
            self._check_scans(tables["scans"])
        return tables

    def _check_scans(self, table: Table) -> None:
        """Each scan has the beams of its robot's laser: behind them a matrix of several is nan."""
        beams = {robot: self.scenario.body_of(robot).laser_beams for robot in self.robots}
        seen = np.array([beams.get(robot, 0) for robot in table["robot"].tolist()], dtype=np.int64)
        given = (~np.isnan(table["ranges"])).sum(axis=1) if len(table) else seen
        for row in np.flatnonzero(given != seen).tolist():
            robot, beam = table["robot"][row], "beams that hit something or nothing"
            what = f"a scan of {given[row]} {beam}, of robot {robot} that has {seen[row]}"
            raise forged(self.path, what)

    def _check_team(self, name: str, robots: Column) -> None:
        strangers = robots[~np.isin(robots, self.robots)]
        if len(strangers):
            raise forged(self.path, f"{name} of robot {strangers[0]}, which is not in the team")


_OF_THE_TEAM = {
    "poses": ("robot",),
    "transmit_requests": ("robot",),
    "departures": ("robot",),
    "contacts": ("robot",),
    "verdicts": ("source",),
    "receptions": ("source",),
    "neighbours": ("neighbour",),
}
"""Columns in which world and radio name robots of the team, and nobody else."""


def _keys(stem: str, robots: Iterable[int] | None) -> list[str]:
    if robots is None or not stem.endswith("/"):
        return [stem]
    return [f"{stem}{robot}" for robot in sorted(robots)]


def open_log(path: str | Path) -> Log:
    """A log that `onehop run` wrote. Raises LogError when it is none, or of an unknown wire version."""
    return Log(LogFile(Path(path)))
