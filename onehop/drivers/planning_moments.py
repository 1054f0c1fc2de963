"""What a leader planned: its program is executed again from the log, as far as somebody asks for.

A log has what a robot perceived and did, not what it thought; the rest follows from its program. Nothing
that a log names is imported or called for it, since a log may be anybody's: planner and gain policy have
to be ours.
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
from onehop.contracts.plugin_names import GAIN_POLICIES, PLANNERS
from onehop.contracts.program_section import BUILT_IN as OUR_PROGRAM
from onehop.contracts.scenario import BUILT_IN, Scenario
from onehop.drivers.players import RobotPlayer
from onehop.programs.host import ProgramError
from onehop.wire.log_reader import LogFile, LoggedTick, forged
from onehop.wire.selection import one_of
from robot_agent.core.planning import Pathfinder, make_pathfinder
from robot_agent.core.planning.snapshot import PlanningSnapshot
from robot_agent.core.robot import Robot


def is_known(scenario: Scenario, robot: int) -> bool:
    """Whether all that decides what a robot plans is ours."""
    return (
        scenario.program_of(robot)[0] == OUR_PROGRAM
        and scenario.planner.kind in BUILT_IN[PLANNERS]
        and scenario.gains.policy in BUILT_IN[GAIN_POLICIES]
    )


class PlanningMoments:
    """Those of one robot that `is_known`, of a log that may still be written.

    They end where a tick is missing: from there on nobody knows what the robot knew.
    """

    def __init__(self, scenario: Scenario, robot: int) -> None:
        self._robot = robot
        self._player = RobotPlayer(scenario, robot, self._watched)
        self._watching: _Watched | None = None
        self._next = 0
        self._is_cut = False
        self._ticks: list[int] = []
        self._found: list[PlanningSnapshot] = []

    def last(self, log: LogFile, tick: int) -> tuple[int, PlanningSnapshot] | None:
        """The last planning moment by a tick, with its tick; None if it had none yet.

        Executes what has not been executed up to there. Raises LogError.
        """
        if tick >= self._next and not self._is_cut:
            self._read_on(log, tick)
        if tick >= self._next:
            return None
        place = bisect_right(self._ticks, tick) - 1
        return (self._ticks[place], self._found[place]) if place >= 0 else None

    def _read_on(self, log: LogFile, tick: int) -> None:
        own = topics.obs(self._robot), topics.rx(self._robot)
        messages = log.wire.select(one_of(topics.TRUTH, *own), self._next, tick)
        try:
            for number, group in groupby(messages, key=attrgetter("tick")):
                if number != self._next:
                    self._is_cut = True
                    return
                self._play(LoggedTick(number, [(one.key, one.data) for one in group]))
                self._next = number + 1
        except DecodeError as error:
            self._is_cut = True
            raise forged(log.path, error) from None

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
        self._robot = Robot(briefing, self._make)
        self._pathfinder: Pathfinder | None = None

    def _make(self, briefing: Briefing, pose: Pose, rng: np.random.Generator) -> Pathfinder:
        self._pathfinder = make_pathfinder(briefing, pose, rng)
        return self._pathfinder

    def step(self, percept: Percept) -> bytes:
        try:
            self._robot.step(percept)
        except Exception as error:  # of what nobody can have perceived
            raise ProgramError(repr(error), repr(error)) from error
        return b""

    @property
    def planned(self) -> PlanningSnapshot | None:
        return getattr(self._pathfinder, "snapshot", None)
