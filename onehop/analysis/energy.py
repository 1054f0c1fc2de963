"""What a mission costs in energy: driving by a measured robot, the radio by measured cards.

Nothing in a mission depends on it: it is computed from ground truth and from what became of messages.

Driving, of a Pioneer 3-DX (Mei, Lu, Hu and Lee, "Deployment of mobile robots with energy and timing
constraints", IEEE Transactions on Robotics 22(3), 2006): 0.29 W and 7.4 W for each m/s, here of the mean
of both wheels' speeds, so that turning on the spot costs too; and to go faster costs the kinetic energy
that the robot gains, which braking does not give back. Differs: the line was measured below 0.9 m/s.

The card, of Lucent's IEEE 802.11 WaveLAN at 2 Mb/s (L. M. Feeney and M. Nilsson, "Investigating the
energy consumption of a wireless network interface in an ad hoc networking environment", INFOCOM 2001,
thesis ref. 43): an idle power, and on top of it m * size + b for each frame that is sent, received or
heard and discarded. b holds RTS, CTS, ACK and the wait for the medium. Differs: m is the time of a byte
on the air times the power above idling, so it is that of 2 Mb/s times 2 / rate.

Left out: routing packets, whose senders a log does not name, and the routes in MRSR's headers. An
attempt that fails counts as whole, though some fail with the RTS.
"""

import math
from typing import NamedTuple

from onehop.contracts.ideal_link import BASIC_RATE_MBPS
from onehop.contracts.messages import BROADCAST, Presence, RadioRecord, Truth, Verdict
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.link_budget import link_budget

STANDING_W = 0.29
DRIVING_W_PER_M_S = 7.4
"""Power of the motors at rest [W], and more for each m/s of speed (Mei et al. 2006)."""

MASS_KG = 9.0
TRACK_M = 0.33
"""Mass of the robot, and distance between its wheels (Pioneer 3-DX data sheet)."""

IDLE_W = 0.843
"""Power of the card that waits in ad hoc mode [W]."""

MEASURED_MBPS = 2.0
"""Rate at which the costs below were measured [Mb/s]."""


class FrameCost(NamedTuple):
    """What a frame costs a card above idling: per byte, and once [uJ]."""

    per_byte_uj: float
    once_uj: float

    def joules(self, msdu_bytes: int, rate_mbps: float) -> float:
        """Of one frame with so many bytes of payload at a rate [J]."""
        stretch = MEASURED_MBPS / rate_mbps
        return 1e-6 * (self.per_byte_uj * msdu_bytes * stretch + self.once_uj)


SEND = FrameCost(1.9, 454.0)
RECEIVE = FrameCost(0.50, 356.0)
SEND_BROADCAST = FrameCost(1.9, 266.0)
RECEIVE_BROADCAST = FrameCost(0.50, 56.0)
DISCARD = FrameCost(-0.61, 70.0)
"""Costs of a frame. A card that hears a frame for others between two others idles at lower power."""


def driving_w(v: float, w: float) -> float:
    """Power of the motors at a speed [m/s] and a turn rate [rad/s] [W]."""
    half = w * TRACK_M / 2.0
    return STANDING_W + DRIVING_W_PER_M_S * (abs(v - half) + abs(v + half)) / 2.0


def gained_j(before: float, after: float) -> float:
    """Kinetic energy that going from one speed to another takes [J]; slowing down gives nothing back."""
    return max(0.0, MASS_KG * (after * after - before * before) / 2.0)


class Spent(NamedTuple):
    """What a robot spends in a tick [J]."""

    drive_j: float
    radio_j: float


class EnergyMeter:
    """Follows a mission tick by tick. A robot that was not present in the tick before stood still."""

    def __init__(self, radio: RadioSection, period_s: float) -> None:
        self._rate_mbps = radio.rate_mbps
        self._period_s = period_s
        self._square = _hearing_distance(radio) ** 2
        self._speeds: dict[int, float] = {}

    def take(self, truth: Truth, record: RadioRecord) -> dict[int, Spent]:
        """What each present robot spends in one more tick."""
        card = self._frames(truth.present, record) if record.verdicts else {}
        spent, speeds = {}, {}
        for one in truth.present:
            robot, v = one.robot, one.twist.v
            speeds[robot] = v
            drive_j = driving_w(v, one.twist.w) * self._period_s
            before = self._speeds.get(robot, 0.0)
            if v != before:
                drive_j += gained_j(before, v)
            spent[robot] = Spent(drive_j, IDLE_W * self._period_s + card.get(robot, 0.0))
        self._speeds = speeds
        return spent

    def _frames(self, present: tuple[Presence, ...], record: RadioRecord) -> dict[int, float]:
        """What the frames of a tick cost each card [J]."""
        places = {one.robot: (one.pose.x, one.pose.y) for one in present}
        card = dict.fromkeys(places, 0.0)
        broadcast: set[tuple[int, int]] = set()
        for verdict in record.verdicts:
            if verdict.destination == BROADCAST:
                self._broadcast(card, verdict, broadcast)
            else:
                self._unicast(card, verdict, places)
        return card

    def _broadcast(self, card: dict[int, float], verdict: Verdict, known: set[tuple[int, int]]) -> None:
        """A broadcast has a verdict for each robot, and is sent once."""
        size, source = verdict.msdu_bytes, verdict.source
        if verdict.attempts and (source, verdict.message) not in known:
            known.add((source, verdict.message))
            _add(card, source, SEND_BROADCAST.joules(size, BASIC_RATE_MBPS))
        if verdict.arrival_ns >= 0:
            _add(card, verdict.receiver, RECEIVE_BROADCAST.joules(size, BASIC_RATE_MBPS))

    def _unicast(
        self, card: dict[int, float], verdict: Verdict, places: dict[int, tuple[float, float]]
    ) -> None:
        size, rate_mbps = verdict.msdu_bytes, self._rate_mbps
        send_j, receive_j = SEND.joules(size, rate_mbps), RECEIVE.joules(size, rate_mbps)
        discard_j = DISCARD.joules(size, rate_mbps)
        receivers = (*verdict.path[1:], None)
        for sender, receiver, attempts in zip(verdict.path, receivers, verdict.attempts, strict=False):
            _add(card, sender, attempts * send_j)
            if receiver is not None:
                _add(card, receiver, receive_j)
            if sender not in places:
                continue
            x, y = places[sender]
            for robot, (there_x, there_y) in places.items():
                apart = (there_x - x) * (there_x - x) + (there_y - y) * (there_y - y)
                if robot not in (sender, receiver) and apart <= self._square:
                    card[robot] += attempts * discard_j


def _add(card: dict[int, float], robot: int, joules: float) -> None:
    """A robot that is not present any more spends nothing."""
    if robot in card:
        card[robot] += joules


def _hearing_distance(radio: RadioSection) -> float:
    """Distance within which a frame is heard on the mean, walls and places aside [m]."""
    if radio.link != "modelled":
        return math.inf if radio.link == "perfect" else 0.0
    budget = link_budget(radio)
    margin_db = budget.snr_reference_db - budget.receive_threshold_db
    return budget.reference_distance * math.pow(10.0, max(margin_db, 0.0) / (10.0 * budget.exponent))
