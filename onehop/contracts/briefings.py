"""What each process is told before it starts: a robot learns neither the map nor the others' poses."""

from dataclasses import replace
from typing import Any

from onehop.contracts.arrays import FloatArray
from onehop.contracts.link_trace import LinkTrace
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import (
    GainsSection,
    GoalSection,
    PlannerSection,
    RobotSection,
    TeamSection,
)
from onehop.contracts.values import Wire


class Briefing(Wire, frozen=True):
    """All that a robot is told before it starts (thesis 3.3.2): never the map, never others' poses.

    incarnation: 0 for the first process of this robot, one more for each restart. seed: of the mission.
    robots: ids of all that take part. period_ns: length of a tick. silence_s: wall-clock time after
    which a process that says nothing is given up [s]. program, parameters: of this robot; on the wire a
    table, for the program itself an instance of its `Parameters`. team: ids are those of the robots
    with the same program; the rest of it, gains and planner are what the built-in team goes by.
    """

    robot: int
    incarnation: int
    seed: int
    robots: tuple[int, ...]
    period_ns: int
    silence_s: float
    program: str
    parameters: Any
    goal: GoalSection
    team: TeamSection
    body: RobotSection
    gains: GainsSection
    planner: PlannerSection
    radio: RadioSection

    def plugin(self, group: str) -> Any:  # noqa: ARG002 - see PluggedBriefing
        """What is plugged in under a group (plugin_names.py); None where a built-in one is named."""
        return None


class PluggedBriefing(Briefing, frozen=True):
    """The same where the robot is made: with planner and gain policy that are not built in, by group."""

    plugins: dict[str, Any]

    def plugin(self, group: str) -> Any:
        return self.plugins.get(group)


class RadioBriefing(Wire, frozen=True, omit_defaults=True):
    """All that the radio proxy is told before it starts.

    walls: segments x0, y0, x1, y1 [m]. links: that were measured, if there are any. speed: simulated
    seconds in one of the wall clock; 0 in lock-step.
    """

    seed: int
    period_ns: int
    robots: tuple[int, ...]
    radio: RadioSection
    walls: tuple[tuple[float, float, float, float], ...]
    links: LinkTrace | None = None
    speed: float = 0.0

    def plugin(self, group: str) -> Any:  # noqa: ARG002 - see PluggedRadioBriefing
        """What is plugged in under a group (plugin_names.py); None where a built-in one is named."""
        return None


class PluggedRadioBriefing(RadioBriefing, frozen=True):
    """The same where the radio is made: with routing and propagation that are not built in, by group."""

    plugins: dict[str, Any] = {}  # noqa: RUF012 - a struct copies its defaults

    def plugin(self, group: str) -> Any:
        return self.plugins.get(group)


class LogBriefing(Wire, frozen=True):
    """What goes into a log before its first tick.

    driver: what the log calls this way of running. programs: the folder of the robots' own programs.
    """

    driver: str
    scenario_json: str
    files: tuple[tuple[str, bytes], ...]
    programs: str


def robot_briefing(scenario: Scenario, robot: int, incarnation: int) -> Briefing:
    """What robot `robot` may know of a scenario."""
    program, parameters = scenario.program_of(robot)
    return Briefing(
        robot=robot,
        incarnation=incarnation,
        seed=scenario.seed,
        robots=scenario.team.robots,
        period_ns=scenario.clock.period_ns,
        silence_s=scenario.clock.silence_s,
        program=program,
        parameters=parameters,
        goal=_goal_of(scenario),
        team=_team_of(scenario, robot, program),
        body=scenario.body_of(robot),
        gains=scenario.gains,
        planner=scenario.planner,
        radio=scenario.radio,
    )


def _goal_of(scenario: Scenario) -> GoalSection:
    """The goal; without a link each robot comes alone, and needs room beside those that are there."""
    if scenario.radio.link == "none":
        return replace(scenario.goal, tolerance=scenario.room_at_goal)
    return scenario.goal


def _team_of(scenario: Scenario, robot: int, program: str) -> TeamSection:
    """The team's section as a robot of this program sees it: others do not speak its language.

    Without a link it is a team of one, that leads itself to the goal from the start on: what the others
    would wait for, and elect, is nothing that a robot without a radio has.
    """
    team = scenario.team
    if scenario.radio.link == "none":
        return replace(team, ids=(robot,))
    alike = tuple(robot for robot in team.robots if scenario.program_of(robot)[0] == program)
    return team if alike == team.robots else replace(team, ids=alike)


def radio_briefing(
    scenario: Scenario, walls: FloatArray, links: LinkTrace | None = None
) -> RadioBriefing:
    """What the radio proxy may know; walls, (n, 4) [m], only if they weaken signals."""
    segments = walls.tolist() if scenario.radio.wall_loss_db > 0 else []
    return RadioBriefing(
        seed=scenario.seed,
        period_ns=scenario.clock.period_ns,
        robots=scenario.team.robots,
        radio=scenario.radio,
        walls=tuple((x0, y0, x1, y1) for x0, y0, x1, y1 in segments),
        links=links,
        speed=scenario.clock.speed if scenario.clock.is_realtime else 0.0,
    )
