"""What a robot knows of the ground behind it: only what it saw free a moment ago."""

import math

import numpy as np

from onehop.contracts.geometry import Pose
from robot_agent.core.motion.rear_view import FARTHEST, MOMENT, RearView
from tests.agent.motion.scans import BEAMS, BODY, HERE, OPEN, PERIOD, block

TURNED = Pose(0.0, 0.0, math.pi)
"""Where it stands, looking the other way."""


def seen(scan=OPEN, pose=HERE, seconds=0.2):
    """A robot that stood there and saw this for a while."""
    view = RearView(BODY, BEAMS, PERIOD)
    for _ in range(round(seconds / PERIOD)):
        view.see(pose, scan)
    return view


def test_ground_that_it_looked_at_before_it_turned_is_free() -> None:
    back = seen(pose=Pose(-0.6, 0.0, 0.0))
    assert back.free(TURNED, 1.0, 0.0)
    assert not seen().free(TURNED, 1.0, 0.0), "right before its own hull it has seen nothing yet"


def test_ground_that_was_never_in_view_is_not() -> None:
    assert not seen().free(HERE, -1.0, 0.0)
    assert not RearView(BODY, BEAMS, PERIOD).free(HERE, -1.0, 0.0)


def test_something_on_the_way_or_beside_it_keeps_it_from_backing_up() -> None:
    for bearing, distance in ((0, 1.5), (20, 1.6), (-20, 1.6)):
        scan = block(bearing - 1, bearing + 1, distance)
        assert not seen(scan, Pose(-0.6, 0.0, 0.0)).free(TURNED, 1.0, 0.0)
    assert seen(block(39, 41, 1.6), Pose(-0.6, 0.0, 0.0)).free(TURNED, 1.0, 0.0)


def test_what_is_behind_something_was_not_seen() -> None:
    assert not seen(block(-90, 90, 1.5), Pose(-0.6, 0.0, 0.0)).free(TURNED, 1.6, 0.0)


def test_after_a_moment_it_is_forgotten() -> None:
    view = seen(pose=Pose(-0.6, 0.0, 0.0))
    for _ in range(round(MOMENT / PERIOD) - 4):
        view.see(TURNED, OPEN)
    assert view.free(TURNED, 1.0, 0.0)
    for _ in range(8):
        view.see(TURNED, OPEN)
    assert not view.free(TURNED, 1.0, 0.0)


def test_what_was_beside_the_way_may_have_come_nearer_since() -> None:
    """A robot seen 0.8 m beside the way back; the others move as fast as the leader, 1 m/s."""
    scan = block(27, 28, 1.7)
    view = seen(scan, Pose(-0.6, 0.0, 0.0))
    assert view.free(TURNED, 1.0, 0.0)
    for _ in range(round(0.6 / PERIOD)):
        view.see(TURNED, OPEN)
    assert not view.free(TURNED, 1.0, 0.0)


def test_a_slot_far_behind_is_turned_to() -> None:
    view = seen(np.full(181, 10.0, np.float32), Pose(-0.6, 0.0, 0.0))
    assert view.free(TURNED, FARTHEST - 0.1, 0.0)
    assert not view.free(TURNED, FARTHEST + 0.1, 0.0)
