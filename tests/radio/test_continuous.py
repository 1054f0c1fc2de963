"""The radio in real time: what it does depends on what came when, not on how the clock was followed."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.messages import (
    BROADCAST,
    Corruption,
    Heard,
    RadioRecord,
    Transmission,
    TransmitRequest,
)
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.bounds import make_radio
from radio_proxy.core.continuous import ContinuousRadio
from tests.radio.missions import PERIOD, Mission, line, message

ROBOTS = 4
SECTIONS = {
    "mrdv": RadioSection(routing="mrdv", neighbours=True),
    "mrsr": RadioSection(routing="mrsr", preset="physical"),
    "rayleigh": RadioSection(fast_fading="rayleigh"),
    "perfect": RadioSection(link="perfect"),
}

instants = st.lists(st.integers(0, PERIOD), max_size=4)
sendings = st.lists(
    st.tuples(st.integers(1, ROBOTS), st.integers(0, ROBOTS), st.integers(0, PERIOD)), max_size=4
)
"""In a tick: who hands over a message, to whom, and when after its begin [ns]."""
ticks = st.lists(st.tuples(sendings, instants, st.integers(0, PERIOD // 2)), min_size=2, max_size=6)
"""Of each tick: messages, instants at which somebody looks, and how late its truth comes [ns]."""


def radio_of(section: RadioSection) -> ContinuousRadio:
    return ContinuousRadio(make_radio(RadioBriefing(7, PERIOD, (1, 2, 3, 4), section, ())))


def play(
    section: RadioSection, script: list[tuple[list[tuple[int, int, int]], list[int], int]], looks: bool
) -> tuple[list[tuple[int, Heard]], list[RadioRecord]]:
    """What robots heard, and the records."""
    truths = Mission(line(ROBOTS, 20.0), RadioSection())
    truths.corruptions = (Corruption((1, 2, 3, 4), 0.3),)
    radio, heard, records = radio_of(section), [], []
    for tick, (sent, looked, late) in enumerate(script):
        truths.tick, truths.stopped = tick, (2,) if tick == 1 else ()
        truth = truths.truth({})
        due, record = radio.close(tick * PERIOD + late)
        heard += due
        records += [] if record is None else [record]
        heard += radio.place(truth, radio.now_ns)
        events = [(at, (source, to)) for source, to, at in sent if source not in truths.stopped]
        events += [(at, None) for at in looked] if looks else []
        for at, what in sorted(events, key=lambda one: one[0]):
            if what is None:
                heard += radio.follow(tick * PERIOD + at)
            else:
                outbox = (message(what[1], 100),)
                heard += radio.hand_over(TransmitRequest(what[0], 1.0, 5.0, outbox), tick * PERIOD + at)
    due, record = radio.close((len(script) + 20) * PERIOD)
    assert record is not None
    return sorted([*heard, *due], key=lambda one: (one[0], one[1].number)), [*records, record]


@pytest.mark.parametrize("name", SECTIONS)
@settings(max_examples=15, deadline=None)
@given(script=ticks)
def test_it_makes_no_difference_by_which_steps_the_clock_was_followed(
    name: str, script: list[tuple[list[tuple[int, int, int]], list[int], int]]
) -> None:
    section = SECTIONS[name]
    heard, records = play(section, script, looks=True)
    assert (heard, records) == play(section, script, looks=False)
    for robot in range(1, ROBOTS + 1):
        numbers = [one.number for i, one in heard if i == robot]
        assert numbers == list(range(1, len(numbers) + 1))


def test_a_message_is_in_the_air_at_once_and_comes_when_its_last_bit_has_arrived() -> None:
    radio, truths = radio_of(RadioSection()), Mission(line(ROBOTS, 5.0), RadioSection())
    radio.place(truths.truth({}), 0)
    outbox = (message(BROADCAST, 100),)
    assert radio.hand_over(TransmitRequest(1, 0.0, 0.0, outbox), 7_000_000) == []
    arrives = 0
    while not arrives:
        due = radio.follow(radio.next_event())
        arrives = radio.now_ns if due else 0
    assert 7_000_000 < arrives < 9_000_000
    receptions = [heard.reception for _, heard in due]
    assert [one.arrival_ns for one in receptions if one is not None] == [arrives] * 3


def test_what_a_truth_brings_is_sent_unless_it_was_handed_over_before() -> None:
    radio, truths = radio_of(RadioSection()), Mission(line(ROBOTS, 5.0), RadioSection())
    radio.place(truths.truth({}), 0)
    outbox: tuple[Transmission, ...] = (message(BROADCAST, 100),)
    radio.hand_over(TransmitRequest(1, 0.0, 0.0, outbox), 1_000)
    _, first = radio.close(PERIOD)
    truths.tick = 1
    radio.place(truths.truth({1: outbox, 2: outbox}), PERIOD)
    _, second = radio.close(2 * PERIOD)
    assert first is not None
    assert second is not None
    assert {one.source for one in first.verdicts} == {1}
    assert {one.source for one in second.verdicts} == {2}
    assert {one.offered_ns for one in second.verdicts} == {PERIOD}


def test_an_instant_that_has_passed_becomes_the_present_one() -> None:
    radio, truths = radio_of(RadioSection()), Mission(line(ROBOTS, 5.0), RadioSection())
    radio.place(truths.truth({}), 5_000)
    radio.hand_over(TransmitRequest(1, 0.0, 0.0, (message(2),)), 3_000)
    _, record = radio.close(4_000)
    assert record is not None
    assert record.intake is not None
    assert record.intake.handed[0].at_ns == record.intake.until_ns == 5_000
