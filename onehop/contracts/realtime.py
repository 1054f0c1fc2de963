"""What world, radio and robots tell each other in real time, where nobody waits for anybody.

Each is the content of one bus key (topics.py); what they tell each other in lock-step is in messages.py.
"""

from onehop.contracts.messages import Reception, TransmitRequest, Truth
from onehop.contracts.neighbour import Neighbour
from onehop.contracts.values import Wire


class Heard(Wire, frozen=True, omit_defaults=True):
    """In real time: the radio to a robot, when it is due (key heard).

    number: of this message to this robot, from 1, through all its incarnations. One reception, or a
    report of its card's neighbours.
    """

    number: int
    reception: Reception | None = None
    neighbours: tuple[Neighbour, ...] = ()


class Acted(Wire, frozen=True):
    """In real time: a robot's answer to an observation (key acted). action: an Action, as logged.

    number: of this answer, from 1 in each incarnation: one that is missing has changed its state. heard:
    numbers of what it has taken in from the radio since the last one.
    """

    number: int
    heard: tuple[int, ...]
    action: bytes


class Placed(Wire, frozen=True):
    """In real time: world to radio, a Truth. sent_ns: the world's simulated clock when it was sent [ns].

    anchor: how often that clock has been set back, since the world was too late.
    """

    sent_ns: int
    anchor: int
    truth: Truth


class Handed(Wire, frozen=True):
    """In real time: world to radio, what a robot hands to its NIC, at once. sent_ns: as in Placed."""

    sent_ns: int
    request: TransmitRequest


class Lateness(Wire, frozen=True):
    """In real time: this tick began late (key late). late_ns: on the wall clock [ns]."""

    tick: int
    time_ns: int
    late_ns: int
