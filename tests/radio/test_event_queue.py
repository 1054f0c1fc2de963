"""The order in which the radio's events happen."""

from typing import Any

from radio_proxy.core.event_queue import NEVER, EventQueue


class Clock:
    """An event queue, and what happened in it."""

    def __init__(self) -> None:
        self.next_access = NEVER
        self.happened: list[tuple[str, int]] = []
        self.queue = EventQueue(self, self.on_access)

    def on_access(self, now: int) -> None:
        self.happened.append(("access", now))
        self.next_access = NEVER

    def note(self, name: Any, now: int) -> None:
        self.happened.append((name, now))


def test_events_happen_in_order_of_time_and_then_of_scheduling() -> None:
    clock = Clock()
    for name, time_ns in (("b", 5), ("c", 9), ("a", 5), ("first", 1)):
        clock.queue.at(time_ns, clock.note, name)
    clock.queue.run(9)
    assert clock.happened == [("first", 1), ("b", 5), ("a", 5), ("c", 9)]


def test_a_station_transmits_after_all_events_of_its_instant() -> None:
    clock = Clock()
    clock.next_access = 5
    clock.queue.at(5, lambda name, now: clock.queue.at(now, clock.note, name), "scheduled at 5")
    clock.queue.at(6, clock.note, "later")
    clock.queue.run(10)
    assert clock.happened == [("scheduled at 5", 5), ("access", 5), ("later", 6)]


def test_an_event_may_defer_the_next_station() -> None:
    clock = Clock()
    clock.next_access = 5

    def defer(_: Any, __: int) -> None:
        clock.next_access = 7

    clock.queue.at(4, defer, None)
    clock.queue.run(6)
    assert clock.happened == []
    clock.queue.run(7)
    assert clock.happened == [("access", 7)]


def test_what_lies_beyond_the_horizon_waits_for_the_next_run() -> None:
    clock = Clock()
    clock.queue.at(11, clock.note, "late")
    clock.queue.run(10)
    assert (clock.queue.horizon, clock.happened) == (10, [])
    clock.queue.run(20)
    assert clock.happened == [("late", 11)]
