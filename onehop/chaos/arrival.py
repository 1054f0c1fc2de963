"""Whether a mission that did not arrive should have: the goal can be reached, and there was time."""

import math
from typing import Any

from onehop.chaos.disturbance import Disturbance
from onehop.chaos.places import Places
from onehop.chaos.swarm import SLACK_S, WAY_FACTOR
from onehop.maps.map_file import load_map
from onehop.scenario.bundle import Bundle


def why_it_should_have(bundle: Bundle, summary: dict[str, Any], end: Disturbance) -> str | None:
    """What speaks against a mission that has failed, in a sentence; None if it is excused.

    end: what was broken when it ended. Whoever is whole then must have a way to the goal past all who
    are not, and must have had the time for it since it became quiet. It is excused as well when a leader
    has reached the goal since: then others were under way when the time was up.
    """
    scenario = bundle.scenario
    whole = [one for one in end.present if one.robot in end.whole]
    if summary["outcome"] != "failed" or not whole or end.arrived_at >= end.quiet_since:
        return None
    quiet_s = end.quiet_since * scenario.clock.period_ns / 1e9
    places = Places(load_map(scenario.map, bundle.files), scenario.planner.inflation)
    bodies = [(one.pose.x, one.pose.y) for one in end.present if one.robot not in end.whole]
    bodies += end.graves.values()
    goal = scenario.goal.x, scenario.goal.y
    radius = 2.0 * max(body.radius for body in scenario.bodies) + scenario.planner.inflation
    ways = places.ways_past(goal, bodies, radius)
    way = min(ways.length((one.pose.x, one.pose.y)) for one in whole)
    speed = min(body.leader_speed for body in scenario.bodies)
    had_time = summary["sim_s"] - quiet_s >= SLACK_S + WAY_FACTOR * way / speed
    is_at_limit = summary["sim_s"] >= scenario.clock.limit_s
    if math.isinf(way) or (is_at_limit and not had_time):
        return None
    ids = ", ".join(str(one.robot) for one in whole)
    return (
        f"{summary['reason']}: robots {ids} are whole and have had {summary['sim_s'] - quiet_s:.0f} s "
        f"of quiet, and the goal is {way:.0f} m away"
    )
