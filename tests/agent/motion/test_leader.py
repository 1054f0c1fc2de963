"""What a leader decides: its own way, and what it wants of its team."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from onehop.contracts.briefings import robot_briefing
from onehop.contracts.geometry import STANDSTILL, Pose, Twist
from onehop.contracts.messages import Note
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import GoalSection, MapSection, TeamSection
from robot_agent.core.motion.leader import LeaderMotion, TeamView
from robot_agent.core.planning import Guidance, PlannerStatus
from tests.agent.motion.scans import BEAMS, GAINS, HERE, OPEN, PERIOD, block, moved

FOUR = TeamView(
    gathering=False,
    members=(1, 2, 3, 4),
    column=False,
    reports={},
    reports_age=0.0,
    announced=HERE,
    may_ask_for_room=True,
)


class Scripted:
    """Way-finding that says what a test wants, and keeps what it was shown."""

    def __init__(self):
        self.guidance = Guidance(Twist(1.0, 0.2), PlannerStatus.DRIVING, 9.0, math.inf, (9.0, 0.0), ())
        self.shown = []

    def step(self, pose, scan):
        del pose
        self.shown.append(scan)
        return self.guidance

    def say(self, **changes):
        """Another guidance from now on."""
        fields = {name: getattr(self.guidance, name) for name in Guidance.__dataclass_fields__}
        self.guidance = Guidance(**fields | changes)


def leader(**team):
    """A leader whose goal lies 20 m to its left, and its way-finding."""
    scenario = Scenario(
        name="leads",
        goal=GoalSection(0.0, 20.0),
        map=MapSection(width=40.0, height=40.0),
        team=TeamSection(size=4, **team),
    )
    way = Scripted()
    briefing = robot_briefing(scenario, 2, 0)
    rng = np.random.default_rng(0)
    return LeaderMotion(briefing, GAINS, BEAMS, lambda *_: way, rng), way


def test_while_the_team_gathers_the_leader_turns_to_the_goal_and_asks_for_no_way():
    motion, way = leader()
    pose = HERE
    for _ in range(40):
        decision = motion.decide(pose, OPEN, replace(FOUR, gathering=True))
        assert decision.planned.v == 0.0
        pose = moved(pose, decision.planned)
    assert decision.planned == STANDSTILL
    assert pose.heading == pytest.approx(0.5 * math.pi, abs=0.05)
    assert decision.waypoint is None
    assert decision.remaining == 20.0
    assert not way.shown


def test_way_finding_does_not_see_a_follower_where_it_reported_itself():
    motion, way = leader()
    scan = block(-3, 3, 2.0)
    motion.decide(HERE, scan, FOUR)
    motion.decide(HERE, scan, replace(FOUR, reports={4: (2.2, 0.0)}))
    assert way.shown[0][90] == 2.0
    assert way.shown[1][90] == math.inf


def test_a_narrow_passage_makes_a_column_and_the_decision_says_how_wide_it_is():
    motion, way = leader()
    way.say(passage=3.0)
    decisions = [motion.decide(HERE, OPEN, FOUR) for _ in range(round(0.6 / PERIOD))]
    assert not decisions[0].column
    assert decisions[-1].column
    assert decisions[-1].passage == 3.0
    alone = replace(FOUR, members=(2, 4), column=True)
    assert motion.decide(HERE, OPEN, alone).passage is None, "not for the passage's sake"


@pytest.mark.parametrize("status", [PlannerStatus.ARRIVED, PlannerStatus.NO_WAY])
def test_at_the_end_of_its_way_a_leader_stands_for_good_and_says_so_once(status):
    motion, way = leader()
    assert motion.decide(HERE, OPEN, FOUR).status is PlannerStatus.DRIVING
    way.say(status=status, remaining=0.3, notes=(Note("no_way", {}),))
    ended = motion.decide(HERE, OPEN, FOUR)
    assert (ended.planned, ended.status, ended.remaining) == (STANDSTILL, status, 0.3)
    assert ended.notes == (Note("no_way", {}),)
    shown = len(way.shown)
    later = motion.decide(HERE, OPEN, FOUR)
    assert (later.planned, later.status, later.remaining, later.notes) == (STANDSTILL, status, 0.3, ())
    assert len(way.shown) == shown, "the way has ended"


def test_another_leadership_starts_with_another_way_and_another_trail():
    motion, way = leader()
    way.say(status=PlannerStatus.ARRIVED)
    motion.decide(HERE, OPEN, FOUR)
    motion.begin()
    assert motion.trail.points == []
    way.say(status=PlannerStatus.DRIVING)
    assert motion.decide(Pose(5.0, 5.0, 0.0), OPEN, FOUR).status is PlannerStatus.DRIVING
    assert motion.trail.points == [(5.0, 5.0)]


def test_a_leader_asks_for_room_only_where_the_profile_has_such_an_order():
    for allowed, lane in ((True, ((0.0, 0.0), (4.0, 0.0))), (False, ())):
        motion, _ = leader()
        team = replace(FOUR, reports={4: (1.7, 0.0)}, may_ask_for_room=allowed)
        decisions = [motion.decide(HERE, block(-6, 6, 1.5), team) for _ in range(12)]
        assert decisions[-1].lane == lane
        assert any(decision.lane_is_news for decision in decisions) is allowed


def test_stragglers_slow_the_same_arc_down_if_the_scenario_says_so():
    twist = Twist(1.0, 0.5)
    behind = replace(FOUR, reports={1: (-20.0, 0.0)})
    here = replace(FOUR, reports={1: (-2.8, -2.8)})
    motion, _ = leader(straggler_speed=0.4)
    assert motion.slowed_for_stragglers(twist, behind, False) == Twist(0.4, 0.2)
    assert motion.slowed_for_stragglers(twist, here, False) is None
    assert motion.slowed_for_stragglers(twist, FOUR, False) is None, "nobody has reported yet"
    never, _ = leader()
    assert never.slowed_for_stragglers(twist, behind, False) is None


def test_a_column_in_its_slots_holds_nobody_up():
    """Its slots are a narrow spacing apart, not the spacing of the open shapes."""
    motion, _ = leader(straggler_speed=0.4)
    column = {robot: (-1.5 * place, 0.0) for place, robot in enumerate((1, 3, 4), start=1)}
    team = replace(FOUR, reports=column)
    assert motion.slowed_for_stragglers(Twist(1.0, 0.5), team, True) is None
    left = replace(team, reports=column | {4: (-9.0, 0.0)})
    assert motion.slowed_for_stragglers(Twist(1.0, 0.5), left, True) == Twist(0.4, 0.2)
