"""Small truths for the radio's tests: robots on a line or anywhere, and what they send."""

from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import (
    Corruption,
    Cut,
    Jam,
    Presence,
    Transmission,
    TransmitRequest,
    Truth,
    Verdict,
)
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.radio import Radio

PERIOD = 50_000_000
"""A tick of the default clock [ns]."""

Places = dict[int, tuple[float, float]]
Outboxes = dict[int, tuple[Transmission, ...]]


def line(robots: int, spacing: float) -> Places:
    """Robots 1..n on the x axis [m]."""
    return {i: (spacing * (i - 1), 0.0) for i in range(1, robots + 1)}


def message(
    destination: int, msdu_bytes: int = 800, payload: bytes = b"next", lifetime_ns: int = 0
) -> Transmission:
    return Transmission(destination, payload, msdu_bytes, lifetime_ns)


class Mission:
    """A radio and the truths that it is fed; robots stand where `places` says at each tick."""

    def __init__(self, places: Places, section: RadioSection, seed: int = 1) -> None:
        self.places = dict(places)
        self.incarnations = dict.fromkeys(places, 0)
        self.speeds = dict.fromkeys(places, 0.0)
        self.remaining = dict.fromkeys(places, 0.0)
        self.cuts: tuple[Cut, ...] = ()
        self.jams: tuple[Jam, ...] = ()
        self.corruptions: tuple[Corruption, ...] = ()
        self.stopped: tuple[int, ...] = ()
        self.radio = Radio(RadioBriefing(seed, PERIOD, tuple(sorted(places)), section, ()))
        self.tick = 0
        self.verdicts: list[Verdict] = []
        self.control_bytes: dict[str, int] = {}
        self.step()

    def truth(self, outboxes: Outboxes) -> Truth:
        robots = sorted(self.places)
        return Truth(
            tick=self.tick,
            time_ns=self.tick * PERIOD,
            present=tuple(
                Presence(i, self.incarnations[i], Pose(*self.places[i], 0.0), Twist(0.0, 0.0), False)
                for i in robots
            ),
            transmit_requests=tuple(
                TransmitRequest(i, self.speeds[i], self.remaining[i], outboxes.get(i, ()))
                for i in robots
            )
            if self.tick
            else (),
            cuts=self.cuts,
            jams=self.jams,
            contacts=(),
            departures=(),
            stopped=self.stopped,
            corruptions=self.corruptions,
        )

    def step(self, outboxes: Outboxes | None = None) -> tuple[Verdict, ...]:
        """One tick: the outboxes are handed over at its start; its verdicts."""
        carriage = self.radio.carry(self.truth(outboxes or {}))
        assert sorted(carriage.inboxes) == sorted(set(self.places).difference(self.stopped))
        self.inboxes = carriage.inboxes
        self.control_bytes = carriage.record.control_bytes
        self.verdicts += carriage.record.verdicts
        self.tick += 1
        return carriage.record.verdicts

    def run(self, ticks: int, outboxes: Outboxes | None = None) -> list[Verdict]:
        """The outboxes once, then so many ticks in all; what was settled in them."""
        settled = list(self.step(outboxes))
        for _ in range(ticks - 1):
            settled += self.step()
        return settled
