"""Saturated stations for the tests: Bianchi's own timing, and runs of the event engine."""

import math

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Cut, DeliveryStatus, Presence
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.randomness import generator
from radio_proxy.core.addresses import StationIndex
from radio_proxy.core.airtime import Timing, dsss
from radio_proxy.core.contention import Frame
from radio_proxy.core.dcf import Dcf
from radio_proxy.core.draws import Draws
from radio_proxy.core.emission import Emission
from radio_proxy.core.fast_fading import fast_fading
from radio_proxy.core.link_budget import LinkBudget, link_budget
from radio_proxy.core.link_rules import link_rules
from radio_proxy.core.medium import Medium
from radio_proxy.core.propagation import Propagation


def threshold_probability(budget: LinkBudget, snr_db: float) -> float:
    """P(one frame reaches the receive threshold) at a mean SNR, over the fading."""
    margin = (snr_db - budget.receive_threshold_db) / budget.shadowing_db
    return 0.5 * math.erfc(-margin / math.sqrt(2.0))


def fhss(window: int, stages: int) -> Timing:
    """The frequency hopping PHY of Bianchi's paper, table II, at 1 Mb/s."""
    return Timing(
        slot=50_000,
        sifs=28_000,
        difs=128_000,
        preamble=128_000,
        rts=288_000,
        cts=240_000,
        ack=240_000,
        response_timeout=300_000,
        mac_header_bytes=34,
        rate_mbps=1.0,
        cw_min=window - 1,
        cw_max=(window << stages) - 1,
    )


class Cell:
    """Stations at given places on the event engine, whose frames are handed over at given times.

    statuses: of broadcasts, by sender and receiver; None is received.
    """

    def __init__(
        self,
        places: list[tuple[float, float]],
        section: RadioSection,
        cuts: tuple[Cut, ...] = (),
        take_shortcuts: bool = True,
    ) -> None:
        robots = tuple(range(1, len(places) + 1))
        fades = fast_fading(section, 1)
        self.propagation = Propagation(link_budget(section), robots, (), fast_fading=fades)
        still = Twist(0.0, 0.0)
        presences = [
            Presence(r, 0, Pose(x, y, 0.0), still, False)
            for r, (x, y) in zip(robots, places, strict=True)
        ]
        self.propagation.update(tuple(presences), cuts, ())
        draws = Draws(generator(1, "radio"))
        rules = link_rules(section)
        medium = Medium(self.propagation, draws, rules)
        self.dcf = Dcf(len(robots), dsss(section), medium, draws, self, rules, take_shortcuts)
        self.statuses: dict[tuple[int, int], DeliveryStatus | None] = {}
        self.arrived: list[tuple[int, int, Frame]] = []
        self.given_up: list[Frame] = []
        self.given_up_at: list[int] = []
        self.expired: list[Frame] = []

    def send_at(
        self, time_us: float, sender: int, receiver: int, msdu_bytes: int = 800, urgent: bool = False
    ) -> Frame:
        """Hand a frame over at that time."""
        frame = Frame(receiver, msdu_bytes, None, urgent)

        def hand_over(_: object, now: int) -> None:
            self.dcf.enqueue(sender, frame, now, False)

        self.dcf.events.at(round(time_us * 1000), hand_over, None)
        return frame

    def run(self, until_us: float) -> None:
        self.dcf.events.run(round(until_us * 1000))

    def on_service(self, sender: int, frame: Frame, now: int) -> None:
        """Nothing to note."""

    def on_expired(self, sender: int, frame: Frame, now: int) -> None:  # noqa: ARG002
        self.expired.append(frame)

    def on_received(self, receiver: int, sender: int, frame: Frame, now: int) -> None:  # noqa: ARG002
        self.arrived.append((now, sender, frame))

    def on_broadcast_done(self, sender: int, frame: Frame, emission: Emission, now: int) -> None:
        self.arrived.append((now, sender, frame))
        for station in range(len(emission.row)):
            if station != sender:
                cause, _ = self.dcf.medium.receivers.judgement(emission, StationIndex(station))
                self.statuses[sender, station] = cause

    def on_data_ended(self, sender: int, frame: Frame, emission: Emission, now: int) -> None:
        """Nobody listens to what others send."""

    def on_acknowledged(self, sender: int, frame: Frame, now: int) -> None:
        """Nothing to note."""

    def on_undeliverable(self, sender: int, frame: Frame, now: int) -> None:  # noqa: ARG002
        self.given_up.append(frame)
        self.given_up_at.append(now)
