"""What crosses the boundaries between world, radio and robots. Frozen values, no behaviour.

Each is the content of one bus key (topics.py) except Percept and Carriage, which the drivers put
together and take apart. Payloads between robots stay opaque bytes here: only robot_agent knows them.
"""

from enum import StrEnum
from typing import TypeAlias

from onehop.contracts.arrays import Ranges
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.neighbour import Neighbour
from onehop.contracts.team import Status
from onehop.contracts.units import NANOSECONDS
from onehop.contracts.values import Value, Wire

BROADCAST = 0
"""Destination of a frame for everyone in range (robot ids start at 1)."""

NoteValue: TypeAlias = int | float | str | tuple[int, ...]


class Observation(Wire, frozen=True):
    """What the world tells robot i at tick k (key obs/<i>).

    incarnation: 0 for the first process of this robot, one more for each restart.
    scan: (n_beams,) float32 [m], first beam to the right, last to the left, counter-clockwise;
        +inf where nothing is in range (REP 117).
    """

    tick: int
    time_ns: int
    incarnation: int
    pose: Pose
    twist: Twist
    scan: Ranges


class Reception(Value, frozen=True):
    """One message that the radio delivered.

    source: robot that sent it. service_start_ns: instant at which the source's link layer began to
    serve it. arrival_ns: instant of its last bit here. hops, attempts: over the whole path.
    snr_db, bit_error_rate: of the last hop. msdu_bytes: size on the air that was paid for.
    throughput_bps: of these bytes over all of their way, repetitions and route discovery included
    (thesis eq. 3.15) [bit/s].
    """

    source: int
    payload: bytes
    service_start_ns: int
    arrival_ns: int
    hops: int
    attempts: int
    snr_db: float
    bit_error_rate: float
    msdu_bytes: int

    @property
    def throughput_bps(self) -> float:
        duration_ns = max(1, self.arrival_ns - self.service_start_ns)
        return 8.0 * self.msdu_bytes * NANOSECONDS / duration_ns


class Inbox(Wire, frozen=True, omit_defaults=True):
    """What the radio delivered to one robot in the tick that ends at time_ns (key rx/<i>).

    neighbours: whom its card heard, by id; where there are none the key is left out on the wire.
    In real time: what a robot took in for the action that lies beside it, which answers the observation
    of `tick`. heard: numbers of the messages `Heard` that it is made of; left out in lock-step.
    """

    tick: int
    time_ns: int
    receptions: tuple[Reception, ...]
    neighbours: tuple[Neighbour, ...] = ()
    heard: tuple[int, ...] = ()


class Percept(Value, frozen=True):
    """Everything that a robot can know at a tick."""

    tick: int
    time_ns: int
    pose: Pose
    twist: Twist
    scan: Ranges
    inbox: tuple[Reception, ...]
    neighbours: tuple[Neighbour, ...] = ()


def percept(seen: Observation, heard: Inbox) -> Percept:
    """What a robot knows at a tick, from the two messages that it got for it."""
    return Percept(
        seen.tick, seen.time_ns, seen.pose, seen.twist, seen.scan, heard.receptions, heard.neighbours
    )


class Transmission(Value, frozen=True):
    """One message handed to the NIC; destination is a robot id or BROADCAST.

    msdu_bytes: size that it takes on the air [B], at least len(payload). lifetime_ns: how long after it
    is handed over it is of use, 0 for as long as the radio's own limit allows; an older one is dropped
    where it waits (as with aMaxTransmitMSDULifetime of 802.11-1999, 9.4).
    """

    destination: int
    payload: bytes
    msdu_bytes: int
    lifetime_ns: int


class Note(Value, frozen=True):
    """A structured event for people: kind in snake_case, data sorted by key."""

    kind: str
    data: dict[str, NoteValue]


class Action(Wire, frozen=True, omit_defaults=True):
    """Everything that robot i does at tick k (key out/<i>).

    speed [m/s], remaining_distance [m]: what the NIC may know (routing, thesis eq. p_r).
    status: what it says of its team; None from a program that has none. values: numbers by name that
    it shows; where there are none the key is left out on the wire.
    """

    tick: int
    incarnation: int
    twist: Twist
    outbox: tuple[Transmission, ...]
    speed: float
    remaining_distance: float
    status: Status | None
    notes: tuple[Note, ...]
    values: dict[str, float] = {}  # noqa: RUF012 - a struct copies its defaults


class Presence(Value, frozen=True):
    """Ground truth of one present robot."""

    robot: int
    incarnation: int
    pose: Pose
    twist: Twist
    held: bool


class TransmitRequest(Value, frozen=True):
    """What one present robot handed to its NIC in the last tick."""

    robot: int
    speed: float
    remaining_distance: float
    outbox: tuple[Transmission, ...]


class Departure(Value, frozen=True):
    """A robot that left the mission at this tick, and why."""

    robot: int
    why: str


class Contact(Value, frozen=True):
    """A robot that touched something in the last tick; other is a robot id, or 0 for an obstacle."""

    robot: int
    other: int
    x: float
    y: float


class Cut(Value, frozen=True):
    """No frame passes from a robot of side_a to one of side_b, nor back unless it is one_way."""

    side_a: tuple[int, ...]
    side_b: tuple[int, ...]
    one_way: bool = False

    def parts(self, sender: int, receiver: int) -> bool:
        """Whether no frame of the one reaches the other."""
        if sender in self.side_a and receiver in self.side_b:
            return True
        return not self.one_way and sender in self.side_b and receiver in self.side_a


class Jam(Value, frozen=True):
    """Extra noise at receivers inside a disc: centre and radius [m], power at the receiver [dBm]."""

    x: float
    y: float
    radius: float
    noise_dbm: float


class Slow(Value, frozen=True):
    """A robot whose actions take effect late: that of tick k at tick k + delay_ticks."""

    robot: int
    delay_ticks: int


class Corruption(Value, frozen=True):
    """Payloads that these robots receive are altered with this probability, each by itself."""

    robots: tuple[int, ...]
    probability: float


class Truth(Wire, frozen=True):
    """Ground truth of tick k (key truth): who is where, what is broken, what was offered to the air.

    Everything the radio needs for the interval that ends at time_ns is in here, so that radio and
    world can never disagree about who was present. Tuples are sorted by robot id.
    faults: those that begin with this tick, by script or by hand, in the order in which they were
    carried out. stopped: present robots whose processes are stopped: without observation, inbox and
    action. blind: robots whose lasers see nothing. slow, corruptions: in force, as are cuts and jams.
    """

    tick: int
    time_ns: int
    present: tuple[Presence, ...]
    transmit_requests: tuple[TransmitRequest, ...]
    cuts: tuple[Cut, ...]
    jams: tuple[Jam, ...]
    contacts: tuple[Contact, ...]
    departures: tuple[Departure, ...]
    faults: tuple[FaultSection, ...] = ()
    stopped: tuple[int, ...] = ()
    blind: tuple[int, ...] = ()
    slow: tuple[Slow, ...] = ()
    corruptions: tuple[Corruption, ...] = ()


def running(truth: Truth) -> list[Presence]:
    """The robots that have an observation, an inbox and an action at this tick."""
    if not truth.stopped:
        return list(truth.present)
    return [one for one in truth.present if one.robot not in truth.stopped]


class DeliveryStatus(StrEnum):
    """What became of a data message; of a lost one, why its last attempt on its last hop failed.

    BELOW_THRESHOLD: too weak at the receiver (distance, wall, cut, jam), also without other frames.
    COLLISION: would have been received, had no other frame overlapped its preamble or its bits.
    RECEIVER_BUSY: strong enough, but its receiver was locked on another frame or transmitted itself; or
    it was an RTS, and its receiver had to stay silent, because others had reserved the medium.
    CORRUPTED: it arrived, with other bytes than were sent, and is of no use to its receiver.
    NO_ROUTE, QUEUE_FULL: at the robot that held it, or in the NIC of a receiver that is stopped.
    EXPIRED: it waited there, for a route or for the medium, until it was of no use any more.
    RECEIVER_GONE: its destination is not in the mission any more, or came back as another process,
    whatever else failed. RELAY_GONE: the same of a robot on its way, which held it or was to take it
    next; SENDER_GONE: of its source, which still held it.
    """

    DELIVERED = "delivered"
    CORRUPTED = "corrupted"
    BELOW_THRESHOLD = "below threshold"
    BIT_ERRORS = "bit errors"
    COLLISION = "collision"
    RECEIVER_BUSY = "receiver busy"
    NO_ROUTE = "no route"
    QUEUE_FULL = "queue full"
    EXPIRED = "expired"
    RECEIVER_GONE = "receiver gone"
    RELAY_GONE = "relay gone"
    SENDER_GONE = "sender gone"


class Verdict(Value, frozen=True):
    """What the radio did with one data message, said once, in the tick in which it was settled.

    message: sequence number, unique per source. receiver: who got it or should have (a broadcast has
    one verdict for each robot present). path: source to last holder, both included.
    attempts: of each hop of the path. Times in ns: offered by the robot, service begun by its link
    layer, arrival (-1 when it never came). discovery_ns, queueing_ns: parts of the delay.
    snr_db, bit_error_rate: of the last attempt of the last hop.
    """

    message: int
    source: int
    destination: int
    receiver: int
    status: DeliveryStatus
    msdu_bytes: int
    path: tuple[int, ...]
    attempts: tuple[int, ...]
    offered_ns: int
    service_start_ns: int
    arrival_ns: int
    discovery_ns: int
    queueing_ns: int
    snr_db: float
    bit_error_rate: float


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


class RadioRecord(Wire, frozen=True, omit_defaults=True):
    """What happened on the air in the tick that ends at time_ns (key record).

    control_bytes: routing bytes sent since the start of the mission, by kind ("rreq", "rrep", "rerr",
        and "source_route" for what MRSR adds to data).
    intake: in real time alone. The record then is of what follows the truth of its tick, not of what
        came before it.
    """

    tick: int
    time_ns: int
    verdicts: tuple[Verdict, ...]
    control_bytes: dict[str, int]
    intake: Intake | None = None


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


class Carriage(Value, frozen=True):
    """What `Radio.carry` returns: inboxes of every present robot, and the record of the tick."""

    inboxes: dict[int, Inbox]
    record: RadioRecord


class Lost(Value, frozen=True):
    """A robot that did not arrive with the team."""

    robot: int
    at_s: float
    why: str


class LeadershipTerm(Value, frozen=True):
    """A roster from the moment a robot began to act as its leader."""

    at_s: float
    leader: int
    epoch: int
    members: tuple[int, ...]
    shape: str


class Outcome(Value, frozen=True):
    """How a mission ended (key end): "arrived", "failed" or "aborted", and why."""

    outcome: str
    reason: str
    arrived: tuple[int, ...]
    lost: tuple[Lost, ...]
    leaders: tuple[LeadershipTerm, ...]
    ticks: int
    sim_s: float
    collisions: int
