"""Making room: a leader that meets its followers asks for a lane, and they draw aside (lane.py)."""

import math

import numpy as np
import pytest

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.sections import TeamSection
from onehop.contracts.team import Mode
from robot_agent.core.motion.lane import (
    HALF_WIDTH,
    LONGEST,
    LONGEST_WAIT,
    PAUSE,
    LaneRequest,
    draw_aside,
)
from robot_agent.core.motion.steering import Steering
from robot_agent.core.team.roster import Roster
from robot_agent.core.team.team_messages import Command, CommandKind, MissionPhase, encode
from tests.agent.motion.scans import BEAMS, BODY, GAINS, HERE, OPEN, PERIOD, block, moved
from tests.agent.team.team_net import TeamNet

AHEAD, BESIDE = (6.0, 0.0), (0.0, 6.0)
NOBODY = np.empty(0, dtype=np.intp)


def one(bearing, distance):
    """A scan with one follower in it [deg, m], and the beams that hit it."""
    scan = block(bearing - 3, bearing + 3, distance)
    return scan, np.flatnonzero(np.isfinite(scan))


def watch(request, seconds, scan, followers, waypoint=AHEAD):
    """Let time pass; how often there was something to say."""
    ticks = range(round(seconds / PERIOD))
    return sum(request.watch(HERE, scan, followers, waypoint) for _ in ticks)


def test_a_follower_in_the_way_makes_the_leader_ask_for_a_lane_and_say_so_once_a_second():
    request = LaneRequest(BEAMS, PERIOD)
    assert watch(request, 0.3, *one(0, 1.5)) == 0
    assert request.lane == ()
    assert watch(request, 0.2, *one(0, 1.5)) == 1
    assert request.lane == ((0.0, 0.0), (4.0, 0.0))
    assert watch(request, 2.0, *one(0, 1.5)) == 2


@pytest.mark.parametrize(
    ("bearing", "distance", "waypoint"),
    [(0, 2.5, AHEAD), (60, 1.5, AHEAD), (0, 1.5, BESIDE)],
    ids=["far ahead", "beside the way", "not where the leader is going"],
)
def test_a_follower_that_is_not_in_the_way_is_left_alone(bearing, distance, waypoint):
    request = LaneRequest(BEAMS, PERIOD)
    assert watch(request, 3.0, *one(bearing, distance), waypoint) == 0
    assert request.lane == ()


def test_an_obstacle_that_is_no_follower_asks_nobody_for_room():
    request = LaneRequest(BEAMS, PERIOD)
    assert watch(request, 3.0, one(0, 1.0)[0], NOBODY) == 0


def test_the_lane_is_given_back_when_nobody_is_in_the_way_any_more():
    request = LaneRequest(BEAMS, PERIOD)
    watch(request, 0.5, *one(0, 1.5))
    watch(request, 0.9, OPEN, NOBODY)
    assert request.lane
    assert watch(request, 0.2, OPEN, NOBODY) >= 1
    assert request.lane == ()


def test_a_lane_that_does_not_help_is_given_up_for_a_while():
    request = LaneRequest(BEAMS, PERIOD)
    blocked = one(0, 1.0)
    watch(request, LONGEST + 0.6, *blocked)
    assert request.lane == ()
    watch(request, PAUSE - 0.5, *blocked)
    assert request.lane == ()
    watch(request, 1.0, *blocked)
    assert request.lane


def test_the_leader_waits_for_a_follower_right_before_it_but_not_for_ever():
    request = LaneRequest(BEAMS, PERIOD)
    watch(request, 0.5, *one(0, 1.5))
    assert not request.wait
    watch(request, 0.1, *one(0, 1.0))
    assert request.wait
    watch(request, LONGEST_WAIT, *one(0, 1.0))
    assert not request.wait


@pytest.mark.parametrize("y", [-0.7, 0.0, 0.4])
def test_a_follower_in_the_lane_draws_aside_and_then_stands_still(y):
    steering = Steering(BODY, GAINS, BEAMS)
    lane = ((0.0, 0.0), (4.0, 0.0))
    pose = Pose(2.0, y, math.pi)
    for _ in range(100):
        pose = moved(pose, draw_aside(steering, pose, OPEN, lane))
    assert HALF_WIDTH <= abs(pose.y) < HALF_WIDTH + 0.2
    assert pose.y * y >= 0.0, "to the side on which it was"
    assert draw_aside(steering, pose, OPEN, lane) == Twist(0.0, 0.0)


def test_between_lane_and_wall_a_follower_goes_along_the_wall():
    steering = Steering(BODY, GAINS, BEAMS)
    wall = OPEN.copy()
    wall[45:136] = 0.5
    twists = [
        draw_aside(steering, Pose(2.0, 0.5, math.pi / 2), wall, ((0.0, 0.0), (4.0, 0.0)))
        for _ in range(9)
    ]
    assert abs(twists[-1].w) > 1.0


def test_make_room_is_a_mode_of_its_own_and_the_next_command_ends_it():
    net = TeamNet(TeamSection())
    net.run(30.0)
    assert net.status(1).mode is Mode.FOLLOWING
    roster = Roster(0, (1, 2, 3, 4, 5, 6))
    where, lane = net.members[1].pose, ((0.0, 90.0), (4.0, 90.0))
    told = Command(
        CommandKind.MAKE_ROOM, roster, 1, MissionPhase.DRIVING, False, net.members[3].pose, (), (), lane
    )
    net.inject(3, 1, encode(told))
    net.step()
    assert net.status(1).mode is Mode.GIVING_WAY
    assert (net.members[1].pose.x, net.members[1].pose.y) == (where.x, where.y), "it is not in the lane"
    net.run(2.5)
    assert net.status(1).mode is Mode.FOLLOWING
    assert net.members[1].pose.x > where.x
