"""The leader's way: where a column drives on it, and which way the formation looks."""

import math

import numpy as np
import pytest

from onehop.contracts.geometry import Pose
from robot_agent.core.motion.trail import Trail, behind


def test_a_column_drives_on_the_leaders_way_around_a_corner():
    trail = ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0))
    pose = behind(Pose(4.0, 3.0, math.pi / 2), trail, 4.0)
    assert (pose.x, pose.y, pose.heading) == pytest.approx((3.0, 0.0, 0.0))
    before = behind(Pose(4.0, 3.0, math.pi / 2), trail, 9.0)
    assert (before.x, before.y) == pytest.approx((-2.0, 0.0))


def drive_trail(*corners):
    """A trail after driving straight from corner to corner."""
    trail, pose = Trail(), Pose(*corners[0], 0.0)
    for x, y in corners[1:]:
        steps = max(1, round(math.dist((pose.x, pose.y), (x, y)) / 0.05))
        heading = math.atan2(y - pose.y, x - pose.x)
        for share in np.linspace(0.0, 1.0, steps + 1)[1:]:
            trail.mark(Pose(pose.x + share * (x - pose.x), pose.y + share * (y - pose.y), heading))
        pose = Pose(x, y, heading)
    return trail, pose


def test_a_leader_that_turns_on_the_spot_does_not_turn_its_formation():
    trail, pose = drive_trail((0.0, 0.0), (10.0, 0.0))
    for heading in (0.0, 1.5, math.pi, -2.0):
        turned = Pose(pose.x, pose.y, heading)
        trail.mark(turned)
        assert trail.course(turned) == pytest.approx(0.0)


def test_a_leader_that_comes_back_pushes_its_column_out_backwards():
    trail, pose = drive_trail((0.0, 0.0), (20.0, 0.0), (8.0, 0.0))
    assert max(x for x, _ in trail.points) < 10.0, "the dead end is forgotten"
    assert trail.course(pose) == pytest.approx(0.0)
    assert behind(pose, trail.points, 3.0).x == pytest.approx(5.0, abs=0.8)


def test_a_leader_that_leaves_its_way_turns_the_formation():
    trail, pose = drive_trail((0.0, 0.0), (20.0, 0.0), (8.0, 0.0), (8.0, 6.0))
    assert trail.course(pose) == pytest.approx(math.pi / 2, abs=0.2)


def test_at_the_start_the_formation_looks_where_the_leader_does():
    assert Trail().course(Pose(1.0, 2.0, 0.7)) == 0.7
