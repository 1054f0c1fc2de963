"""What theory says of saturated stations: Bianchi's DCF model, and one link under fading.

G. Bianchi, "Performance analysis of the IEEE 802.11 distributed coordination function", IEEE JSAC 18(3),
2000, eq. 7 to 17. The fading forms are sums over the attempts of one frame. The event simulation is held
against them, and the tables of `onehop link` and `onehop saturate` show them beside it. Nothing of a
mission depends on them, so powers and exponentials are the C library's.
"""

import math

from radio_proxy.core.airtime import Timing
from radio_proxy.core.error_rates import frame_success
from radio_proxy.core.link_budget import LinkBudget
from radio_proxy.core.link_rules import RetryLimits
from radio_proxy.core.reception import HEADER_BITS, HEADER_RATE_MBPS

FADED_STEP = 0.0625
"""Faded SNRs are rounded to multiples of it: error rates of CCK take milliseconds each [dB]."""


def bianchi_tau(stations: int, window: int, stages: int) -> tuple[float, float]:
    """Probabilities that a station transmits in a slot, and that it then collides (eq. 7 and 9).

    window: W, the first window's size in slots. stages: m, how often it doubles.
    """

    def transmits(p: float) -> float:
        doubled = sum((2.0 * p) ** i for i in range(stages))
        return 2.0 / (1.0 + window + p * window * doubled)

    low, high = 0.0, 1.0
    for _ in range(200):
        p = (low + high) / 2.0
        if 1.0 - (1.0 - transmits(p)) ** (stations - 1) > p:
            low = p
        else:
            high = p
    return transmits(low), low


def bianchi_normalized(
    stations: int, timing: Timing, msdu_bytes: int, rts_cts: bool, propagation_delay: int = 0
) -> float:
    """Share of time that carries payload bits in one saturated cell (eq. 13). propagation_delay [ns]."""
    window = timing.cw_min + 1
    stages = round(math.log2((timing.cw_max + 1) / window))
    tau, _ = bianchi_tau(stations, window, stages)
    some = 1.0 - (1.0 - tau) ** stations
    one = stations * tau * (1.0 - tau) ** (stations - 1)
    payload = 8000.0 * msdu_bytes / timing.rate_mbps
    data = timing.data(msdu_bytes)
    success = data + timing.sifs + timing.ack + timing.difs + 2 * propagation_delay
    collision = data + timing.difs + propagation_delay
    if rts_cts:
        success += timing.rts + timing.cts + 2 * timing.sifs + 2 * propagation_delay
        collision = timing.rts + timing.difs + propagation_delay
    time = (1.0 - some) * timing.slot + one * success + (some - one) * collision
    return one * payload / time


def frame_probability(budget: LinkBudget, snr_db: float, rate_mbps: float, size_bytes: int) -> float:
    """P(a frame gets through) at a mean SNR, over the fading: threshold, PLCP header and bit errors."""

    def through(sinr_db: float) -> float:
        header = frame_success(HEADER_RATE_MBPS, sinr_db, HEADER_BITS)
        return header * frame_success(rate_mbps, sinr_db, 8 * size_bytes)

    if budget.shadowing_db == 0.0:
        return through(snr_db) if snr_db >= budget.receive_threshold_db else 0.0
    steps, span = 2000, 8.0
    total = weight = 0.0
    for k in range(steps):
        z = -span + (k + 0.5) * 2.0 * span / steps
        density = math.exp(-0.5 * z * z)
        weight += density
        faded = snr_db + budget.shadowing_db * z
        if faded >= budget.receive_threshold_db:
            rounded = round(faded / FADED_STEP) * FADED_STEP
            total += density * through(rounded)
    return total / weight


class SaturatedLink:
    """One sender that always has a message, alone on the medium, over a lossy link (not as_ns3)."""

    def __init__(
        self, timing: Timing, msdu_bytes: int, retries: RetryLimits, rts_cts: bool = True
    ) -> None:
        self._timing = timing
        self._bits = 8 * msdu_bytes
        self._data = timing.data(msdu_bytes)
        self._retries = retries
        self._rts_cts = rts_cts

    def _wait_us(self, failures: int) -> float:
        """DIFS and the mean backoff after so many failures."""
        timing = self._timing
        return timing.difs / 1000.0 + timing.window(failures) * timing.slot / 2000.0

    def _times_us(self) -> tuple[float, float, float]:
        """Costs of an attempt: RTS without CTS, data without ACK, all of it [us]."""
        t = self._timing
        before = t.rts + t.cts + 2 * t.sifs if self._rts_cts else 0
        lost_rts = t.rts + t.response_timeout
        lost_data = before + self._data + t.response_timeout
        whole = before + self._data + t.sifs + t.ack
        return lost_rts / 1000.0, lost_data / 1000.0, whole / 1000.0

    def one_draw_per_exchange(self, p: float) -> tuple[float, float, float]:
        """Delivery ratio, throughput [Mb/s] and mean delay of a delivered message [us].

        p: probability that an exchange gets through; its first frame decides it, and counts as short.
        """
        lost_rts, lost_data, whole = self._times_us()
        lost = lost_rts if self._rts_cts else lost_data
        limit = self._retries.short if self._retries.single is None else self._retries.single
        q = 1.0 - p
        spent = delay = passed = 0.0
        for i in range(limit):
            wait = self._wait_us(i)
            delay += q**i * p * (passed + wait + whole)
            spent += q**i * (wait + p * whole + q * lost)
            passed += wait + lost
        ratio = 1.0 - q**limit
        return ratio, ratio * self._bits / spent, delay / ratio if ratio else math.inf

    def one_draw_per_frame(self, rts: float, cts: float, data: float, ack: float) -> tuple[float, float]:
        """Delivery ratio and throughput [Mb/s], with each frame's own probability to get through."""
        lost_rts, lost_data, whole = self._times_us()
        begun = rts * cts if self._rts_cts else 1.0
        arrived = begun * data
        done = arrived * ack
        mean = (1.0 - begun) * lost_rts + (begun - done) * lost_data + done * whole
        spent = delivered = 0.0
        counts = {(0, 0, False): 1.0}
        failures = 0
        while counts:
            spent += sum(counts.values()) * (self._wait_us(failures) + mean)
            failures += 1
            after: dict[tuple[int, int, bool], float] = {}
            for (short, long, has_arrived), weight in counts.items():
                delivered += weight * done
                after_cts = (0, long + 1) if self._rts_cts else (short + 1, 0)
                for (shorts, longs), arrives, p in (
                    ((short + 1, long), has_arrived, 1.0 - begun),
                    (after_cts, has_arrived, begun - arrived),
                    (after_cts, True, arrived - done),
                ):
                    if self._is_given_up(failures, shorts, longs):
                        delivered += weight * p * arrives
                    elif p > 0.0:
                        key = shorts, longs, arrives
                        after[key] = after.get(key, 0.0) + weight * p
            counts = after
        return delivered, delivered * self._bits / spent

    def _is_given_up(self, attempts: int, short: int, long: int) -> bool:
        limits = self._retries
        if limits.single is not None:
            return attempts >= limits.single
        return short >= limits.short or long >= limits.long
