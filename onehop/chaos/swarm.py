"""The mission of a seed: map, team, gains, radio and faults, each drawn from a stream of its own.

Not only what happens is drawn but how often and how hard (swarm testing): one mission has three kinds of
faults and a bad radio, another none of either. What is drawn of one thing changes nothing of another.
"""

import dataclasses
import math
from typing import Any, Literal, TypeVar

import numpy as np

from onehop.chaos.fields import draw_field
from onehop.chaos.places import Places
from onehop.chaos.schedule import draw_faults
from onehop.contracts.errors import ScenarioError
from onehop.contracts.randomness import generator
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import (
    GainPolicyName,
    GainsSection,
    GoalSection,
    MapSection,
    Point,
    RobotSection,
    StartSection,
    TeamSection,
)
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from onehop.scenario.bundle import Bundle
from world_server.core.placement import start_poses

V = TypeVar("V")

CHAOS_S = (5.0, 40.0)
"""When the last fault has begun and those that end have ended, at least and at most [s]."""

WAY_M = (8.0, 35.0)
"""Length of the shortest way from start to goal [m]."""

SLACK_S = 60.0
WAY_FACTOR = 12.0
"""How long a mission may take beyond faults and setup: so much, and so often the time that its shortest
way takes. A leader that has to explore drives two to three times that; before a passage that is hardly
wider than the clearance that it keeps a large team comes and goes, and has taken nine times that."""

_SIZES = (1, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5, 6, 6, 6, 7, 7, 8, 9, 10, 11, 12)
_HIGHEST_ID = 99
_DRAWS = 30
"""Pairs of start and goal tried on a map."""


def stream(seed: int, what: str) -> np.random.Generator:
    """The random stream of one thing that a seed draws."""
    return generator(seed, f"chaos/{what}")


def draw_mission(base: Bundle, seed: int, budget: bool) -> Bundle:
    """The mission of a seed. base: what is not drawn is as there, its map among those to draw from.

    budget: only faults that the team is to survive; otherwise any.
    """
    scenario = base.scenario
    team = _team(stream(seed, "team"), scenario.team)
    robot = _robot(stream(seed, "robot"), scenario.robot)
    drawn = dataclasses.replace(
        scenario,
        name=f"chaos-{seed}",
        seed=seed,
        team=team,
        robot=robot,
        robots=tuple(one for one in scenario.robots if one.id in team.robots),
        gains=_gains(stream(seed, "gains"), scenario.gains),
        radio=_radio(stream(seed, "radio"), scenario.radio),
        start=StartSection(),
        faults=(),
    )
    drawn, walls, files = _on_some_ground(stream(seed, "map"), drawn, base)
    places = Places(walls, drawn.planner.inflation)
    ways = places.ways_to((drawn.goal.x, drawn.goal.y))
    way = ways.length((drawn.start.x, drawn.start.y))
    slowest = min(body.leader_speed for body in drawn.bodies)
    until_s = round(float(stream(seed, "until").uniform(*CHAOS_S)), 1)
    clock = dataclasses.replace(
        drawn.clock,
        limit_s=math.ceil(until_s + team.setup_timeout + SLACK_S + WAY_FACTOR * way / slowest),
    )
    faults = draw_faults(seed, team.robots, places, ways, until_s, budget)
    own = tuple(one for one in drawn.robots if one.id in team.robots)
    return dataclasses.replace(
        base,
        scenario=dataclasses.replace(drawn, clock=clock, faults=faults, robots=own),
        files=files,
    )


def _team(random: np.random.Generator, own: TeamSection) -> TeamSection:
    size = _one(random, *_SIZES)
    ids: tuple[int, ...] = ()
    if random.random() < 0.3:
        ids = tuple(sorted(int(i) + 1 for i in random.permutation(_HIGHEST_ID)[:size]))
    period = _one(random, 2.0, 2.0, 2.0, 1.0, 3.0)
    return dataclasses.replace(
        own,
        size=size,
        ids=ids,
        next_period=period,
        leader_timeout=2.5 * period,
        successor_timeout=0.5 * period,
        lost_after=_one(random, 2, 2, 3),
        spacing=_one(random, 4.0, 4.0, 3.0, 5.0),
        straggler_speed=_one(random, 1.0, 1.0, 0.5),
        setup_timeout=_one(random, 40.0, 20.0),
    )


def _robot(random: np.random.Generator, own: RobotSection) -> RobotSection:
    return dataclasses.replace(own, leader_speed=round(float(random.uniform(0.4, 1.0)), 2))


def _gains(random: np.random.Generator, own: GainsSection) -> GainsSection:
    policy: GainPolicyName = _one(
        random, "throughput", "throughput", "smooth", "constant", "predictive", "lambda2"
    )
    threshold: Literal["thesis", "ideal"] = _one(random, "thesis", "ideal")
    low = _one(random, 1.0, 1.0, 0.3)
    return dataclasses.replace(own, policy=policy, threshold=threshold, k_rho_min=low)


def _radio(random: np.random.Generator, own: Any) -> Any:
    return dataclasses.replace(
        own,
        links="",  # of a team that is not the one that is drawn
        preset=_one(random, "thesis", "thesis", "thesis", "physical", "indoor"),
        routing=_one(random, "mrdv", "mrsr", "direct"),
        rate_mbps=_one(random, 1.0, 1.0, 2.0, 5.5, 11.0),
        rts_threshold_bytes=_one(random, 0, 0, 2304),
        fading=_one(random, "frame", "frame", "exchange"),
        fast_fading=_one(random, "none", "none", "none", "rayleigh", "rician"),
        wall_loss_db=_one(random, 0.0, 0.0, 6.0),
        queue_frames=_one(random, 64, 64, 16),
    )


def _one(random: np.random.Generator, *choices: V) -> V:
    return choices[int(random.integers(len(choices)))]


def _on_some_ground(
    random: np.random.Generator, drawn: Scenario, base: Bundle
) -> tuple[Scenario, WallMap, dict[str, bytes]]:
    """The mission with a map, a start and a goal; on an empty field if nothing else has room."""
    own = _one(random, True, False, False)
    candidates = [(draw_field(random), {})] if not own else [(base.scenario.map, base.files)]
    candidates.append((MapSection(width=60.0, height=60.0), {}))
    for ground, files in candidates:
        walls = load_map(ground, files)
        placed = _placed(random, dataclasses.replace(drawn, map=ground), walls)
        if placed is not None:
            return placed, walls, files
    raise AssertionError("no room for a team on an empty field")


def _placed(random: np.random.Generator, drawn: Scenario, walls: WallMap) -> Scenario | None:
    """The mission with a start and a goal that are some way apart; None if none was found."""
    places = Places(walls, drawn.planner.inflation)
    for _ in range(_DRAWS):
        start, goal = places.drawn(random), places.drawn(random)
        if start is None or goal is None or math.dist(start, goal) > WAY_M[1]:
            continue
        if not WAY_M[0] <= places.ways_to(goal).length(start) <= WAY_M[1]:
            continue
        placed = _between(drawn, start, goal)
        try:
            start_poses(placed, walls)
        except ScenarioError:
            continue
        return placed
    return None


def _between(drawn: Scenario, start: Point, goal: Point) -> Scenario:
    return dataclasses.replace(
        drawn,
        start=StartSection(x=start[0], y=start[1]),
        goal=GoalSection(x=goal[0], y=goal[1], tolerance=drawn.goal.tolerance),
    )
