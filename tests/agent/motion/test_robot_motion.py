"""The list of what may change a twist on its way to the wheels, and its order."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from onehop.contracts.briefings import robot_briefing
from onehop.contracts.geometry import STANDSTILL, Pose, Twist
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import GoalSection, MapSection, TeamSection
from robot_agent.core.motion.detour import SlotTask
from robot_agent.core.motion.robot_motion import RobotMotion
from tests.agent.motion.scans import BODY, HERE, OPEN, PERIOD, block
from tests.agent.motion.test_leader import FOUR, Scripted

MET = {4: (1.1, 0.0)}
"""A follower right before the leader."""


def motion(straggler_speed=1.0):
    """A robot, and the way-finding of its leaderships."""
    scenario = Scenario(
        name="moves",
        goal=GoalSection(20.0, 0.0),
        map=MapSection(width=40.0, height=40.0),
        team=TeamSection(size=4, straggler_speed=straggler_speed),
    )
    way = Scripted()

    def make_pathfinder(briefing, pose, rng):
        del briefing, pose, rng
        return way

    return RobotMotion(robot_briefing(scenario, 2, 0), make_pathfinder, np.random.default_rng(0)), way


def lead(robot, team, seconds, scan, pose=HERE):
    """The twists of a leader that is held where it stands."""
    nearest = float(scan.min())
    return [robot.lead(pose, scan, nearest, team)[0] for _ in range(round(seconds / PERIOD))]


def test_in_the_open_the_way_findings_twist_comes_to_the_wheels():
    robot, way = motion()
    assert lead(robot, FOUR, 1.0, OPEN) == [way.guidance.twist] * 20


def test_a_leader_waits_for_room_before_it_takes_itself_for_jammed():
    robot, way = motion()
    twists = lead(robot, replace(FOUR, reports=MET), 6.0, block(-10, 10, 0.9))
    waits = [k for k, twist in enumerate(twists) if twist == Twist(0.0, way.guidance.twist.w)]
    around = [k for k, twist in enumerate(twists) if abs(twist.w) > 1.0]
    assert len(waits) == pytest.approx(3.0 / PERIOD, abs=2)
    assert around
    assert min(around) > max(waits) + 20, "waiting did not count"


def test_a_leader_in_a_jam_does_not_slow_down_for_those_who_jam_it():
    robot, _ = motion(straggler_speed=0.1)
    team = replace(FOUR, reports={1: (-20.0, 0.0)}, may_ask_for_room=False)
    twists = lead(robot, team, 2.5, block(30, 60, 0.9))
    assert twists[0].v == pytest.approx(0.1)
    assert max(twist.v for twist in twists) > 0.3


def test_the_safety_filter_has_the_last_word_on_whatever_a_robot_wants():
    robot, _ = motion()
    before = block(-30, 30, BODY.radius + 0.05)
    assert lead(robot, FOUR, 0.5, before)[-1].v < 0.01
    task, aside = SlotTask(Pose(5.0, 0.0, 0.0), (), 4.0, True, 3.0), block(20, 90, 0.6)
    assert robot.follow(HERE, aside, 0.6, task).v > 0.5
    held = robot.follow(HERE, before, float(before.min()), task)
    assert held.v < 0.01, "a course that was decided a tick ago"


def test_a_follower_stands_without_a_task_and_draws_out_of_a_lane_whatever_its_slot():
    robot, _ = motion()
    assert robot.follow(HERE, OPEN, math.inf, None) == STANDSTILL
    task = SlotTask(Pose(9.0, 0.0, 0.0), (), 4.0, True, 1.0)
    assert robot.follow(HERE, OPEN, math.inf, task).v > 1.0
    lane = ((-1.0, 2.0), (-1.0, -2.0))
    aside = robot.follow(HERE, OPEN, math.inf, replace(task, lane=lane))
    assert aside.v == pytest.approx(1.0)
    beside = replace(task, lane=((-2.0, 2.0), (-2.0, -2.0)))
    assert robot.follow(HERE, OPEN, math.inf, beside) == STANDSTILL
