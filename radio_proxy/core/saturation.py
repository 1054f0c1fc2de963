"""Saturated stations on the DCF that carries the missions: what theory is compared with."""

import math
from dataclasses import dataclass, replace

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Presence
from onehop.contracts.randomness import generator
from radio_proxy.core.addresses import RobotId, StationIndex
from radio_proxy.core.airtime import Timing
from radio_proxy.core.contention import Frame
from radio_proxy.core.dcf import Dcf
from radio_proxy.core.draws import Draws
from radio_proxy.core.emission import Emission
from radio_proxy.core.link_budget import LinkBudget
from radio_proxy.core.link_rules import LinkRules
from radio_proxy.core.medium import Medium
from radio_proxy.core.propagation import Propagation

SECOND = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Load:
    """Who always has a message: the first stations; receivers: of each of them. places [m]."""

    places: tuple[tuple[float, float], ...]
    receivers: tuple[StationIndex, ...]
    msdu_bytes: int
    rts_cts: bool


@dataclass(slots=True)
class Tally:
    """What came of it. delay: sum over delivered messages from service to arrival [ns]."""

    delivered: list[int]
    offered: int = 0
    given_up: int = 0
    delay: int = 0


def ring(stations: int, msdu_bytes: int, rts_cts: bool) -> Load:
    """One cell: each sends to the next; one alone sends to a second that is silent."""
    count = max(stations, 2)
    receivers = tuple(StationIndex((i + 1) % count) for i in range(stations))
    return Load(((0.0, 0.0),) * count, receivers, msdu_bytes, rts_cts)


def pair(distance: float, msdu_bytes: int, rts_cts: bool) -> Load:
    """One sender and one receiver at a distance [m]."""
    return Load(((0.0, 0.0), (distance, 0.0)), (StationIndex(1),), msdu_bytes, rts_cts)


class Saturation:
    """Refills every sender's queue the moment that it is empty; counts arrivals."""

    def __init__(
        self,
        load: Load,
        timing: Timing,
        budget: LinkBudget,
        seed: int,
        rules: LinkRules,
        take_shortcuts: bool = True,
    ) -> None:
        robots = tuple(RobotId(i) for i in range(1, len(load.places) + 1))
        propagation = Propagation(budget, robots, ())
        still = Twist(0.0, 0.0)
        presences = [
            Presence(r, 0, Pose(*p, 0.0), still, False) for r, p in zip(robots, load.places, strict=True)
        ]
        propagation.update(tuple(presences), (), ())
        draws = Draws(generator(seed, "radio"))
        self._load = load
        self.tally = Tally([0] * len(load.receivers))
        rules = replace(rules, rts_threshold_bytes=0 if load.rts_cts else load.msdu_bytes)
        medium = Medium(propagation, draws, rules)
        self._dcf = Dcf(len(robots), timing, medium, draws, self, rules, take_shortcuts)
        for sender in range(len(load.receivers)):
            self._refill(StationIndex(sender), 0)

    def run(self, seconds: float) -> Tally:
        """The tally after so much simulated time."""
        self._dcf.events.run(math.floor(seconds * SECOND))
        return self.tally

    def _refill(self, sender: StationIndex, now: int) -> None:
        frame = Frame(self._load.receivers[sender], self._load.msdu_bytes, None)
        self._dcf.enqueue(sender, frame, now, force_backoff=True)

    def on_expired(self, sender: StationIndex, frame: Frame, now: int) -> None:
        """Frames that are always there do not expire."""

    def on_service(self, sender: StationIndex, frame: Frame, now: int) -> None:  # noqa: ARG002
        self.tally.offered += 1

    def on_data_ended(self, sender: StationIndex, frame: Frame, emission: Emission, now: int) -> None:
        """Nobody listens to what others send."""

    def on_received(self, receiver: StationIndex, sender: StationIndex, frame: Frame, now: int) -> None:  # noqa: ARG002
        self.tally.delivered[sender] += 1
        self.tally.delay += now - frame.service_start

    def on_broadcast_done(
        self, sender: StationIndex, frame: Frame, emission: Emission, now: int
    ) -> None:
        """Nobody broadcasts here."""

    def on_acknowledged(self, sender: StationIndex, frame: Frame, now: int) -> None:  # noqa: ARG002
        self._refill(sender, now)

    def on_undeliverable(self, sender: StationIndex, frame: Frame, now: int) -> None:
        self.tally.given_up += not frame.received
        self._refill(sender, now)
