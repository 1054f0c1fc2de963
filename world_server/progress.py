"""What people are shown: some numbers, some times a second, and each fault that begins."""

import time
from collections.abc import Mapping

from onehop.contracts import topics
from onehop.contracts.fault_section import fault_in_words
from onehop.contracts.messages import Action, Truth
from onehop.contracts.operation import Progress, Punctuality, RobotProgress
from onehop.node.bus import Bus
from onehop.wire.codec import encode

PROGRESS_S = 0.2
"""Wall-clock time between two reports [s]."""


class ProgressReports:
    """Reports to the operator, who may or may not listen."""

    def __init__(self, bus: Bus) -> None:
        self._put = bus.publisher(topics.to(topics.OPERATOR, topics.PROGRESS), express=False)
        self._tell = bus.publisher(topics.to(topics.OPERATOR, topics.TOLD))
        self._next_s = 0.0

    def report(
        self, truth: Truth, actions: Mapping[int, Action], punctuality: Punctuality | None = None
    ) -> None:
        """Tell of the faults of a tick, and report it, if it is time.

        actions: by robot, ids ascending. punctuality: in real time.
        """
        for fault in truth.faults:
            self._tell(f"{truth.time_ns / 1e9:g} s: {fault_in_words(fault)}".encode())
        now = time.monotonic()
        if now < self._next_s:
            return
        self._next_s = now + PROGRESS_S
        lines = tuple(RobotProgress(i, action.twist.v, action.status) for i, action in actions.items())
        self._put(encode(Progress(truth.tick, truth.time_ns, lines, punctuality)))
