"""What radio and recorder are told before they start (a robot's briefing is in contracts)."""

from onehop.contracts.scenario import RadioBriefing, Scenario
from onehop.contracts.values import Wire
from world_server.core.walls import WallMap


class LogBriefing(Wire, frozen=True):
    """What goes into a log before its first tick."""

    driver: str
    scenario_json: str
    files: tuple[tuple[str, bytes], ...]


def radio_briefing(scenario: Scenario, walls: WallMap) -> RadioBriefing:
    """What the radio proxy may know; walls only if the scenario lets them weaken the signal."""
    segments = walls.segments.tolist() if scenario.radio.wall_loss_db > 0 else []
    return RadioBriefing(
        seed=scenario.seed,
        period_ns=scenario.clock.period_ns,
        robots=scenario.team.robots,
        radio=scenario.radio,
        walls=tuple((x0, y0, x1, y1) for x0, y0, x1, y1 in segments),
    )
