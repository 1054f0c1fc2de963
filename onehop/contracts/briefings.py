"""What each process is told before it starts: a robot learns neither the map nor the others' poses."""

from onehop.contracts.arrays import FloatArray
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
    """All that a robot is told before it starts (thesis 3.3.2): never the map, never others' poses."""

    robot: int
    incarnation: int
    seed: int
    period_ns: int
    goal: GoalSection
    team: TeamSection
    body: RobotSection
    gains: GainsSection
    planner: PlannerSection
    radio: RadioSection


class RadioBriefing(Wire, frozen=True):
    """All that the radio proxy is told before it starts. walls: segments x0, y0, x1, y1 [m]."""

    seed: int
    period_ns: int
    robots: tuple[int, ...]
    radio: RadioSection
    walls: tuple[tuple[float, float, float, float], ...]


class LogBriefing(Wire, frozen=True):
    """What goes into a log before its first tick. driver: what the log calls this way of running."""

    driver: str
    scenario_json: str
    files: tuple[tuple[str, bytes], ...]


def robot_briefing(scenario: Scenario, robot: int, incarnation: int) -> Briefing:
    """What robot `robot` may know of a scenario."""
    return Briefing(
        robot=robot,
        incarnation=incarnation,
        seed=scenario.seed,
        period_ns=scenario.clock.period_ns,
        goal=scenario.goal,
        team=scenario.team,
        body=scenario.robot,
        gains=scenario.gains,
        planner=scenario.planner,
        radio=scenario.radio,
    )


def radio_briefing(scenario: Scenario, walls: FloatArray) -> RadioBriefing:
    """What the radio proxy may know; walls, (n, 4) [m], only if they weaken signals."""
    segments = walls.tolist() if scenario.radio.wall_loss_db > 0 else []
    return RadioBriefing(
        seed=scenario.seed,
        period_ns=scenario.clock.period_ns,
        robots=scenario.team.robots,
        radio=scenario.radio,
        walls=tuple((x0, y0, x1, y1) for x0, y0, x1, y1 in segments),
    )
