"""What a mission of chaos is asked for besides the invariants of every log, and how bad a failure is."""

from enum import IntEnum

ARRIVAL = "arrival"
CRASH = "crash"
HANG = "hang"
SAME_BYTES = "same-bytes"

PROPERTIES: dict[str, str] = {
    ARRIVAL: "after the faults, whoever is whole reaches a goal that can be reached",
    CRASH: "no program fails, whatever happens to it",
    HANG: "a mission ends",
    SAME_BYTES: "the same mission leaves the same bytes, run again or as processes",
}
"""Beyond the invariants (onehop/checking); some of those ask for progress, too."""

LIVENESS = frozenset(("one-leader", "one-team", "re-election", ARRIVAL))
"""What must happen in the end; everything else must never happen."""


class Kind(IntEnum):
    """Kinds of failures; the exit status of a campaign is that of the worst."""

    SAFETY = 1
    LIVENESS = 3
    CRASH = 4
    NONDETERMINISM = 5


def kind_of(name: str) -> Kind:
    """Which kind a broken property is."""
    if name == SAME_BYTES:
        return Kind.NONDETERMINISM
    if name in (CRASH, HANG):
        return Kind.CRASH
    return Kind.LIVENESS if name in LIVENESS else Kind.SAFETY
