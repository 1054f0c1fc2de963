"""The world's simulated clock, as a process sees it that hears from the world: no clock is set.

Every message that says what the world's clock was when it was sent came some time later. The one that
took least tells best how the two clocks lie to each other; what is older than some seconds does not
count, since clocks of two hosts drift apart.
"""

import math

MEMORY_S = 5.0
"""The least delay of the last one to two such times counts [s]. Quartz clocks drift by less than 100
microseconds a second: by less than 1 ms meanwhile."""


class SimulatedClock:
    """speed: simulated seconds in one of the wall clock."""

    def __init__(self, speed: float) -> None:
        self._speed = speed
        self._anchor = -1
        self._begun_s = 0.0
        self._before_s = self._offset_s = math.inf

    def on_stamp(self, sent_ns: int, arrived_s: float, anchor: int) -> None:
        """A message that was sent at a simulated time [ns] has come (time.monotonic() [s]).

        anchor: another one than before means that the world's clock has been set.
        """
        offset_s = arrived_s - sent_ns / 1e9 / self._speed
        if anchor != self._anchor:
            self._anchor, self._begun_s = anchor, arrived_s
            self._before_s = self._offset_s = offset_s
        elif arrived_s - self._begun_s > MEMORY_S:
            self._before_s, self._offset_s = self._offset_s, offset_s
            self._begun_s = arrived_s
        else:
            self._offset_s = min(self._offset_s, offset_s)

    @property
    def is_set(self) -> bool:
        """Whether anything is known of the world's clock."""
        return self._anchor >= 0

    def now_ns(self, wall_s: float) -> int:
        """Simulated time at an instant of the wall clock."""
        return math.floor((wall_s - self._zero_s) * self._speed * 1e9)

    def wall_s(self, time_ns: int) -> float:
        """The instant of the wall clock at a simulated time."""
        return self._zero_s + time_ns / 1e9 / self._speed

    @property
    def _zero_s(self) -> float:
        return min(self._before_s, self._offset_s)
