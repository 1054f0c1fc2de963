"""When each tick is due on the wall clock, and what it means when the world is late.

Tick k is due at start + k * period / speed: a late tick makes no later one late. Only a world that is
late by more than a period moves its schedule, by as much: then simulated time goes slower for a moment,
and every tick still lasts a period, in which robots can answer. No simulated time is left out.
"""

from dataclasses import dataclass

LATE_SHARE = 0.2
"""Share of a tick's length on the wall clock after which its begin is late: 10 ms of 50."""


@dataclass(slots=True)
class Schedule:
    """Of one mission. period_s: of a tick on the wall clock. speed: simulated seconds in one of it.

    start_s: when tick 0 was due, or would have been (time.monotonic() [s]). anchor: how often the
    schedule has been moved, moved_s: by how much in all [s]. late_ticks, latest_s: counted so far.
    """

    period_s: float
    speed: float
    start_s: float = 0.0
    anchor: int = 0
    moved_s: float = 0.0
    late_ticks: int = 0
    latest_s: float = 0.0

    def due_s(self, tick: int) -> float:
        """When a tick is due."""
        return self.start_s + tick * self.period_s

    def clock_ns(self, now_s: float) -> int:
        """Simulated time at an instant of the wall clock [ns]."""
        return max(0, round((now_s - self.start_s) * self.speed * 1e9))

    def begin(self, tick: int, now_s: float) -> float | None:
        """A tick begins now: how late, if that is late [s]."""
        late_s = now_s - self.due_s(tick)
        self.latest_s = max(self.latest_s, late_s)
        if late_s > self.period_s:
            self.start_s += late_s
            self.moved_s += late_s
            self.anchor += 1
        if late_s <= LATE_SHARE * self.period_s:
            return None
        self.late_ticks += 1
        return late_s
