"""Who could reach whom, as the radio weakens signals, and whether that holds the whole team together.

Two robots have a **link** at a moment if frames of the size of a Next get through in both directions at
the mean SNR of that moment: path loss, walls, the shadowing of both places, cuts and jams count; what is
drawn anew for each frame, fast fading and other frames do not. Get through: the SNR is at the receive
threshold or above it, and at least half of the frames have no bit error.

The **team is connected** if the links make one piece of all robots that are present, whether or not they
still belong together. The share of time for which it is, is what SCAN reports (J. Reich, V. Misra,
D. Rubenstein and G. Zussman, "Connectivity maintenance in mobile wireless networks via constrained
mobility", IEEE Journal on Selected Areas in Communications 30(5), 2012).
"""

from typing import NamedTuple

from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.messages import Truth
from radio_proxy.core.addresses import RobotId
from radio_proxy.core.bounds import PERFECT_SNR_DB
from radio_proxy.core.error_rates import CERTAIN_SINR_DB, frame_success
from radio_proxy.core.path_loss import OWN_DB, SILENT_DB
from radio_proxy.core.radio import make_propagation

EVERY_S = 0.5
"""Time from one look at the links to the next [s]: a robot moves by half a metre or so meanwhile."""

_STEP_DB = 0.01


class Pair(NamedTuple):
    """Two present robots, the lower id first. snr_db: mean over noise and jams, of the worse way."""

    robot: int
    other: int
    snr_db: float
    linked: bool


class Connectivity:
    """The links of a mission. frame_bytes: size of the frames that are to get through [B]."""

    def __init__(self, briefing: RadioBriefing, frame_bytes: int) -> None:
        robots = tuple(RobotId(robot) for robot in sorted(briefing.robots))
        self._propagation = make_propagation(briefing)
        self._station = dict(zip(robots, self._propagation.stations, strict=True))
        self._link = briefing.radio.link
        bits = 8.0 * (frame_bytes + briefing.radio.mac_header_bytes)
        error_free_db = _half_without_error_db(briefing.radio.rate_mbps, bits)
        self._least_db = max(briefing.radio.least_snr_db, error_free_db)
        self._period_ns = briefing.period_ns
        self._every = max(1, round(EVERY_S * 1e9 / briefing.period_ns))

    def is_due(self, tick: int) -> bool:
        """Whether the links are looked at in this tick."""
        return tick % self._every == 0

    def pairs(self, truth: Truth) -> list[Pair]:
        """All pairs of present robots."""
        propagation = self._propagation
        tick = truth.time_ns - self._period_ns, truth.time_ns
        propagation.update(truth.present, truth.cuts, truth.jams, tick)
        present = [RobotId(one.robot) for one in truth.present]
        found = []
        for place, robot in enumerate(present):
            here = self._station[robot]
            to_others = propagation.mean_snr_row(here)
            for other in present[place + 1 :]:
                there = self._station[other]
                out = to_others[there] - propagation.noise_rise(there)
                back = propagation.mean_snr_row(there)[here] - propagation.noise_rise(here)
                snr_db = min(out, back)
                if self._link != "modelled":
                    cut = any(
                        one.parts(a, b)
                        for one in truth.cuts
                        for a, b in ((robot, other), (other, robot))
                    )
                    perfect = self._link == "perfect" and not cut
                    snr_db = PERFECT_SNR_DB if perfect else SILENT_DB
                found.append(Pair(robot, other, snr_db, snr_db >= self._least_db))
        return found


def is_connected(robots: list[int], pairs: list[Pair]) -> bool:
    """Whether the links make one piece of these robots; of one robot or none they do."""
    if not robots:
        return True
    linked: dict[int, list[int]] = {robot: [] for robot in robots}
    for pair in pairs:
        if pair.linked:
            linked[pair.robot].append(pair.other)
            linked[pair.other].append(pair.robot)
    reached, edge = {robots[0]}, [robots[0]]
    while edge:
        for robot in linked[edge.pop()]:
            if robot not in reached:
                reached.add(robot)
                edge.append(robot)
    return len(reached) == len(robots)


def _half_without_error_db(rate_mbps: float, bits: float) -> float:
    """SNR from which on at least half of the frames have no bit error [dB]."""
    low, high = -OWN_DB, CERTAIN_SINR_DB
    while high - low > _STEP_DB:
        middle = (low + high) / 2.0
        if frame_success(rate_mbps, middle, bits) >= 0.5:
            high = middle
        else:
            low = middle
    return high
