"""How fast the world goes from one tick to the next: as people who watch want it, which no byte tells.

It holds within a tick, when everyone has said what they had to say for it and before the world moves: an
order of a fault that comes meanwhile is carried out with the next tick, and lets that one tick pass.
"""

import contextlib
import math
import time

from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.contracts.operation import Pace
from onehop.wire.codec import decode
from world_server.fault_orders import FaultOrders
from world_server.mailbox import Mailbox, MissionBrokenError
from world_server.recording import Recording

LOOK_S = 60.0
"""How long a paused world waits at once [s]: it goes on waiting until it is told to go on."""

SLOWEST_S = 0.5
"""A tick is held no longer than this by a pace [s]: nothing is read meanwhile."""

FULL_SPEED = Pace(ticks_per_s=0.0, paused=False, steps=0)


class PaceKeeper:
    """Holds the world between ticks, if the operator wants it.

    orders: of faults, each of which lets a paused world take one tick.
    """

    def __init__(self, mail: Mailbox, recording: Recording, orders: FaultOrders) -> None:
        self._mail = mail
        self._recording = recording
        self._orders = orders
        self._pace = FULL_SPEED
        self._steps = 0
        self._due_s = -math.inf
        mail.read(topics.OPERATOR, topics.PACE, self._on_pace)

    def hold(self) -> None:
        """Wait as long as the pace wants it.

        When the mission is broken off meanwhile, the tick ends as any other, and the next one finds out.
        """
        if self._pace.paused:
            self._recording.hand_over()  # people look at what has happened so far
            with contextlib.suppress(MissionBrokenError):
                while not self._mail.wait(self._may_go_on, LOOK_S):
                    pass
            self._steps = max(0, self._steps - 1)
        elif self._pace.ticks_per_s > 0:
            self._keep_time(1.0 / self._pace.ticks_per_s)

    def _may_go_on(self) -> bool:
        return not self._pace.paused or self._steps > 0 or self._orders.are_waiting

    def _keep_time(self, period_s: float) -> None:
        """Begin no tick before its time; what is late is not made up for."""
        now = time.monotonic()
        wait_s = min(max(0.0, self._due_s - now), SLOWEST_S)
        if wait_s > 0:
            self._recording.hand_over()
            time.sleep(wait_s)
        self._due_s = max(self._due_s, now) + period_s

    def _on_pace(self, data: bytes) -> None:
        try:
            pace = decode(Pace, data)
        except DecodeError:
            return
        self._pace, self._steps, self._due_s = pace, pace.steps, -math.inf
