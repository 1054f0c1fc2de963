"""What is simulated on both sides: places, who hears whom, rates, traffic. Standard library only.

Mean SNR is the thesis's, 60 dB - 20 log10(d / 1 m), nearer than 1 m as at 1 m; a receiver needs 32 dB.
"""

import math
import random
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from fnmatch import fnmatch
from typing import Any

Place = tuple[float, float]

MSDU_BYTES = 800
TICK_S = 0.05
"""Messages are handed over at ticks of Onehop's clock [s]."""
AUDIBLE = 25.0
"""Distance that a frame surely gets over without fading [m]; 25.12 m is the edge."""
NEVER_RTS = 2304


@dataclass(frozen=True)
class Run:
    """One simulation. places [m]; silent: pairs between which there is no path at all.

    Frames: paths of flows, station by station; saturated, or an MSDU every period_s.
    Messages over a routing protocol instead ("aodv", "aodv with hellos", "dsr"): (time [s], source,
    destination), and which station moves out of everybody's reach when, (station, time [s]).
    A preamble is detected if its signal is receive_threshold_db over the noise, and preamble_sinr_db
    over the noise and all other signals together.
    """

    seed: int
    seconds: float
    places: tuple[Place, ...]
    paths: tuple[tuple[int, ...], ...] = ()
    period_s: float = 0.0
    protocol: str = ""
    messages: tuple[tuple[float, int, int], ...] = ()
    leaves: tuple[tuple[int, float], ...] = ()
    silent: tuple[tuple[int, int], ...] = ()
    rate_mbps: float = 1.0
    rts_threshold_bytes: int = 0
    fading_db: float = 0.0
    carrier_sense_db: float = 10.0
    receive_threshold_db: float = 32.0
    preamble_sinr_db: float = 32.0
    reach_db: float = -10.0
    msdu_bytes: int = MSDU_BYTES

    def snr_db(self) -> list[list[float | None]]:
        """Mean SNR of every pair [dB], None without a path."""
        apart = {frozenset(pair) for pair in self.silent}
        return [
            [
                None
                if frozenset((i, j)) in apart
                else 60.0 - 20.0 * math.log10(max(1.0, math.dist(a, b)))
                for j, b in enumerate(self.places)
            ]
            for i, a in enumerate(self.places)
        ]

    def as_json(self) -> dict[str, Any]:
        """What the ns-3 side is told."""
        return {**asdict(self), "snr_db": self.snr_db()}


@dataclass(frozen=True)
class Case:
    """One row of a table. of: the simulation for a seed; names are group/what."""

    name: str
    of: Callable[[int], Run]

    @property
    def group(self) -> str:
        return self.name.partition("/")[0]


ACCESS = (("RTS/CTS", 0), ("basic", NEVER_RTS))
FAINT = ", preambles from 4 dB on"
"""Of cases in which a preamble is detected from an SINR of 4 dB on, ns-3's default, not 32 dB."""


def _flows(name: str, **settings: Any) -> Case:
    return Case(name, lambda seed: Run(seed=seed, **settings))


def links() -> Iterator[Case]:
    """One saturated sender over distance, with log-normal fading of 4 dB a frame and without."""
    slow = {5: 20, 8: 20, 10: 40, 12: 40, 15: 60, 20: 80, 25: 200, 30: 400}
    fast = {5: 10, 8: 10, 10: 10, 12: 15, 15: 20, 20: 40}
    for rate, seconds in ((1.0, slow), (11.0, fast)):
        for d, simulated in seconds.items():
            yield _flows(
                f"link/{rate:g} Mb/s, RTS/CTS, 4 dB, {d} m",
                seconds=float(simulated),
                places=((0.0, 0.0), (float(d), 0.0)),
                paths=((0, 1),),
                rate_mbps=rate,
                fading_db=4.0,
            )
    for d in (1.0, 20.0, 25.1, 25.2):
        yield _flows(
            f"link/1 Mb/s, RTS/CTS, no fading, {d:g} m",
            seconds=10.0,
            places=((0.0, 0.0), (d, 0.0)),
            paths=((0, 1),),
        )


def cells() -> Iterator[Case]:
    """Saturated stations in one place, each sending to the next."""
    for rate in (1.0, 11.0):
        for access, threshold in ACCESS:
            for n in (2, 5, 10, 20, 50):
                yield _flows(
                    f"cell/{n} stations, {rate:g} Mb/s, {access}",
                    seconds=10.0 if rate == 1.0 else 5.0,
                    places=((0.0, 0.0),) * n,
                    paths=tuple((i, (i + 1) % n) for i in range(n)),
                    rate_mbps=rate,
                    rts_threshold_bytes=threshold,
                )


def hidden() -> Iterator[Case]:
    """Two senders that do not hear each other at all, one receiver between them."""
    for what, left, right in (
        ("equal, 10 and 10 m", 10.0, 10.0),
        ("near and far, 5 and 10 m", 5.0, 10.0),
    ):
        for rate in (1.0, 11.0):
            for access, threshold in ACCESS:
                yield _flows(
                    f"hidden/{what}, {rate:g} Mb/s, {access}",
                    seconds=80.0 if rate == 1.0 else 20.0,
                    places=((-left, 0.0), (0.0, 0.0), (right, 0.0)),
                    paths=((0, 1), (2, 1)),
                    silent=((0, 2),),
                    rate_mbps=rate,
                    rts_threshold_bytes=threshold,
                )
        for access, threshold in ACCESS:
            yield _flows(
                f"hidden/{what}, 1 Mb/s, {access}{FAINT}",
                seconds=80.0,
                places=((-left, 0.0), (0.0, 0.0), (right, 0.0)),
                paths=((0, 1), (2, 1)),
                silent=((0, 2),),
                rts_threshold_bytes=threshold,
                preamble_sinr_db=4.0,
            )


def exposed() -> Iterator[Case]:
    """Two senders that sense each other; their receivers hear only their own."""
    for access, threshold in ACCESS:
        yield _flows(
            f"exposed/1 Mb/s, {access}",
            seconds=20.0,
            places=((0.0, 0.0), (10.0, 0.0), (30.0, 0.0), (40.0, 0.0)),
            paths=((1, 0), (2, 3)),
            silent=((0, 2), (0, 3), (1, 3)),
            rts_threshold_bytes=threshold,
        )


def chains() -> Iterator[Case]:
    """A saturated source and relays by static routes, 20 m a hop.

    Hidden: carrier sense from 26 dB on, so two hops (28 dB) are sensed but not received and three
    (24 dB) only add noise. Otherwise every station senses every other one.
    """
    for what, sense_db in (("hidden", 26.0), ("all sense", 10.0)):
        for hops in (3, 4, 5):
            for access, threshold in ACCESS:
                yield _flows(
                    f"chain/{hops} hops, {what}, {access}",
                    seconds=80.0 if what == "hidden" else 20.0,
                    places=tuple((20.0 * i, 0.0) for i in range(hops + 1)),
                    paths=(tuple(range(hops + 1)),),
                    carrier_sense_db=sense_db,
                    rts_threshold_bytes=threshold,
                )


def chains_that_lock_early() -> Iterator[Case]:
    """The hidden chain of 4 hops once more: preambles are detected among other frames from 4 dB on."""
    for access, threshold in ACCESS:
        yield _flows(
            f"chain/4 hops, hidden, {access}{FAINT}",
            seconds=80.0,
            places=tuple((20.0 * i, 0.0) for i in range(5)),
            paths=((0, 1, 2, 3, 4),),
            carrier_sense_db=26.0,
            rts_threshold_bytes=threshold,
            preamble_sinr_db=4.0,
        )


def reuse() -> Iterator[Case]:
    """Two parallel links of 10 m over their separation; carrier sense reaches 316 m."""
    for separation in (50.0, 300.0, 330.0, 500.0, 1000.0):
        for access, threshold in ACCESS:
            yield _flows(
                f"reuse/{separation:g} m apart, {access}",
                seconds=20.0,
                places=((0.0, 0.0), (10.0, 0.0), (0.0, separation), (10.0, separation)),
                paths=((0, 1), (2, 3)),
                rts_threshold_bytes=threshold,
            )


AODV = ("AODV / MRDV", "aodv")
AODV_WITH_HELLOS = ("AODV with hellos / MRDV", "aodv with hellos")
DSR = ("DSR / MRSR", "dsr")


def _periodic(
    count: int, period_s: float, start_s: float, source: int, destination: int
) -> Iterator[Any]:
    return ((round(start_s + k * period_s, 9), source, destination) for k in range(count))


def route_chains() -> Iterator[Case]:
    """One message every 250 ms over a chain: discovery, then so many milliseconds a hop."""
    for both, protocol in (AODV, DSR):
        for hops in (2, 3, 4):
            yield _flows(
                f"route/{hops} hops, {both}",
                seconds=20.0,
                places=tuple((20.0 * i, 0.0) for i in range(hops + 1)),
                protocol=protocol,
                messages=tuple(_periodic(72, 0.25, 1.0, 0, hops)),
            )


def repairs() -> Iterator[Case]:
    """A ladder; at 10 s the station beside the source leaves, and the way goes over the other side."""
    for both, protocol in (AODV_WITH_HELLOS, DSR):
        for hops in (2, 3, 4):
            near = tuple((20.0 * i, 0.0) for i in range(hops + 1))
            far = tuple((20.0 * i, 20.0) for i in range(hops + 1))
            yield _flows(
                f"repair/{hops} hops, {both}",
                seconds=30.0,
                places=near + far,
                protocol=protocol,
                messages=tuple(_periodic(104, 0.25, 1.0, 0, hops)),
                leaves=((1, 10.0),),
            )


def scattered(seed: int, stations: int = 10, side: float = 80.0) -> tuple[Place, ...]:
    """Random places in a square [m] that are connected by links of AUDIBLE: the first such draw."""
    dice = random.Random(seed)
    while True:
        places = tuple((dice.uniform(0.0, side), dice.uniform(0.0, side)) for _ in range(stations))
        reached, edge = {0}, [0]
        while edge:
            here = edge.pop()
            near = {
                j
                for j in range(stations)
                if j not in reached and math.dist(places[here], places[j]) <= AUDIBLE
            }
            reached |= near
            edge += near
        if len(reached) == stations:
            return places


def topologies() -> Iterator[Case]:
    """Ten static stations anywhere, four flows of two messages a second; the seed is the topology."""
    flows = ((0, 9), (1, 8), (2, 7), (3, 6))
    messages = sorted(
        message
        for k, (source, destination) in enumerate(flows)
        for message in _periodic(110, 0.5, 1.0 + 2 * TICK_S * k, source, destination)
    )
    for fading_db in (0.0, 4.0):
        for both, protocol in (AODV, AODV_WITH_HELLOS, DSR):

            def of(seed: int, fading_db: float = fading_db, protocol: str = protocol) -> Run:
                return Run(
                    seed=seed,
                    seconds=60.0,
                    places=scattered(seed),
                    protocol=protocol,
                    messages=tuple(messages),
                    fading_db=fading_db,
                )

            what = f"{fading_db:g} dB a frame" if fading_db else "no fading"
            yield Case(f"random/{what}, {both}", of)


def every_case() -> list[Case]:
    """All rows in the order of the tables."""
    groups = (
        *(links, cells, hidden, exposed, chains, chains_that_lock_early, reuse),
        *(route_chains, repairs, topologies),
    )
    return [case for group in groups for case in group()]


def chosen(patterns: list[str]) -> list[Case]:
    """The cases whose name one of the shell patterns matches; all without any pattern."""
    cases = every_case()
    return [c for c in cases if not patterns or any(fnmatch(c.name, p) for p in patterns)]
