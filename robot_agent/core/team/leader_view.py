"""What a follower knows of its leader: its last word, how long it is silent, and which Next is due."""

from onehop.contracts.geometry import Pose

Points = tuple[tuple[float, float], ...]

TRAIL_POINTS = 16
"""Way points kept of a leader that tells poses but no trail (profile `thesis`)."""


class LeaderView:
    """The leader as one follower sees it. period_ns: of Next.

    silent_since_ns: since when nothing was heard of it. at_slot_since_ns: since when the follower stands
    in the slot that it was told last; None while it does not. pose: None before its first word. trail:
    its way, oldest point first [m]. lane: ends of the piece of its way to be kept clear [m], or none.
    """

    __slots__ = (
        "_next_due_ns",
        "_period_ns",
        "at_slot_since_ns",
        "lane",
        "pose",
        "silent_since_ns",
        "trail",
    )

    def __init__(self, now_ns: int, period_ns: int, pose: Pose | None = None) -> None:
        self._period_ns = period_ns
        self.silent_since_ns = now_ns
        self.at_slot_since_ns: int | None = None
        self.pose = pose
        self.trail: Points = ()
        self.lane: Points = ()
        self.expect_next(now_ns)

    def expect_next(self, now_ns: int) -> None:
        """The next Next is due a period from now; a quarter of a period is its grace."""
        self._next_due_ns = now_ns + self._period_ns * 5 // 4

    def misses_next(self, now_ns: int) -> bool:
        """Whether one more Next is overdue; asked at every tick, true once for each."""
        if now_ns <= self._next_due_ns:
            return False
        self._next_due_ns += self._period_ns
        return True

    def is_overdue(self, now_ns: int) -> bool:
        """Whether the leader was silent for more than a period and its grace."""
        return now_ns - self.silent_since_ns > self._period_ns * 5 // 4

    def stands(self, now_ns: int, in_slot: bool) -> None:
        """Take where the follower is at this tick."""
        if not in_slot:
            self.at_slot_since_ns = None
        elif self.at_slot_since_ns is None:
            self.at_slot_since_ns = now_ns

    def silent_at_slot_ns(self, now_ns: int) -> int:
        """For how long it is silent and the follower in its slot, less a quarter of a period of grace.

        A Next is due a whole period after the last, and then takes its time on the air.
        """
        if self.at_slot_since_ns is None:
            return 0
        since_ns = max(self.silent_since_ns, self.at_slot_since_ns)
        return now_ns - since_ns - self._period_ns // 4

    def on_word(self, now_ns: int, pose: Pose) -> None:
        """The leader was heard, by a command or a beacon."""
        self.silent_since_ns, self.pose = now_ns, pose

    def on_next(self, now_ns: int, pose: Pose, trail: Points) -> None:
        """A command came; without a trail in it, the poses of commands make one."""
        self.trail = trail or (*self.trail[1 - TRAIL_POINTS :], (pose.x, pose.y))
        self.expect_next(now_ns)

    def await_other(self, now_ns: int) -> None:
        """Another leader is expected; the way of the old one leads nowhere any more."""
        self.silent_since_ns = now_ns
        self.trail = self.lane = ()
