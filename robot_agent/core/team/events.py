"""What happens to a robot's part in its team that its motion must know of, told once, in order."""

from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True, slots=True)
class BecameLeader:
    """It leads from now on."""


@dataclass(frozen=True, slots=True)
class BecameFollower:
    """It led, and does so no more."""


@dataclass(frozen=True, slots=True)
class NextMeasured:
    """A Next came; throughput_bps: what its link carried, discovery and retries included (eq. 3.15)."""

    throughput_bps: float


@dataclass(frozen=True, slots=True)
class NextMissed:
    """A Next that was due has not come; it counts as a throughput of 0 (thesis 3.5)."""


TeamEvent: TypeAlias = BecameLeader | BecameFollower | NextMeasured | NextMissed
