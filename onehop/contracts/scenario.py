"""A whole mission as frozen values: map, team, poses, goal, gains, planner, radio, clock, faults, seed.

Reading files is onehop/scenario's work; here are the values, their defaults with units and source, and
the conditions that they must fulfil (`problems`).
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, get_args

from onehop.contracts.fault_section import FaultSection
from onehop.contracts.plugin_names import GAIN_POLICIES, PLANNERS, PROPAGATION, ROUTING
from onehop.contracts.problems import Problem
from onehop.contracts.program_section import BUILT_IN as TEAM_PROGRAM
from onehop.contracts.radio_section import PropagationName, RadioSection, RoutingName
from onehop.contracts.ranges import Range, out_of_range
from onehop.contracts.robot_entry import RobotEntry
from onehop.contracts.sections import (
    ClockSection,
    GainPolicyName,
    GainsSection,
    GoalSection,
    MapSection,
    PlannerName,
    PlannerSection,
    RobotSection,
    StartSection,
    TeamSection,
)

NAME = re.compile(r"\w[^/\\]*")
NAME_BYTES = 200
"""What a scenario may be called: its log's folder bears the name, and the time of its run."""

BUILT_IN: dict[str, tuple[str, ...]] = {
    PLANNERS: get_args(PlannerName),
    GAIN_POLICIES: get_args(GainPolicyName),
    ROUTING: get_args(RoutingName),
    PROPAGATION: get_args(PropagationName),
}
"""Names that cores know themselves, by group."""


def plugins(names: dict[str, str]) -> dict[str, str]:
    """Those of these names, by group, that are not built in."""
    return {group: name for group, name in names.items() if name not in BUILT_IN[group]}


PATH_END = 0.5
"""Distance of a given path's end from the goal, at most, in the goal's tolerances: a leader arrives at
0.6 of them."""


@dataclass(frozen=True, slots=True)
class Scenario:
    """One mission. Sections as above; seed fixes everything random in the run.

    programs: the folder of its robots' programs, seen from the file's own; empty for the file's own.
    robots: those that have something of their own. profile: "team", the defaults of the sections, or
    "thesis", which fills in the thesis's own where a file leaves them out (onehop/scenario/profile.py).
    Nothing but reading a file looks at it.
    """

    name: str
    goal: GoalSection
    map: MapSection
    programs: str = ""
    start: StartSection = field(default_factory=StartSection)
    seed: Annotated[int, Range(0, 2**63 - 1)] = 1
    profile: Literal["team", "thesis"] = "team"
    team: TeamSection = field(default_factory=TeamSection)
    robot: RobotSection = field(default_factory=RobotSection)
    gains: GainsSection = field(default_factory=GainsSection)
    planner: PlannerSection = field(default_factory=PlannerSection)
    radio: RadioSection = field(default_factory=RadioSection)
    clock: ClockSection = field(default_factory=ClockSection)
    robots: tuple[RobotEntry, ...] = ()
    faults: tuple[FaultSection, ...] = ()

    @property
    def plugins(self) -> dict[str, str]:
        """What it takes that is not built in: names by group (onehop/plugins.py)."""
        return plugins(
            {
                PLANNERS: self.planner.kind,
                GAIN_POLICIES: self.gains.policy,
                ROUTING: self.radio.routing,
                PROPAGATION: self.radio.propagation,
            }
        )

    def program_of(self, robot: int) -> tuple[str, dict[str, Any]]:
        """The program that drives a robot, and the parameters that it is given."""
        team = self.team
        own = next((one for one in self.robots if one.id == robot), None)
        if own is None:
            return team.program, team.parameters
        if own.program:
            return own.program, own.parameters
        return team.program, {**team.parameters, **own.parameters}

    @property
    def room_at_goal(self) -> float:
        """Distance from the goal within which robots that come one by one have arrived [m].

        n discs as wide as the planner's zone need, around the first one, a disc whose radius grows with
        the root of their number.
        """
        others = len(self.team.robots) - 1
        return self.goal.tolerance + 2.0 * self.planner.inflation * math.sqrt(others)

    @property
    def commands(self) -> dict[int, tuple[str, ...]]:
        """Of the robots that are processes of somebody else's making: what starts them."""
        return {one.id: one.command for one in self.robots if one.command}

    @property
    def bases(self) -> dict[int, tuple[str, ...]]:
        """Of robots with a real base, ids ascending: what starts its driver here, if anything does."""
        own = sorted(self.robots, key=lambda one: one.id)
        return {one.id: one.base_command for one in own if one.is_hardware}

    def has_own_programs(self) -> bool:
        """Whether another program than the built-in team drives anybody, or anything is plugged in."""
        programs = {self.program_of(robot)[0] for robot in self.team.robots}
        return bool(self.commands or self.plugins) or programs != {TEAM_PROGRAM}

    def body_of(self, robot: int) -> RobotSection:
        """Body and sensors of a robot: section [robot], and what its own entry says."""
        own = next((one for one in self.robots if one.id == robot), None)
        return self.robot if own is None else own.body.of(self.robot)

    @property
    def bodies(self) -> tuple[RobotSection, ...]:
        """Of every robot, in order of id."""
        return tuple(self.body_of(robot) for robot in self.team.robots)

    def problems(self) -> Iterator[Problem]:
        """Everything that keeps this mission from being run: ranges, sections, then across them."""
        if not _is_name(self.name):
            yield Problem(
                "name",
                f"{self.name!r:.60} is no name",
                f"a letter or digit, then what can be printed but / and \\, at most {NAME_BYTES} bytes",
            )
        yield from out_of_range(self)
        for section in ("map", "team", "gains", "planner", "radio"):
            for problem in getattr(self, section).problems():
                yield problem._replace(key=f"{section}.{problem.key}")
        robots = self.team.robots
        if self.start.poses and len(self.start.poses) != len(robots):
            yield Problem(
                "start.poses",
                f"{len(self.start.poses)} poses for {len(robots)} robots",
                "one [x, y, heading_deg] for each robot, in order of id",
            )
        widest, whose = self._widest()
        if self.planner.inflation < widest:
            yield Problem(
                "planner.inflation",
                f"{self.planner.inflation} m is less than {whose} {widest} m",
                "at least the radius",
            )
        if self.planner.kind == "path":
            yield from self._path_problems()
        yield from self._robot_problems()
        for number, fault in enumerate(self.faults):
            for problem in fault.problems():
                yield problem._replace(key=f"faults[{number}].{problem.key}")
            for robot in fault.robots if fault.kind == "kidnap" else ():
                if robot in self.bases:
                    what, remedy = f"robot {robot} has a real base", "a robot with a simulated one"
                    yield Problem(
                        f"faults[{number}].robots", f"{what}: nobody can put it elsewhere", remedy
                    )
            strangers = sorted({*fault.robots, *fault.others} - set(robots))
            if strangers:
                yield Problem(
                    f"faults[{number}].robots",
                    f"robot {strangers[0]} is not in the team",
                    f"ids of the team: {', '.join(map(str, robots))}",
                )

    def _widest(self) -> tuple[float, str]:
        """The largest radius of a robot [m], and its key."""
        own = [(one.body.radius or 0.0, f"robots[{n}].body.radius") for n, one in enumerate(self.robots)]
        return max([(self.robot.radius, "robot.radius"), *own], key=lambda one: one[0])

    def _robot_problems(self) -> Iterator[Problem]:
        team, seen = self.team.robots, set[int]()
        for number, one in enumerate(self.robots):
            if one.id not in team:
                ids = ", ".join(map(str, team))
                yield Problem(
                    f"robots[{number}].id", f"robot {one.id} is not in the team", f"one of {ids}"
                )
            if one.id in seen:
                yield Problem(f"robots[{number}].id", f"robot {one.id} stands twice", "every id once")
            seen.add(one.id)
            for problem in one.problems():
                yield problem._replace(key=f"robots[{number}].{problem.key}")
            if one.is_hardware and not (self.clock.is_realtime and self.clock.speed == 1.0):
                what = "a real base goes by the wall clock"
                remedy = 'clock.mode = "realtime" with clock.speed = 1.0 (--clock realtime)'
                yield Problem(f"robots[{number}].base", what, remedy)

    def _path_problems(self) -> Iterator[Problem]:
        """A leader has to see the path from where it starts, and has arrived at its end."""
        path, start, goal = self.planner.path, self.start, self.goal
        starts = start.poses or ((start.x, start.y, 0.0),)
        away = min(math.dist(path[0], place[:2]) for place in starts)
        sight = min(body.laser_range for body in self.bodies)
        if away > sight:
            yield Problem(
                "planner.path",
                f"its first point is {away:.1f} m from the start",
                f"at most the laser_range of every robot, {sight} m",
            )
        away, least = math.dist(path[-1], (goal.x, goal.y)), PATH_END * goal.tolerance
        if away > least:
            yield Problem(
                "planner.path",
                f"its last point is {away:.2f} m from the goal",
                f"at most {PATH_END} of goal.tolerance, {least:g} m",
            )


def _is_name(text: str) -> bool:
    return text.isprintable() and NAME.fullmatch(text) is not None and len(text.encode()) <= NAME_BYTES
