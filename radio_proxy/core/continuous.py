"""The radio where truths and messages come at any instant: it is asked to follow the clock.

What it does depends on what came, in which order and at which simulated instants, and on nothing else:
neither on the steps by which the clock was followed, nor on a clock. Those instants are in its records,
so that a log of real time can be re-executed. An instant that lies before what has happened already
becomes the present one.
"""

from collections.abc import Iterable

from msgspec.structs import replace

from onehop.contracts.messages import (
    HandOver,
    Heard,
    Intake,
    RadioRecord,
    TransmitRequest,
    Truth,
)
from radio_proxy.core.bounds import Carrier

Due = list[tuple[int, Heard]]
"""Robots, and what they are told, in order."""


class ContinuousRadio:
    """A radio that runs. now_ns: how far it is."""

    def __init__(self, radio: Carrier) -> None:
        self._radio = radio
        self.now_ns = 0
        self._truth: Truth | None = None
        self._placed_ns = 0
        self._handed: list[HandOver] = []
        self._numbers: dict[int, int] = {}

    def next_event(self) -> int:
        """When something happens next [ns]."""
        return self._radio.next_event()

    def follow(self, until: int) -> Due:
        """Let the time pass up to an instant [ns]."""
        self.now_ns = max(self.now_ns, until)
        return [
            (robot, Heard(self._number(robot), reception))
            for robot, reception in self._radio.follow(self.now_ns)
        ]

    def hand_over(self, request: TransmitRequest, at_ns: int) -> Due:
        """A robot hands messages to its NIC."""
        due = self.follow(at_ns)
        self._handed.append(HandOver(request.robot, self.now_ns))
        self._radio.hand_over([request], self.now_ns)
        return due

    def close(self, at_ns: int) -> tuple[Due, RadioRecord | None]:
        """The truth that has held so far ends: the record of its tick, if there was one."""
        due = self.follow(at_ns)
        truth = self._truth
        if truth is None:
            return due, None
        carried = self._radio.account(truth)
        for robot, inbox in carried.inboxes.items():
            if inbox.neighbours:
                due.append((robot, Heard(self._number(robot), neighbours=inbox.neighbours)))
        intake = Intake(self._placed_ns, tuple(self._handed), self.now_ns)
        return due, replace(carried.record, intake=intake)

    def place(self, truth: Truth, at_ns: int) -> Due:
        """A truth begins to hold. What it offers to the air and was not handed over before is so now."""
        due = self.follow(at_ns)
        already = {one.robot for one in self._handed}
        self._truth, self._placed_ns, self._handed = truth, self.now_ns, []
        self._radio.place(truth, self.now_ns)
        offered: Iterable[TransmitRequest] = truth.transmit_requests
        self._radio.hand_over([one for one in offered if one.robot not in already], self.now_ns)
        return due

    def _number(self, robot: int) -> int:
        self._numbers[robot] = self._numbers.get(robot, 0) + 1
        return self._numbers[robot]
