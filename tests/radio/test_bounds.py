"""A perfect link and none: what every real radio lies between."""

import pytest

from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.messages import BROADCAST, Corruption, Cut, DeliveryStatus, Jam
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.bounds import PERFECT_SNR_DB, make_radio
from radio_proxy.core.radio import Radio
from tests.radio.missions import PERIOD, Mission, line, message

FAR = 1000.0
"""Far beyond what the thesis's radio reaches [m]."""


def mission(link: str, robots: int = 3, period: int = PERIOD) -> Mission:
    """Robots far apart; the radio of the mission is the bound."""
    section = RadioSection(link=link)
    bound = Mission(line(robots, FAR), section)
    bound.radio = make_radio(RadioBriefing(1, period, tuple(range(1, robots + 1)), section, ()))
    return bound


def test_the_modelled_radio_is_the_one_that_a_scenario_gets_unless_it_says_otherwise() -> None:
    briefing = RadioBriefing(1, PERIOD, (1, 2), RadioSection(), ())
    assert isinstance(make_radio(briefing), Radio)


def test_everything_arrives_at_any_distance_in_one_hop_and_without_waiting() -> None:
    perfect = mission("perfect")
    perfect.step()
    verdicts = perfect.step({1: (message(2), message(3)), 2: (message(3),)})
    assert {one.status for one in verdicts} == {DeliveryStatus.DELIVERED}
    assert {len(one.path) for one in verdicts} == {2}
    assert [one.queueing_ns for one in verdicts] == [0, 0, 0]
    (reception,) = perfect.inboxes[2].receptions
    assert (reception.hops, reception.attempts, reception.snr_db) == (1, 1, PERFECT_SNR_DB)
    # RTS 352, CTS 304, two SIFS 10, data 192 + 8 * 834 us (802.11-1999, 9.2.5 and 15.2)
    assert reception.arrival_ns - reception.service_start_ns == 7_540_000


def test_a_broadcast_reaches_everybody() -> None:
    perfect = mission("perfect")
    perfect.step()
    verdicts = perfect.step({2: (message(BROADCAST, 100),)})
    assert [(one.receiver, one.status) for one in verdicts] == [(1, "delivered"), (3, "delivered")]
    assert {one.arrival_ns - one.offered_ns for one in verdicts} == {192_000 + 8_000 * 134}


def test_without_a_link_nothing_arrives_and_every_message_has_its_verdict() -> None:
    none = mission("none")
    none.step()
    verdicts = none.step({1: (message(2), message(BROADCAST)), 3: (message(3),)})
    assert [(one.receiver, one.status.value) for one in verdicts] == [
        (2, "below threshold"),
        (2, "below threshold"),
        (3, "below threshold"),
        (3, "no route"),
    ]
    assert all(inbox.receptions == () for inbox in none.inboxes.values())


def test_a_cut_parts_a_perfect_link_and_a_jam_does_not() -> None:
    perfect = mission("perfect")
    perfect.jams = (Jam(0.0, 0.0, 1e6, 100.0),)
    perfect.step()
    perfect.cuts = (Cut((1,), (2,), one_way=True),)
    verdicts = perfect.step({1: (message(2), message(3)), 2: (message(1),)})
    statuses = {(one.source, one.receiver): one.status.value for one in verdicts}
    assert statuses == {(1, 2): "below threshold", (1, 3): "delivered", (2, 1): "delivered"}


def test_who_is_not_there_gets_nothing() -> None:
    perfect = mission("perfect")
    perfect.step()
    del perfect.places[3]
    (verdict,) = perfect.step({1: (message(3),)})
    assert verdict.status is DeliveryStatus.RECEIVER_GONE


@pytest.mark.parametrize(("gone", "why"), [(2, "receiver gone"), (1, "sender gone")])
def test_what_is_under_way_when_a_robot_leaves_is_lost(gone: int, why: str) -> None:
    """Ticks of 1 ms: a Next is under way for eight of them."""
    period = 1_000_000
    perfect = mission("perfect", 3, period)
    truths = [perfect.truth({})]
    for tick, outbox in ((1, {1: (message(2), message(3))}), (2, {}), (3, {})):
        perfect.tick = tick
        if tick == 3:
            del perfect.places[gone]
        truths.append(perfect.truth(outbox))
    carried = [
        perfect.radio.carry(type(one)(**{**_fields(one), "time_ns": one.tick * period}))
        for one in truths
    ]
    lost = {(one.source, one.receiver): one.status.value for one in carried[3].record.verdicts}
    assert lost[1, 2] == why
    assert not any(one.record.verdicts for one in carried[:3])


def test_payloads_are_still_altered_by_a_corruption() -> None:
    perfect = mission("perfect")
    perfect.step()
    perfect.corruptions = (Corruption((2,), 1.0),)
    (verdict,) = perfect.step({1: (message(2),)})
    assert verdict.status is DeliveryStatus.CORRUPTED


def _fields(value: object) -> dict[str, object]:
    return {name: getattr(value, name) for name in value.__struct_fields__}  # type: ignore[attr-defined]
