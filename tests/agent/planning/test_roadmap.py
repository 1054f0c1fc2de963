"""Local road maps: what they keep clear of, A*, and what the view says about free space."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from onehop.contracts.beams import Beams
from onehop.contracts.randomness import generator
from onehop.contracts.sections import RobotSection
from onehop.maps.map_file import load_map
from onehop.maps.walls import segment_distances
from robot_agent.core.planning.distances import squared_distances
from robot_agent.core.planning.roadmap import RoadMap
from robot_agent.core.planning.sampling import sample_fan
from robot_agent.core.planning.view import NO_POINTS, View
from tests.agent.planning.fields import box, field, look
from world_server.core.laser import Laser

BODY = RobotSection()
BEAMS = Beams(BODY)
BLOCKS = field(box(16, 6, 18, 12), box(14, 14, 15, 20), box(20, 13, 24, 15), size=30.0)


def road_map(view: View, seed: int = 1, samples: int = 200) -> RoadMap:
    draws = generator(seed, "test").random((samples, 2))
    points = sample_fan(view, draws, view.pose.heading, math.pi / 2, 0.5)
    return RoadMap(view, points, NO_POINTS, 0.52, 0.7)


@pytest.mark.parametrize("heading", [0.0, 0.9, 0.4, -0.5])
def test_every_edge_keeps_the_inflation_from_the_outline_through_the_hits(heading: float) -> None:
    """However far away: hits up to 1 m apart (20 grains) stand for the wall between them."""
    view = look(BLOCKS, 10.0, 11.0, heading)
    roadmap = road_map(view)
    hits = view.origin + view.directions[view.solid] * view.sight[view.solid, None]
    walls = np.concatenate((hits[:-1], hits[1:]), axis=1)[np.hypot(*np.diff(hits, axis=0).T) < 1.0]
    assert len(walls) > 50
    for share in np.linspace(0.0, 1.0, 41):
        points = roadmap.edges[:, :2] + share * (roadmap.edges[:, 2:] - roadmap.edges[:, :2])
        assert segment_distances(points, walls).min() >= 0.5


@pytest.mark.parametrize("heading", [0.0, 0.9, 0.4])
def test_every_edge_keeps_the_inflation_from_all_that_can_be_seen(heading: float) -> None:
    """Seen by a laser with twenty times the beams; what lies in a shadow no scan can keep clear of.

    Within 5 m of the robot, three times what it drives before it looks again. A corner between two hits
    can stand out from the outline by half of their distance: 2 cm, the spare clearance, at 2.2 m, and
    more further away, where the robot does not go before it has looked from nearer.
    """
    roadmap = road_map(look(BLOCKS, 10.0, 11.0, heading))
    ends = roadmap.edges.reshape(-1, 2, 2) - roadmap.view.origin
    edges = roadmap.edges[np.hypot(ends[..., 0], ends[..., 1]).max(axis=1) < 5.0]
    assert len(edges) > 50
    fine = replace(BODY, laser_beams=3601)
    pose = np.array([(10.0, 11.0, heading)])
    scan = Laser(load_map(BLOCKS, {}), fine).scans(pose, np.zeros(1, dtype=np.int32))[0]
    seen = View(Beams(fine), roadmap.view.pose, scan, 1e-4).obstacles
    for share in np.linspace(0.0, 1.0, 9):
        points = edges[:, :2] + share * (edges[:, 2:] - edges[:, :2])
        assert squared_distances(points, seen).min() >= 0.5**2


def test_a_star_finds_the_cheapest_way() -> None:
    """A* and the costs by relaxation are two algorithms; the way's edges add up to the cost."""
    roadmap = road_map(look(BLOCKS, 10.0, 11.0, 0.0))
    costs = roadmap.costs()
    length = {(0, there): cost for there, cost in enumerate(roadmap.direct.tolist())}
    for neighbours, lengths in zip(roadmap.neighbours, roadmap.lengths, strict=True):
        pairs = zip(range(len(costs)), neighbours.tolist(), strict=True)
        length.update(zip(pairs, lengths.tolist(), strict=True))
    reachable = np.flatnonzero(np.isfinite(costs))[1:]
    assert len(reachable) > 100
    for goal in reachable[::10].tolist():
        chain = roadmap.chain(goal)
        total = sum(length[a, b] for a, b in itertools.pairwise(chain))
        assert total == pytest.approx(costs[goal], abs=1e-6)


def test_a_point_without_edges_has_no_way() -> None:
    roadmap = road_map(look(BLOCKS, 10.0, 11.0, 0.0))
    unreachable = np.flatnonzero(~np.isfinite(roadmap.costs()))
    for goal in unreachable.tolist():
        assert len(roadmap.path(goal)) == 0
    roadmap.direct[1:] = math.inf
    assert len(roadmap.path(len(roadmap.points) - 1)) == 0


def test_same_draws_make_the_same_road_map() -> None:
    view = look(BLOCKS, 10.0, 11.0, 0.3)
    assert road_map(view).edges.tobytes() == road_map(view).edges.tobytes()
    assert road_map(view).edges.tobytes() != road_map(view, seed=2).edges.tobytes()


def test_what_lies_behind_a_wall_is_not_visible() -> None:
    view = look(BLOCKS, 10.0, 9.0, 0.0)
    points = np.array(((15.0, 9.0), (19.0, 9.0), (8.0, 9.0), (20.5, 9.0)))
    assert view.visible(points).tolist() == [True, False, False, False]


def test_who_stands_inside_the_inflation_may_move_out_but_not_further_in() -> None:
    view = look(field(box(12, 0, 13, 30), size=30.0), 11.7, 15.0, math.pi)
    wall = np.column_stack((np.full(60, 12.0), np.linspace(13.0, 17.0, 60)))
    view = View(BEAMS, view.pose, np.full(181, np.inf, dtype=np.float32), 0.05, wall)
    here = np.array(((11.7, 15.0),))
    assert view.passable(here, np.array(((10.5, 15.0),)), 0.5)[0]
    assert not view.passable(here, np.array(((11.9, 15.4),)), 0.5)[0]
