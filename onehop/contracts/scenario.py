"""A whole mission as frozen values: map, team, poses, goal, gains, planner, radio, clock, faults, seed.

Reading files is onehop/scenario's work; here are the values, their defaults with units and source, and
the conditions that they must fulfil (`problems`).
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from onehop.contracts.problems import Problem
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.sections import (
    ClockSection,
    FaultSection,
    GainsSection,
    GoalSection,
    MapSection,
    PlannerSection,
    RobotSection,
    StartSection,
    TeamSection,
)


@dataclass(frozen=True, slots=True)
class Scenario:
    """One mission. Sections as above; seed fixes everything random in the run."""

    name: str
    goal: GoalSection
    map: MapSection
    start: StartSection = field(default_factory=StartSection)
    seed: int = 1
    team: TeamSection = field(default_factory=TeamSection)
    robot: RobotSection = field(default_factory=RobotSection)
    gains: GainsSection = field(default_factory=GainsSection)
    planner: PlannerSection = field(default_factory=PlannerSection)
    radio: RadioSection = field(default_factory=RadioSection)
    clock: ClockSection = field(default_factory=ClockSection)
    faults: tuple[FaultSection, ...] = ()

    def problems(self) -> Iterator[Problem]:
        """Everything that keeps this mission from being run, first the sections, then across them."""
        for section in (
            "map", "start", "goal", "team", "robot", "gains", "planner", "radio", "clock",
        ):  # fmt: skip
            for problem in getattr(self, section).problems():
                yield problem._replace(key=f"{section}.{problem.key}")
        if self.seed < 0:
            yield Problem("seed", f"{self.seed} is negative", "a whole number from 0")
        robots = self.team.robots
        if self.start.poses and len(self.start.poses) != len(robots):
            yield Problem(
                "start.poses",
                f"{len(self.start.poses)} poses for {len(robots)} robots",
                "one [x, y, heading_deg] for each robot, in order of id",
            )
        if self.planner.inflation < self.robot.radius:
            yield Problem(
                "planner.inflation",
                f"{self.planner.inflation} m is less than robot.radius {self.robot.radius} m",
                "at least the radius",
            )
        for number, fault in enumerate(self.faults):
            for problem in fault.problems():
                yield problem._replace(key=f"faults[{number}].{problem.key}")
            strangers = sorted({*fault.robots, *fault.others} - set(robots))
            if strangers:
                yield Problem(
                    f"faults[{number}].robots",
                    f"robot {strangers[0]} is not in the team",
                    f"ids of the team: {', '.join(map(str, robots))}",
                )
