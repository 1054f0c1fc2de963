"""The safety filter: two robots that keep the rule never touch, whatever they want."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onehop.contracts.briefings import robot_briefing
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Percept
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import GainsSection, GoalSection, MapSection, TeamSection
from onehop.contracts.team import Mode
from robot_agent.core.motion.safety import MARGIN, SafetyFilter
from robot_agent.core.planning import Guidance, PlannerStatus
from robot_agent.core.robot import Robot
from tests.agent.motion.scans import BEAMS, BODY, PERIOD, moved


def seen(pose, other):
    """Exact scan of one disc."""
    bearing = BEAMS.angles + pose.heading
    dx, dy = other.x - pose.x, other.y - pose.y
    along = dx * np.cos(bearing) + dy * np.sin(bearing)
    beside = dx * dx + dy * dy - along * along
    hit = (along > 0) & (beside < BODY.radius**2)
    depth = np.sqrt(np.maximum(0.0, BODY.radius**2 - beside))
    return np.where(hit, along - depth, np.inf).astype(np.float32)


twists = st.lists(st.tuples(st.floats(0.0, 3.0), st.floats(-3.0, 3.0)), min_size=1, max_size=6)


@settings(deadline=None, max_examples=50)
@given(st.floats(-3.1, 3.1), st.floats(-3.1, 3.1), st.floats(0.5, 1.5), twists, twists)
def test_two_robots_that_drive_as_they_like_never_touch(heading_a, heading_b, apart, wants_a, wants_b):
    guard = SafetyFilter(BODY, BEAMS, PERIOD)
    a, b = Pose(0.0, 0.0, heading_a), Pose(apart, 0.0, heading_b)
    for tick in range(60):
        twists_now = []
        for me, other, wants in ((a, b, wants_a), (b, a, wants_b)):
            scan = seen(me, other)
            wish = Twist(*wants[tick // 10 % len(wants)])
            twists_now.append(guard.filtered(wish, scan, float(scan.min())))
        a, b = moved(a, twists_now[0]), moved(b, twists_now[1])
        assert math.hypot(a.x - b.x, a.y - b.y) > 2 * BODY.radius


@settings(deadline=None, max_examples=50)
@given(st.floats(0.3, 2.0), st.floats(-1.4, 1.4))
def test_a_wall_is_approached_but_never_reached(distance, heading):
    guard = SafetyFilter(BODY, BEAMS, PERIOD)
    pose = Pose(0.0, 0.0, heading)
    for _ in range(80):
        across = np.cos(BEAMS.angles + pose.heading)
        left = distance - pose.x
        scan = np.where(across > 1e-3, left / np.maximum(across, 1e-3), np.inf).astype(np.float32)
        pose = moved(pose, guard.filtered(Twist(3.0, 0.0), scan, float(scan.min())))
        assert distance - pose.x > BODY.radius


def test_nothing_near_changes_nothing():
    guard = SafetyFilter(BODY, BEAMS, PERIOD)
    scan = np.full(181, 2.0, np.float32)
    assert guard.filtered(Twist(3.0, 1.0), scan, 2.0) == Twist(3.0, 1.0)


def test_a_robot_at_the_margin_may_still_turn_and_drive_away():
    guard = SafetyFilter(BODY, BEAMS, PERIOD)
    ahead = np.full(181, np.inf, np.float32)
    ahead[85:96] = BODY.radius + MARGIN
    stopped = guard.filtered(Twist(1.0, 2.0), ahead, float(ahead.min()))
    assert stopped.v < 0.1
    assert stopped.w == 2.0
    beside = np.full(181, np.inf, np.float32)
    beside[0] = BODY.radius + MARGIN
    assert guard.filtered(Twist(1.0, 0.0), beside, float(beside.min())).v == 1.0


def test_a_robot_backs_up_only_where_it_may_do_so_blindly():
    guard = SafetyFilter(BODY, BEAMS, PERIOD)
    nothing = np.full(181, np.inf, np.float32)
    assert guard.filtered(Twist(-1.0, 0.5), nothing, math.inf) == Twist(0.0, 0.5)
    assert guard.filtered(Twist(-1.0, 0.5), nothing, math.inf, blind=True) == Twist(-1.0, 0.5)


class BackingUp:
    """Way-finding that wants to drive backwards."""

    def step(self, pose, scan):
        del scan
        way = Twist(-1.0, 0.0)
        return Guidance(way, PlannerStatus.DRIVING, 9.0, math.inf, (pose.x - 9.0, pose.y), ())


@pytest.mark.parametrize("reverse", [False, True])
def test_a_leader_never_backs_up_even_where_followers_may(reverse):
    scenario = Scenario(
        name="back",
        goal=GoalSection(9.0, 0.0),
        map=MapSection(width=20.0, height=20.0),
        team=TeamSection(size=1),
        gains=GainsSection(reverse=reverse),
    )
    robot = Robot(robot_briefing(scenario, 1, 0), lambda briefing, pose, rng: BackingUp())  # noqa: ARG005
    wanted = []
    for tick in range(20):
        here, still = Pose(5.0, 0.0, 0.0), Twist(0.0, 0.0)
        scan = np.full(181, np.inf, np.float32)
        action = robot.step(Percept(tick, tick * 50_000_000, here, still, scan, ()))
        wanted.append(action.twist.v)
    assert action.status.mode is Mode.ALONE
    assert set(wanted) == {0.0}
