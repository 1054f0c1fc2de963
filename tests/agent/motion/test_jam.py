"""Getting out of jams: when a robot is stuck, and what it does then, whatever its control period."""

import math

import pytest

from onehop.contracts.geometry import Pose
from robot_agent.core.motion.jam import (
    JAM_REACH,
    LEADER_STUCK_AFTER,
    UNJAM_FOR,
    FollowerJam,
    LeaderJam,
)
from robot_agent.core.motion.steering import TURN_IN_PLACE, Steering
from tests.agent.motion.scans import BEAMS, BODY, GAINS, HERE, block, walls

PERIODS = pytest.mark.parametrize("period", [0.02, 0.05, 0.1])
WAYPOINT = (5.0, 0.0)


def follower_jam(period, *draws):
    return FollowerJam(BODY, Steering(BODY, GAINS, BEAMS), period, draws)


@PERIODS
@pytest.mark.parametrize("every", [1, 3])
def test_a_follower_that_gets_nowhere_escapes_for_as_long_as_chance_says(period, every):
    """After two seconds and the longest turn on the spot, however often it is asked."""
    jam, tick = follower_jam(period, 0.25), 0
    jam.moved((3.0, 4.0), tick)
    while not jam.escaping:
        tick += every
        jam.moved((3.0, 4.0), tick)
    longest = 2.0 + (math.pi - TURN_IN_PLACE) / BODY.max_turn_rate
    assert tick * period == pytest.approx(longest, abs=(every + 0.1) * period)
    escaped = 0
    while jam.escaping:
        jam.escape()
        escaped += 1
    assert escaped * period == pytest.approx(1.0, abs=1.1 * period)


@PERIODS
@pytest.mark.parametrize(("speed", "stuck"), [(0.03, True), (0.05, False)])
def test_a_follower_slower_than_four_centimetres_a_second_is_stuck(period, speed, stuck):
    jam = follower_jam(period, 0.5)
    for tick in range(round(4.0 / period)):
        jam.moved((speed * period * tick, 0.0), tick)
    assert jam.escaping is stuck


@PERIODS
@pytest.mark.parametrize("forget", [FollowerJam.clear, FollowerJam.reset])
def test_a_follower_that_did_something_else_meanwhile_is_not_stuck_where_it_was_before(period, forget):
    jam = follower_jam(period, 0.5)
    jam.moved((3.0, 4.0), 0)
    forget(jam)
    jam.moved((3.0, 4.0), round(60.0 / period))
    assert not jam.escaping


def test_a_follower_turns_to_the_side_that_chance_chose_where_nothing_is_free():
    for draw, side in ((0.2, 1.0), (0.8, -1.0)):
        jam, tick = follower_jam(0.05, draw), 0
        while not jam.escaping:
            jam.moved((0.0, 0.0), tick)
            tick += 1
        jam.reset()
        twist = jam.turned()
        assert twist.v == 0.0
        assert twist.w * side == pytest.approx(0.6 * BODY.max_turn_rate)


def leader_jam(period):
    return LeaderJam(BODY, Steering(BODY, GAINS, BEAMS), period)


@PERIODS
def test_a_leader_that_stands_near_something_steers_around_it_for_a_while(period):
    jam, scan = leader_jam(period), block(-20, 20, 0.9)
    twists = [jam.around(HERE, scan, 0.9, WAYPOINT) for _ in range(round(4.0 / period))]
    begun = next(k for k, twist in enumerate(twists) if twist is not None)
    ended = next(k for k in range(begun, len(twists)) if twists[k] is None)
    assert begun * period == pytest.approx(LEADER_STUCK_AFTER, abs=1.1 * period)
    assert (ended - begun) * period == pytest.approx(UNJAM_FOR, abs=2.1 * period)
    assert abs(twists[begun].w) > 1.0
    assert twists[begun].v > 0.0


def test_a_leader_with_nothing_near_or_that_drives_is_not_jammed():
    jam = leader_jam(0.05)
    assert all(jam.around(HERE, walls(2.0), JAM_REACH + 0.1, WAYPOINT) is None for _ in range(80))
    drives = [Pose(0.02 * tick, 0.0, 0.0) for tick in range(80)]
    assert all(jam.around(pose, walls(0.9), 0.9, WAYPOINT) is None for pose in drives)
