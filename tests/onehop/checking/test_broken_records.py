"""Logs that are not all that was said, or say it in somebody else's name: each is found by name."""

from typing import Any

import msgpack
import pytest

from tests.onehop.checking.conftest import KILLED, LEADER, RETURNED
from tests.onehop.forgery import Forgery

DEAD = KILLED + 20


def miss_a_tick(log: Forgery) -> None:
    del log.ticks[50]


def miss_the_last_ticks(log: Forgery) -> None:
    del log.ticks[-5:]


def lose_everything(log: Forgery) -> None:
    log.ticks.clear()


def double_a_message(log: Forgery) -> None:
    log.add(50, "out/3", log.get(50, "out/3"))


def double_a_tick(log: Forgery) -> None:
    log.ticks[50][1].extend(list(log.ticks[50][1]))


def go_back(log: Forgery) -> None:
    log.ticks.insert(50, log.ticks[40])


def lose_an_inbox(log: Forgery) -> None:
    log.remove(next(t for t in range(50, 99) if not log.get(t, "rx/1")["receptions"]), "rx/1")


def lose_a_record(log: Forgery) -> None:
    log.remove(50, "radio")


def spoil_a_message(log: Forgery) -> None:
    log.change(50, "rx/1", lambda inbox: inbox.pop("receptions"))


def misdate_an_observation(log: Forgery) -> None:
    log.change(50, "obs/1", lambda observation: observation.update(time_ns=1))


def stand_nowhere(log: Forgery) -> None:
    log.change(50, "obs/1", lambda observation: observation["pose"].update(heading=float("inf")))


def obey_nobody(log: Forgery) -> None:
    log.say(range(50, 51), 1, members=[])


def have_a_stranger(log: Forgery) -> None:
    log.change(50, "truth", lambda truth: truth["present"][0].update(robot=9))


@pytest.mark.parametrize(
    "alter",
    [miss_a_tick, lose_everything, miss_the_last_ticks,
     double_a_message, double_a_tick, go_back, lose_an_inbox,
     lose_a_record, spoil_a_message, misdate_an_observation],
)  # fmt: skip
def test_what_is_missing_or_there_twice_is_found(broken: Any, alter: Any) -> None:
    assert set(broken(alter).broken) == {"complete"}


def test_a_robot_that_gives_no_action_and_stays_is_found(broken: Any) -> None:
    report = broken(lambda log: log.remove(50, "out/3"))
    assert "complete" in report.broken
    assert report.violations[0].robots == (3,)


def say_something_else(log: Forgery) -> None:
    log.say(range(50, 51), 3, k_rho=2.5)


def see_something_else(log: Forgery) -> None:
    log.change(50, "obs/3", lambda observation: observation.update(scan=observation["scan"][::-1]))


def drop_a_note(log: Forgery) -> None:
    tick = next(t for t in range(1, 120) if log.get(t, f"out/{LEADER}")["notes"])
    log.change(tick, f"out/{LEADER}", lambda action: action.update(notes=[]))


@pytest.mark.parametrize("alter", [say_something_else, see_something_else, drop_a_note])
def test_what_only_the_digest_shows_is_found_by_it(broken: Any, alter: Any) -> None:
    assert broken(alter).violations == ()
    assert set(broken(alter, hides_traces=False).broken) == {"digest"}


def test_more_ticks_than_the_mission_had_are_found(broken: Any) -> None:
    assert set(broken(lambda log: log.summary.update(ticks=100)).broken) == {"digest"}


def speak_as_another_process(log: Forgery) -> None:
    log.change(50, "out/3", lambda action: action.update(incarnation=1))


def speak_as_another_process_at_the_end(log: Forgery) -> None:
    """No truth follows that would show it."""
    log.change(119, "out/3", lambda action: action.update(incarnation=1))


def pass_on_something_else(log: Forgery) -> None:
    log.change(50, "truth", lambda truth: truth["transmit_requests"][0].update(speed=0.123))


def pass_on_nothing(log: Forgery) -> None:
    log.change(50, "truth", lambda truth: truth["transmit_requests"].pop(0))


def see_with_other_eyes(log: Forgery) -> None:
    other = log.get(50, "obs/4")
    log.change(50, "obs/3", lambda observation: observation.update(other))


def speak_for_each_other(log: Forgery) -> None:
    one, other = log.get(50, "out/3"), log.get(50, "out/4")
    log.change(50, "out/3", lambda action: action.update(other))
    log.change(50, "out/4", lambda action: action.update(one))


@pytest.mark.parametrize(
    "alter",
    [speak_as_another_process, speak_as_another_process_at_the_end, pass_on_something_else,
     pass_on_nothing, see_with_other_eyes,
     speak_for_each_other],
)  # fmt: skip
def test_words_in_another_s_name_are_found(broken: Any, alter: Any) -> None:
    assert "own-voice" in broken(alter).broken


def last_word(log: Forgery, key: str) -> dict[str, Any]:
    return {**log.get(KILLED - 1, key), "tick": DEAD}


def the_dead_speaks(log: Forgery) -> None:
    log.add(DEAD, f"out/{LEADER}", last_word(log, f"out/{LEADER}"))


def the_dead_is_told(log: Forgery) -> None:
    said = {**last_word(log, f"rx/{LEADER}"), "time_ns": DEAD * 50_000_000}
    log.add(DEAD, f"rx/{LEADER}", said)


def the_dead_sees(log: Forgery) -> None:
    said = {**last_word(log, f"obs/{LEADER}"), "time_ns": DEAD * 50_000_000}
    log.add(DEAD, f"obs/{LEADER}", said)


def the_dead_sends(log: Forgery) -> None:
    request = {"robot": LEADER, "speed": 0.0, "remaining_distance": 0.0, "outbox": []}
    log.change(DEAD, "truth", lambda truth: truth["transmit_requests"].insert(1, request))


@pytest.mark.parametrize("alter", [the_dead_speaks, the_dead_is_told, the_dead_sees, the_dead_sends])
def test_a_dead_robot_that_takes_part_is_found(broken: Any, alter: Any) -> None:
    found = set(broken(alter, "troubled").broken)
    assert "silence" in found
    assert found <= {"silence", "fault-bit"}
    assert ("fault-bit" in found) is (alter is the_dead_speaks)


def return_too_often(log: Forgery) -> None:
    log.change(50, "truth", lambda truth: truth["present"][0].update(incarnation=2**63))


@pytest.mark.parametrize("alter", [stand_nowhere, obey_nobody, have_a_stranger, return_too_often])
def test_a_message_that_cannot_be_is_found(broken: Any, alter: Any) -> None:
    assert "complete" in broken(alter).broken


def test_the_message_that_shows_it_is_named(broken: Any) -> None:
    report = broken(the_dead_speaks, "troubled")
    shown = {(one.tick, exhibit.topic) for one in report.violations for exhibit in one.evidence}
    assert (DEAD, f"/wire/out/{LEADER}") in shown
    assert {one.robots for one in report.violations} == {(LEADER,)}
    assert DEAD < RETURNED


def test_behind_a_gap_the_rest_is_judged_without_false_alarm(broken: Any) -> None:
    def tear_a_hole(log: Forgery) -> None:
        del log.ticks[45:61]

    report = broken(tear_a_hole, "troubled")
    assert set(report.broken) == {"complete"}
    assert report.checked["radio-integrity"] > 100


def test_behind_a_gap_a_message_that_was_never_sent_is_found(broken: Any) -> None:
    def tear_and_lie(log: Forgery) -> None:
        tick, receiver = next((t, v["receiver"]) for t, _, v in log.verdicts(first=100))
        lie = msgpack.packb("never said")
        key = f"rx/{receiver}"
        log.change(tick, key, lambda inbox: inbox["receptions"][0].update(payload=lie))
        del log.ticks[20:31]

    assert set(broken(tear_and_lie).broken) == {"complete", "radio-integrity"}
