"""What came to the radio in real time, and when: what its record needs to be made again."""

from onehop.contracts.values import Value


class HandOver(Value, frozen=True):
    """In real time: when the NIC of a robot took over what its action of a tick hands to it [ns]."""

    robot: int
    at_ns: int


class Intake(Value, frozen=True):
    """What came to the radio in one tick of real time, and at which simulated instants [ns].

    placed_ns: from when on the truth of the tick held. handed: by robots, in order. until_ns: when the
    next truth took its place, and up to which the record goes.
    """

    placed_ns: int
    handed: tuple[HandOver, ...]
    until_ns: int
