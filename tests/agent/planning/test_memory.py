"""Way points: a bounded graph, its shortest ways, and what is forgotten when it is full."""

import math

import pytest

from robot_agent.core.planning.memory import CLOSED, DEGREE, FRONTIER, NOTHING, PLACE, WayPoints


def line(count: int, capacity: int = 16) -> WayPoints:
    """Places 1 m apart on a line, each joined to the next."""
    points = WayPoints(capacity)
    for k in range(count):
        points.add(float(k), 0.0, PLACE)
    for k in range(count - 1):
        points.join(k, k + 1, 1.0)
    return points


def test_routes_come_in_order_of_cost_with_where_they_come_from() -> None:
    points, origin = line(5), {}
    points.join(0, 4, 2.5)
    reached = list(points.routes({0: 0.5}, origin))
    assert reached == [(0, 0.5), (1, 1.5), (2, 2.5), (4, 3.0), (3, 3.5)]
    assert origin == {0: NOTHING, 1: 0, 2: 1, 4: 0, 3: 2}


def test_a_parted_edge_is_no_way() -> None:
    points = line(3)
    points.part(1, 2)
    assert [number for number, _ in points.routes({0: 0.0}, {})] == [0, 1]


def test_a_moved_way_point_is_not_reached_by_its_old_edges() -> None:
    """They had the lengths to where it was: a receding frontier drew the robot around a pillar."""
    points = line(3)
    points.move(1, 9.0, 9.0)
    assert points.xy[1].tolist() == [9.0, 9.0]
    assert [number for number, _ in points.routes({0: 0.0}, {})] == [0]


def test_of_parallel_edges_the_shorter_stays() -> None:
    points = line(2)
    points.join(1, 0, 3.0)
    points.join(0, 1, 0.25)
    assert dict(points.routes({0: 0.0}, {}))[1] == 0.25


def test_the_shortest_edges_stay_when_a_way_point_has_too_many() -> None:
    points = WayPoints(2 * DEGREE)
    for k in range(DEGREE + 2):
        points.add(float(k), 0.0, PLACE)
    for k in range(1, DEGREE + 2):
        points.join(0, k, 10.0 - k)
    peers = set(points._peer[:DEGREE])
    assert peers == set(range(2, DEGREE + 2))


def test_the_oldest_closed_one_makes_room_and_its_edges_are_gone() -> None:
    points = line(4, capacity=4)
    assert not points.has_room
    points.close(2)
    points.close(1)
    assert points.has_room
    assert points.add(9.0, 9.0, FRONTIER) == 2
    assert points.of_kind(CLOSED).tolist() == [1]
    assert [number for number, _ in points.routes({0: 0.0}, {})] == [0]


def test_size_does_not_depend_on_what_is_remembered() -> None:
    """16 B of place, 1 of kind, 8 of age, and 12 for each of 8 edges: 121 B a way point."""
    assert line(5).nbytes == line(0).nbytes == 16 * (16 + 1 + 8 + DEGREE * 12)


def test_nearest_looks_at_the_asked_kinds_only() -> None:
    points = line(3)
    points.add(0.4, 0.0, FRONTIER)
    assert points.nearest(0.3, 0.0, PLACE) == (0, pytest.approx(0.3))
    assert points.nearest(0.3, 0.0, PLACE + FRONTIER)[0] == 3
    assert points.nearest(0.3, 0.0, CLOSED) == (NOTHING, math.inf)
