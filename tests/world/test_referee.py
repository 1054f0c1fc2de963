"""How a mission ends, who arrived, who was lost and why, and who led when."""

import pytest

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import LeadershipTerm, Lost, Note, Outcome, Presence
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import ClockSection, GoalSection, MapSection, TeamSection
from onehop.contracts.team import Mode, Shape, Status
from world_server.core.referee import Referee, TickSummary

TEAM = (1, 2, 3)
PLAN = Scenario(
    name="r", goal=GoalSection(50.0, 50.0), map=MapSection(width=100.0, height=100.0),
    team=TeamSection(size=3), clock=ClockSection(limit_s=100.0),
)  # fmt: skip
AT_GOAL = {1: (47.2, 47.2), 2: (50.3, 50.3), 3: (47.2, 52.8)}
PERIOD_NS = 50_000_000


def status(
    leader: int = 2, epoch: int = 1, members: tuple[int, ...] = TEAM, mode: Mode = Mode.STOPPED,
    shape: Shape = Shape.WEDGE,
) -> Status:  # fmt: skip
    return Status(mode, epoch, leader, members, shape, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def at(
    tick: int, places: dict[int, tuple[float, float]], statuses: dict[int, Status], v: float = 0.0,
    waiting: frozenset[int] = frozenset(), collisions: int = 0,
) -> TickSummary:  # fmt: skip
    present = tuple(
        Presence(robot, 0, Pose(*places[robot], 0.0), Twist(v, 0.0), False) for robot in sorted(places)
    )
    return TickSummary(tick, tick * PERIOD_NS, present, statuses, waiting, collisions)


def all_stopped(**kwargs: object) -> dict[int, Status]:
    return {robot: status(**kwargs) for robot in TEAM}  # type: ignore[arg-type]


def judge(referee: Referee, *summaries: TickSummary, hope: bool = False) -> Outcome | None:
    verdict = None
    for one in summaries:
        assert verdict is None, "the referee went on after its verdict"
        verdict = referee.judge(one, hope)
    return verdict


def test_a_stopped_team_at_the_goal_has_arrived() -> None:
    outcome = judge(
        Referee(PLAN),
        at(1, AT_GOAL, all_stopped(), 1.0),
        at(2, AT_GOAL, all_stopped()),
    )
    assert outcome is not None
    assert outcome.outcome == "arrived"
    assert outcome.arrived == TEAM
    assert outcome.lost == ()
    assert (outcome.ticks, outcome.sim_s) == (2, 0.1)
    assert "robot 2" in outcome.reason


def test_who_still_drives_keeps_the_mission_going() -> None:
    assert judge(Referee(PLAN), *(at(tick, AT_GOAL, all_stopped(), 0.5) for tick in range(200))) is None


def test_two_seconds_of_rest_are_enough_without_a_word_of_stopping() -> None:
    following = all_stopped(mode=Mode.FOLLOWING)
    referee = Referee(PLAN)
    referee.judge(at(0, AT_GOAL, following, 1.0), False)
    assert judge(referee, *(at(tick, AT_GOAL, following) for tick in range(1, 40))) is None
    assert judge(referee, at(40, AT_GOAL, following)) is not None


def test_a_held_robot_that_will_be_released_is_waited_for() -> None:
    held = frozenset({3})
    summaries = (at(tick, AT_GOAL, all_stopped(), waiting=held) for tick in range(200))
    assert judge(Referee(PLAN), *summaries) is None


def test_the_goal_is_reached_by_its_leader_only() -> None:
    places = {1: (50.0, 50.0), 2: (47.0, 47.0), 3: (47.0, 53.0)}
    assert judge(Referee(PLAN), *(at(tick, places, all_stopped()) for tick in range(39))) is None


def test_a_team_that_stopped_elsewhere_has_failed_for_the_reason_it_gives() -> None:
    referee = Referee(PLAN)
    referee.on_notes(2, (Note("replanned", {}), Note("no_way_to_the_goal", {})))
    referee.on_notes(2, (Note("mode", {"to": "stopped"}), Note("garbled", {"robots": (1,)})))
    referee.on_notes(3, (Note("set_up", {}),))
    far = {robot: (10.0 + robot, 10.0) for robot in TEAM}
    outcome = judge(referee, *(at(tick, far, all_stopped()) for tick in range(41)))
    assert outcome is not None
    assert outcome.outcome == "failed"
    assert outcome.reason == "everyone stopped before the goal (robot 2: no way to the goal)"
    assert outcome.arrived == ()
    assert [lost.robot for lost in outcome.lost] == [1, 2, 3]


def test_a_team_in_setup_is_not_a_team_that_stopped() -> None:
    far = {robot: (10.0 + robot, 10.0) for robot in TEAM}
    setup = all_stopped(mode=Mode.SETUP)
    assert judge(Referee(PLAN), *(at(tick, far, setup) for tick in range(400))) is None


def test_nobody_left_is_a_failure_unless_somebody_returns() -> None:
    referee = Referee(PLAN)
    for robot in TEAM:
        referee.on_departure(robot, "its process died", robot * 1_000_000_000)
    assert judge(referee, at(100, {}, {}), hope=True) is None
    outcome = judge(referee, at(101, {}, {}))
    assert outcome is not None
    assert (outcome.outcome, outcome.reason) == ("failed", "no robot is left")
    assert outcome.lost == tuple(Lost(robot, float(robot), "its process died") for robot in TEAM)


@pytest.mark.parametrize(("places", "expected"), [(AT_GOAL, "arrived"), ({1: (1.0, 1.0)}, "failed")])
def test_the_time_limit_ends_the_mission(places: dict[int, tuple[float, float]], expected: str) -> None:
    words = all_stopped(mode=Mode.FOLLOWING)
    outcome = judge(Referee(PLAN), at(1999, places, words, 1.0), at(2000, places, words, 1.0))
    assert outcome is not None
    assert outcome.outcome == expected
    assert "time" in outcome.reason


def test_a_robot_dropped_from_the_roster_is_lost_since_then() -> None:
    referee = Referee(PLAN)
    referee.judge(at(0, AT_GOAL, all_stopped(), 1.0), False)
    pair = {2: status(members=(2, 3), epoch=2, shape=Shape.COLUMN), 3: status(members=(2, 3), epoch=2)}
    alone = {1: status(leader=1, members=(1,), epoch=5, shape=Shape.SOLO)}
    referee.judge(at(10, AT_GOAL, pair | alone, 1.0), False)
    outcome = judge(referee, at(20, AT_GOAL, pair | alone))
    assert outcome is not None
    assert outcome.arrived == (2, 3)
    assert outcome.lost == (Lost(1, 0.5, "dropped from the roster of robot 2"),)


REASONS = {
    "unanswered": "given up by robot 2: its commands stayed unanswered",
    "not in position at setup": "given up by robot 2: not in position when setup ended",
    None: "given up by robot 2",
}


def given_up(robot: int, reason: str | None) -> tuple[Note, ...]:
    return (Note("lost_follower", {"robots": (robot,)} | ({"reason": reason} if reason else {})),)


@pytest.mark.parametrize(("reason", "why"), REASONS.items())
def test_a_robot_that_its_leader_gave_up_is_lost_for_the_reason_in_the_note(
    reason: str | None, why: str
) -> None:
    referee = Referee(PLAN)
    referee.judge(at(0, AT_GOAL, all_stopped(), 1.0), False)
    referee.on_notes(2, given_up(1, reason))
    pair = all_stopped(members=(2, 3), epoch=2)
    outcome = judge(referee, at(10, AT_GOAL, pair, 1.0), at(20, AT_GOAL, pair))
    assert outcome is not None
    assert outcome.lost == (Lost(1, 0.5, why),)


def test_the_reason_is_kept_when_the_leader_that_gave_up_hands_over() -> None:
    places = AT_GOAL | {2: AT_GOAL[3], 3: AT_GOAL[2]}
    referee = Referee(PLAN)
    referee.judge(at(0, places, all_stopped(), 1.0), False)
    referee.on_notes(2, given_up(1, "unanswered"))
    pair = all_stopped(leader=3, members=(2, 3), epoch=2)
    referee.judge(at(1, places, pair, 1.0), False)
    outcome = judge(referee, at(20, places, pair))
    assert outcome is not None
    assert outcome.lost == (Lost(1, 0.05, "given up by robot 2: its commands stayed unanswered"),)


def test_an_old_reason_is_not_that_of_a_later_loss() -> None:
    """Robot 1 is given up, comes back, and is then on no roster any more because another one elects."""
    referee = Referee(PLAN)
    referee.judge(at(0, AT_GOAL, all_stopped(), 1.0), False)
    referee.on_notes(2, given_up(1, "unanswered"))
    for tick, members in enumerate([(2, 3), TEAM, (2, 3)], start=1):
        words = all_stopped(members=members, epoch=tick + 1)
        referee.judge(at(tick, AT_GOAL, words, 1.0), False)
    outcome = judge(referee, at(9, AT_GOAL, all_stopped(members=(2, 3), epoch=4)))
    assert outcome is not None
    assert outcome.lost == (Lost(1, 0.15, "dropped from the roster of robot 2"),)


def test_a_robot_that_was_taken_back_is_not_lost() -> None:
    referee = Referee(PLAN)
    for tick, members in enumerate([TEAM, (2, 3), TEAM]):
        words = {robot: status(members=members, epoch=tick + 1) for robot in TEAM}
        referee.judge(at(tick, AT_GOAL, words, 1.0), False)
    outcome = judge(referee, at(3, AT_GOAL, all_stopped(epoch=3)))
    assert outcome is not None
    assert outcome.lost == ()


def test_a_robot_that_was_taken_back_and_then_fell_behind_was_not_dropped() -> None:
    referee = Referee(PLAN)
    places = AT_GOAL | {1: (20.0, 20.0)}
    for tick, members in enumerate([TEAM, (2, 3), TEAM]):
        words = {robot: status(members=members, epoch=tick + 1) for robot in TEAM}
        referee.judge(at(tick, places, words, 1.0), False)
    outcome = judge(referee, at(3, places, all_stopped(epoch=3)))
    assert outcome is not None
    assert outcome.lost == (Lost(1, 0.15, "did not arrive"),)


def test_who_follows_without_being_on_the_roster_has_not_arrived() -> None:
    referee = Referee(PLAN)
    referee.judge(at(0, AT_GOAL, all_stopped(), 1.0), False)
    words = all_stopped() | {2: status(members=(2, 3), epoch=2)}
    outcome = judge(referee, at(4, AT_GOAL, words))
    assert outcome is not None
    assert outcome.arrived == (2, 3)
    assert outcome.lost == (Lost(1, 0.2, "dropped from the roster of robot 2"),)


def test_a_straggler_of_the_roster_did_not_arrive() -> None:
    places = AT_GOAL | {3: (20.0, 20.0)}
    outcome = judge(
        Referee(PLAN),
        at(0, places, all_stopped(), 1.0),
        at(4, places, all_stopped()),
    )
    assert outcome is not None
    assert outcome.arrived == (1, 2)
    assert outcome.lost == (Lost(3, 0.2, "did not arrive"),)


def test_a_returned_robot_can_arrive() -> None:
    referee = Referee(PLAN)
    referee.on_departure(1, "died", 0)
    referee.on_return(1)
    referee.judge(at(0, AT_GOAL, all_stopped(), 1.0), False)
    outcome = judge(referee, at(1, AT_GOAL, all_stopped()))
    assert outcome is not None
    assert outcome.arrived == TEAM


def test_the_end_of_a_column_has_arrived_too() -> None:
    """Slots of a column lie j * spacing behind (thesis 3.3.1): 4 and 8 m."""
    places = {2: (50.0, 50.0), 3: (46.0, 50.0), 1: (42.0, 50.0)}
    words = all_stopped(shape=Shape.COLUMN)
    outcome = judge(Referee(PLAN), at(0, places, words, 1.0), at(1, places, words))
    assert outcome is not None
    assert outcome.arrived == TEAM


def test_leaders_are_listed_from_the_moment_they_act_as_such() -> None:
    referee = Referee(PLAN)
    steps = [
        {2: status(), 1: status(), 3: status()},
        {2: status(), 1: status(), 3: status()},
        {2: status(epoch=2, members=(2, 3), shape=Shape.COLUMN), 3: status()},
        {2: status(leader=3, epoch=3), 3: status(leader=3, epoch=3)},
        {2: status(epoch=2, members=(2, 3), shape=Shape.COLUMN), 3: status(leader=3, epoch=3)},
    ]
    for tick, words in enumerate(steps):
        referee.judge(at(tick, AT_GOAL, words, 1.0), False)
    leaders = referee.close("aborted", "", at(9, {}, {})).leaders
    assert leaders == (
        LeadershipTerm(0.0, 2, 1, TEAM, "wedge"),
        LeadershipTerm(0.1, 2, 2, (2, 3), "column"),
        LeadershipTerm(0.15, 3, 3, TEAM, "wedge"),
        LeadershipTerm(0.2, 2, 2, (2, 3), "column"),
    )


def test_an_aborted_mission_counts_its_collisions() -> None:
    outcome = Referee(PLAN).close("aborted", "interrupted", at(7, AT_GOAL, {}, collisions=3))
    assert (outcome.outcome, outcome.reason, outcome.collisions) == ("aborted", "interrupted", 3)
    assert outcome.arrived == ()


def test_whatever_a_robot_says_of_giving_others_up_its_last_word_counts() -> None:
    referee = Referee(PLAN)
    referee.judge(at(0, AT_GOAL, all_stopped(), 1.0), False)
    for number in range(1000):
        referee.on_notes(2, given_up(1, f"reason {number}"))
        referee.on_notes(2, given_up(99, "nobody of this team"))
    pair = {robot: status(members=(2, 3), epoch=2) for robot in (2, 3)}
    alone = {1: status(leader=1, members=(1,), epoch=5, shape=Shape.SOLO)}
    referee.judge(at(10, AT_GOAL, pair | alone, 1.0), False)
    outcome = judge(referee, at(20, AT_GOAL, pair | alone))
    assert outcome is not None
    assert outcome.lost == (Lost(1, 0.5, "given up by robot 2: reason 999"),)
