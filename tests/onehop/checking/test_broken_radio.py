"""Radios that carry what they cannot, and faults that do nothing: each is found by its name."""

from collections.abc import Callable
from typing import Any

import pytest

from tests.onehop.checking.conftest import KILLED
from tests.onehop.forgery import Fields, Forgery


def first_delivery(log: Forgery, first: int = 40) -> tuple[int, int, Fields, int]:
    """Tick, place in the record, verdict, and place in the inbox of a message that was delivered."""
    for tick, place, verdict in log.verdicts(first=first):
        inbox = log.get(tick, f"rx/{verdict['receiver']}")["receptions"]
        for number, one in enumerate(inbox):
            mine = (one["source"], one["arrival_ns"]) == (verdict["source"], verdict["arrival_ns"])
            if mine and verdict["destination"]:
                return tick, place, verdict, number
    raise AssertionError("nothing was delivered")


def change_both(log: Forgery, **fields: Any) -> None:
    """Change a message's verdict and its reception alike."""
    tick, place, verdict, number = first_delivery(log)
    log.change(tick, "radio", lambda record: record["verdicts"][place].update(fields))
    key = f"rx/{verdict['receiver']}"
    known = {
        name: value for name, value in fields.items() if name in log.get(tick, key)["receptions"][0]
    }
    log.change(tick, key, lambda inbox: inbox["receptions"][number].update(known))


def change_reception(log: Forgery, change: Callable[[list[Fields], int], object]) -> None:
    tick, _, verdict, number = first_delivery(log)
    log.change(tick, f"rx/{verdict['receiver']}", lambda inbox: change(inbox["receptions"], number))


def deliver_what_was_never_sent(log: Forgery) -> None:
    change_both(log, message=9999)


def deliver_again(log: Forgery) -> None:
    tick, _, verdict, number = first_delivery(log)
    key, later = f"rx/{verdict['receiver']}", 50_000_000
    again = {**verdict, "arrival_ns": verdict["arrival_ns"] + later}
    copy = {**log.get(tick, key)["receptions"][number], "arrival_ns": again["arrival_ns"]}
    log.change(tick + 1, "radio", lambda record: record["verdicts"].insert(0, again))
    log.change(tick + 1, key, lambda inbox: inbox["receptions"].insert(0, copy))


def deliver_twice_at_once(log: Forgery) -> None:
    change_reception(log, lambda inbox, number: inbox.append(inbox[number]))


def arrive_before_the_airtime(log: Forgery) -> None:
    _, _, verdict, _ = first_delivery(log)
    change_both(log, service_start_ns=verdict["arrival_ns"] - 1_000_000)


def go_two_hops_in_the_time_of_one(log: Forgery) -> None:
    _, _, verdict, _ = first_delivery(log)
    relay = next(i for i in (1, 2, 3, 4) if i not in verdict["path"])
    path = [verdict["path"][0], relay, verdict["path"][-1]]
    tick, place, _, number = first_delivery(log)
    log.change(tick, "radio", lambda r: r["verdicts"][place].update(path=path, attempts=[1, 1]))
    key = f"rx/{verdict['receiver']}"
    log.change(tick, key, lambda inbox: inbox["receptions"][number].update(hops=2, attempts=2))


def alter_a_payload(log: Forgery) -> None:
    change_reception(log, lambda inbox, number: inbox[number].update(payload=b"altered"))


def alter_and_say_so(log: Forgery) -> None:
    change_both(log, status="corrupted")
    alter_by_place(log)


def alter_by_place(log: Forgery) -> None:
    for tick, _, verdict in log.verdicts("corrupted"):
        key = f"rx/{verdict['receiver']}"
        log.change(tick, key, lambda inbox: inbox["receptions"][0].update(payload=b"altered"))


def name_another_source(log: Forgery) -> None:
    tick, _, verdict, number = first_delivery(log)
    other = next(i for i in (1, 2, 3, 4) if i not in (verdict["source"], verdict["receiver"]))
    key = f"rx/{verdict['receiver']}"
    log.change(tick, key, lambda inbox: inbox["receptions"][number].update(source=other))


def hear_what_nobody_delivered(log: Forgery) -> None:
    tick, place, _, _ = first_delivery(log)
    log.change(tick, "radio", lambda record: record["verdicts"].pop(place))


def lose_what_was_delivered(log: Forgery) -> None:
    change_reception(log, lambda inbox, number: inbox.pop(number))


def claim_another_size(log: Forgery) -> None:
    change_both(log, msdu_bytes=1)


def judge_twice(log: Forgery) -> None:
    tick, _, verdict, _ = first_delivery(log)
    log.change(tick, "radio", lambda record: record["verdicts"].append(verdict))


def lose_what_has_arrived(log: Forgery) -> None:
    tick, _, verdict, _ = first_delivery(log)
    lost = {**verdict, "status": "below threshold", "arrival_ns": -1}
    log.change(tick + 1, "radio", lambda record: record["verdicts"].append(lost))


def claim_another_destination(log: Forgery) -> None:
    _, _, verdict, _ = first_delivery(log)
    change_both(log, destination=verdict["destination"] % 4 + 1)


def claim_to_have_been_offered_later(log: Forgery) -> None:
    _, _, verdict, _ = first_delivery(log)
    change_both(log, offered_ns=verdict["offered_ns"] + 1)


def arrive_in_another_tick(log: Forgery) -> None:
    _, _, verdict, _ = first_delivery(log)
    change_both(log, arrival_ns=verdict["arrival_ns"] + 50_000_000)


def begin_the_way_elsewhere(log: Forgery) -> None:
    tick, place, verdict, _ = first_delivery(log)
    way = [verdict["receiver"], verdict["source"]]
    log.change(tick, "radio", lambda record: record["verdicts"][place].update(path=way))


@pytest.mark.parametrize(
    "alter",
    [
        judge_twice,
        lose_what_has_arrived,
        claim_another_destination,
        claim_to_have_been_offered_later,
        arrive_in_another_tick,
        begin_the_way_elsewhere,
        deliver_what_was_never_sent,
        deliver_again,
        deliver_twice_at_once,
        arrive_before_the_airtime,
        go_two_hops_in_the_time_of_one,
        alter_a_payload,
        alter_and_say_so,
        name_another_source,
        hear_what_nobody_delivered,
        lose_what_was_delivered,
        claim_another_size,
    ],
)
def test_what_the_radio_cannot_have_done_is_found(broken: Any, alter: Any) -> None:
    assert set(broken(alter).broken) == {"radio-integrity"}


AT_S, AT, END = 2.0, 40, 80


def scripted(fault: str, kind: str, **fields: Any) -> Callable[[Forgery], None]:
    """A fault of the scenario that the truth tells of, and no more."""

    def alter(log: Forgery) -> None:
        log.settings.append(f"faults=[{{kind='{kind}', at_s={AT_S}, duration_s=2, {fault}}}]")
        told = {"kind": kind, "at_s": AT_S, "robots": [], "duration_s": 2.0, **fields}
        log.change(AT, "truth", lambda truth: truth["faults"].append(told))

    return alter


def in_force(alter: Callable[[Forgery], None], name: str, state: Any) -> Callable[[Forgery], None]:
    """The same, and the truth says that it is in force."""

    def altered(log: Forgery) -> None:
        alter(log)
        for tick in range(AT, END):
            log.change(tick, "truth", lambda truth: truth[name].append(state))

    return altered


CUT = scripted("robots=[1]", "cut", robots=[1])
JAM = scripted("x=10, y=10, radius=30, noise_dbm=0", "jam", x=10.0, y=10.0, radius=30.0, noise_dbm=0.0)
CORRUPT = scripted("robots=[1]", "corrupt", robots=[1])
BLIND = scripted("robots=[1]", "blind", robots=[1])
STOP = scripted("robots=[1]", "stop", robots=[1])
HOLD = scripted("robots=[1]", "hold", robots=[1])
SLOW = scripted("robots=[1], delay_ticks=3", "slow", robots=[1], delay_ticks=3)
CUT_STATE = {"side_a": [1], "side_b": [2, 3, 4], "one_way": False}
JAM_STATE = {"x": 10.0, "y": 10.0, "radius": 30.0, "noise_dbm": 0.0}
KIDNAP = "faults=[{kind='kidnap', at_s=2, robots=[1], x=30, y=30}]"
KILL = "faults=[{kind='kill', at_s=2, robots=[4]}]"
RESTART = "faults=[{kind='restart', at_s=2, robots=[4]}]"


def never_begin(log: Forgery) -> None:
    log.settings.append(KILL)


def tell(kind: str, setting: str, **fields: Any) -> Callable[[Forgery], None]:
    """A fault that happens at once, and does not."""

    def alter(log: Forgery) -> None:
        log.settings.append(setting)
        told = {"kind": kind, "at_s": AT_S, **fields}
        log.change(AT, "truth", lambda truth: truth["faults"].append(told))

    return alter


@pytest.mark.parametrize(
    "alter",
    [
        never_begin,
        tell("kill", KILL, robots=[4]),
        tell("restart", RESTART, robots=[4]),
        tell("kidnap", KIDNAP, robots=[1], x=30.0, y=30.0),
        CUT, JAM, CORRUPT, BLIND, STOP, HOLD, SLOW,
        in_force(CUT, "cuts", CUT_STATE),
        in_force(JAM, "jams", JAM_STATE),
        in_force(CORRUPT, "corruptions", {"robots": [1], "probability": 1.0}),
        in_force(BLIND, "blind", 1),
    ],
    ids=[
        "never begun", "kill", "restart", "kidnap", "cut", "jam", "corrupt", "blind", "stop", "hold",
        "slow", "cut carries", "jam changes nothing", "corrupt alters nothing", "blind sees",
    ],
)  # fmt: skip
def test_a_fault_without_effect_is_found(broken: Any, alter: Any) -> None:
    assert set(broken(alter).broken) == {"fault-bit"}


@pytest.mark.parametrize("alter", [tell("kill", KILL, robots=[4]), tell("restart", RESTART, robots=[4])])
def test_a_robot_that_departs_and_stays_the_same_is_found(broken: Any, alter: Any) -> None:
    def depart(log: Forgery) -> None:
        alter(log)
        gone = {"robot": 4, "why": "by a fault"}
        log.change(AT, "truth", lambda truth: truth["departures"].append(gone))

    assert "fault-bit" in broken(depart).broken


def test_a_stopped_robot_that_speaks_is_found(broken: Any) -> None:
    found = set(broken(in_force(STOP, "stopped", 1)).broken)
    assert {"fault-bit", "silence"} <= found


def test_a_slow_robot_that_is_not_late_is_found(broken: Any) -> None:
    late = in_force(SLOW, "slow", {"robot": 1, "delay_ticks": 3})
    assert "own-voice" in broken(late).broken


def heal_too_early(log: Forgery) -> None:
    log.change(200, "truth", lambda truth: truth.update(cuts=[]))


def hold_too_long(log: Forgery) -> None:
    log.present(range(181, 183), 4, lambda one: one.update(held=True) if "held" in one else None)


def jam_too_long(log: Forgery) -> None:
    jam = log.get(265, "truth")["jams"]
    assert jam
    log.change(KILLED, "truth", lambda truth: truth.update(jams=jam))


def leave_without_a_word(log: Forgery) -> None:
    log.change(KILLED, "truth", lambda truth: truth.update(departures=[]))


@pytest.mark.parametrize("alter", [heal_too_early, hold_too_long, jam_too_long, leave_without_a_word])
def test_a_fault_that_begins_or_ends_at_another_tick_is_found(broken: Any, alter: Any) -> None:
    assert "fault-bit" in broken(alter, "troubled").broken
