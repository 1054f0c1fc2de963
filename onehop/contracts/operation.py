"""What world, operator and injector tell each other. Each is the content of one bus key (topics.py)."""

from onehop.contracts.fault_section import FaultSection
from onehop.contracts.messages import Outcome
from onehop.contracts.team import Status
from onehop.contracts.values import Value, Wire


class Punctuality(Value, frozen=True):
    """How a mission of real time kept its schedule.

    speed: simulated seconds in one of the wall clock. start_s: when tick 0 was due, or would have been
    by the schedule as it is now (CLOCK_MONOTONIC of the world's host [s]). late_ticks: that began late
    (schedule.py). latest_ms: how late any tick began at most. moved_ms: by how much the schedule was
    moved in all. unanswered: ticks of robots that gave nothing for them. unrecorded_ticks: that the
    recorder was too slow for.
    """

    speed: float
    start_s: float
    late_ticks: int
    latest_ms: float
    moved_ms: float
    unanswered: int
    unrecorded_ticks: int

    def in_words(self) -> str:
        """The same in one line, for people."""
        words = f"{self.late_ticks} late ticks, {self.latest_ms:.1f} ms at most"
        if self.moved_ms:
            words += f", schedule moved by {self.moved_ms:.0f} ms"
        if self.unrecorded_ticks:
            words += f", {self.unrecorded_ticks} ticks not recorded"
        return words


class End(Wire, frozen=True):
    """World to all: the mission is over (key end). last_tick: the last one that is recorded.

    wall_s: wall-clock time of the ticks; it is for people and stays out of the log. punctuality: in real
    time.
    """

    outcome: Outcome
    last_tick: int
    wall_s: float
    punctuality: Punctuality | None = None


class Death(Wire, frozen=True):
    """Operator to world (key died): a process has ended by a signal or with an error.

    incarnation: how often it had been started again. account: how it ended, and its last words.
    """

    name: str
    incarnation: int
    account: str


class FaultOrder(Wire, frozen=True):
    """Injector to world (key fault): carry out a fault with the next tick.

    number: of this order, by which its answer is known; an order that is repeated counts once.
    """

    number: int
    fault: FaultSection


class FaultAnswer(Wire, frozen=True):
    """World to injector (key answer). tick: whose truth shows the fault; refusal: why none does."""

    number: int
    tick: int
    refusal: str
    fault: FaultSection


class Pace(Wire, frozen=True):
    """Operator to world (key pace): how it goes from one tick to the next; the bytes stay what they are.

    ticks_per_s: at most so many, wall clock [1/s]; 0 for as many as there can be. paused: it waits
    after each tick. steps: ticks that it may take all the same, counted from this message on.
    """

    ticks_per_s: float
    paused: bool
    steps: int


class RobotProgress(Value, frozen=True):
    """One line of the progress display; speed [m/s]."""

    robot: int
    speed: float
    status: Status | None


class Progress(Wire, frozen=True):
    """World to operator, a few times a second (key progress): how far the mission is.

    punctuality: in real time.
    """

    tick: int
    time_ns: int
    robots: tuple[RobotProgress, ...]
    punctuality: Punctuality | None = None
