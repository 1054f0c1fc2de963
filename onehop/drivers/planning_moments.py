"""What a leader planned: its program is executed again from the log, as far as somebody asks for.

A log has what a robot perceived and did, not what it thought; the rest follows from its program.
"""

from bisect import bisect_right
from itertools import groupby
from operator import attrgetter

import numpy as np

from onehop.contracts import topics
from onehop.contracts.briefings import Briefing
from onehop.contracts.errors import DecodeError
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import Percept
from onehop.contracts.scenario import Scenario
from onehop.drivers.players import RobotPlayer
from onehop.plugins import plugged
from onehop.programs.host import ProgramError
from onehop.wire.log_reader import LogFile, LoggedTick, forged
from onehop.wire.selection import one_of
from robot_agent.core.planning import Pathfinder, make_pathfinder
from robot_agent.core.planning.snapshot import PlanningSnapshot
from robot_agent.core.robot import Robot


class PlanningMoments:
    """Those of one robot of the built-in team, of a log that may still be written."""

    def __init__(self, scenario: Scenario, robot: int) -> None:
        self._robot = robot
        self._player = RobotPlayer(scenario, robot, self._watched)
        self._watching: _Watched | None = None
        self._next = 0
        self._ticks: list[int] = []
        self._found: list[PlanningSnapshot] = []

    def last(self, log: LogFile, tick: int) -> tuple[int, PlanningSnapshot] | None:
        """The last planning moment by a tick, with its tick; None if it had none yet.

        Executes what has not been executed up to there. Raises LogError.
        """
        if tick >= self._next:
            wanted = one_of(topics.obs(self._robot), topics.rx(self._robot))
            messages = log.wire.select(wanted, self._next, tick)
            try:
                for number, group in groupby(messages, key=attrgetter("tick")):
                    self._play(LoggedTick(number, [(one.key, one.data) for one in group]))
            except DecodeError as error:
                raise forged(log.path, error) from None
            self._next = tick + 1
        place = bisect_right(self._ticks, tick) - 1
        return (self._ticks[place], self._found[place]) if place >= 0 else None

    def _play(self, tick: LoggedTick) -> None:
        for _ in self._player.play(tick):
            pass
        planned = self._watching and self._watching.planned
        if planned and (not self._found or planned is not self._found[-1]):
            self._ticks.append(tick.tick)
            self._found.append(planned)

    def _watched(self, briefing: Briefing) -> "_Watched":
        self._watching = _Watched(briefing)
        return self._watching


class _Watched:
    """One incarnation, whose pathfinder is at hand. planned: its last planning moment."""

    def __init__(self, briefing: Briefing) -> None:
        self._robot = Robot(plugged(briefing), self._make)
        self._pathfinder: Pathfinder | None = None

    def _make(self, briefing: Briefing, pose: Pose, rng: np.random.Generator) -> Pathfinder:
        self._pathfinder = make_pathfinder(briefing, pose, rng)
        return self._pathfinder

    def step(self, percept: Percept) -> bytes:
        try:
            self._robot.step(percept)
        except Exception as error:  # somebody's planner has failed, as it did in the mission
            raise ProgramError(repr(error), repr(error)) from error
        return b""

    @property
    def planned(self) -> PlanningSnapshot | None:
        return getattr(self._pathfinder, "snapshot", None)
