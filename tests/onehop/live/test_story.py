"""What is kept of a mission tick by tick: charts, departures, ways of messages."""

import math
from dataclasses import replace

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import (
    Action,
    DeliveryStatus,
    Departure,
    Presence,
    RadioRecord,
    Truth,
    Verdict,
)
from onehop.contracts.team import Mode, Shape, Status
from onehop.live.story import RECENT_TICKS, Story
from tests.onehop.analysis.conftest import scenario

STILL = Twist(0.0, 0.0)


def truth(tick: int, *robots: int, gone: tuple[Departure, ...] = ()) -> Truth:
    present = tuple(Presence(i, 0, Pose(float(i), 2.0, 0.0), STILL, False) for i in robots)
    return Truth(tick, tick * 50_000_000, present, (), (), (), (), gone)


def action(tick: int, status: Status | None, **values: float) -> Action:
    return Action(tick, 0, STILL, (), 0.0, 0.0, status, (), values)


def following(leader: int) -> Status:
    return Status(Mode.FOLLOWING, 0, leader, (1, 2, 3), Shape.WEDGE, 8e5, 5e5, 1.0, 0.5, 0.0, 0.0)


def record(tick: int, *verdicts: tuple[tuple[int, ...], int, DeliveryStatus]) -> RadioRecord:
    made = (
        Verdict(0, path[0], to, to, status, 800, path, (1,), 0, 0, 0, 0, 0, 30.0, 0.0)
        for path, to, status in verdicts
    )
    return RadioRecord(tick, tick * 50_000_000, tuple(made), {})


def test_where_there_is_no_team_what_programs_show_is_charted() -> None:
    own = replace(scenario(), team=replace(scenario().team, program="other:Robot"))
    story = Story(own)
    story.take(truth(0, 1), None, {1: action(0, None, range_m=2.5, age_s=math.nan)})
    assert story.names == ["range_m", "age_s"]
    assert story.samples == [[0, [1.0, 2.0, 2.5, None, None, None], None, None, None]]


def test_numbers_of_a_team_are_kept_twice_a_second() -> None:
    story = Story(scenario())
    for tick in range(21):
        story.take(truth(tick, 1), None, {1: action(tick, following(2))})
    assert [sample[0] for sample in story.samples] == [0, 10, 20]
    assert story.samples[0][1] == [1.0, 2.0, 800, None, 1.0, 0.5]


def test_a_way_of_messages_is_that_of_the_last_one_from_the_leader_that_came() -> None:
    story = Story(scenario())
    story.take(truth(0, 1, 2, 3), None, {1: action(0, following(2))})
    straight, relayed = ((2, 1), 1, DeliveryStatus.DELIVERED), ((2, 3, 1), 1, DeliveryStatus.DELIVERED)
    lost = ((2, 4), 1, DeliveryStatus.COLLISION)
    for tick, verdict in enumerate((straight, straight, lost, relayed), start=1):
        story.take(truth(tick, 1, 2, 3), record(tick, verdict), {1: action(tick, following(2))})
    assert [story.route_at(1, tick) for tick in (0, 1, 3, 4)] == [(), (2, 1), (2, 1), (2, 3, 1)]


def test_what_was_lost_is_at_hand_for_a_while() -> None:
    story = Story(scenario())
    for tick in range(RECENT_TICKS + 10):
        lost = record(tick, ((2, 3), 1, DeliveryStatus.COLLISION))
        story.take(truth(tick, 1, 2, 3), lost, {})
    assert story.recently_lost(20, 21) == [(3, 1, "collision")] * 2
    assert story.recently_lost(0, 21) is None
    assert story.recently_lost(20, RECENT_TICKS + 10) is None


def test_who_left_is_gone_until_it_is_back() -> None:
    story = Story(scenario())
    story.take(truth(0, 1, 2), None, {})
    story.take(truth(1, 1, gone=(Departure(2, "killed by a fault"),)), None, {})
    story.take(truth(2, 1, 2), None, {})
    assert [(one.robot, one.x, one.why) for one in story.gone_at(1, {1})] == [
        (2, 2.0, "killed by a fault")
    ]
    assert story.gone_at(0, {1, 2}) == story.gone_at(2, {1, 2}) == []
