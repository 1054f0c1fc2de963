"""From SINR to bit errors: DBPSK, DQPSK and CCK as 802.11b sends them, and the thesis's own formula.

One law per function. SINR is linear over the 22 MHz channel; the factors 22, 11 and 8 are the
spreading gains. The laws are those of ns-3's DsssErrorRateModel, whose table is the test.
"""

import math
from functools import lru_cache

from onehop.contracts import elementary

CERTAIN_SINR_DB = 20.0
"""From here on every 802.11b rate loses less than 1e-12 of its frames, which counts as none: no draw."""

_STEP = 0.01
"""Step of the integral over the CCK noise [standard deviations]; halving it moves nothing above 1e-9."""


def dbpsk_ber(sinr: float) -> float:
    """Bit error rate of DBPSK, 1 Mb/s."""
    return 0.5 * elementary.exp(-22.0 * sinr)


def dqpsk_ber(sinr: float) -> float:
    """Bit error rate of DQPSK, 2 Mb/s (asymptotic form, capped at 1/2)."""
    x = 11.0 * sinr
    if x <= 0.0:
        return 0.5
    scale = (math.sqrt(2.0) + 1.0) / math.sqrt(8.0 * math.pi * math.sqrt(2.0))
    return min(0.5, scale / math.sqrt(x) * elementary.exp(-(2.0 - math.sqrt(2.0)) * x))


@lru_cache(maxsize=4096)
def cck16_symbol_error(energy: float) -> float:
    """Error probability of a 16-ary biorthogonal symbol of the given energy per noise."""
    beta = math.sqrt(2.0 * energy)
    start = max(-beta, -9.0)
    steps = math.ceil((9.0 - start) / _STEP / 2.0) * 2
    width = (9.0 - start) / steps
    total = 0.0
    for k in range(steps + 1):
        x = start + k * width
        weight = 1.0 if k in (0, steps) else (4.0 if k % 2 else 2.0)
        right = elementary.erf((x + beta) / math.sqrt(2.0))
        cubed = right * right * right
        total += weight * cubed * cubed * right * elementary.exp(-0.5 * x * x)
    all_right = total * width / 3.0 / math.sqrt(2.0 * math.pi)
    return min(1.0, max(0.0, 1.0 - all_right))


def cck55_symbol_error(sinr: float) -> float:
    """Error probability of a CCK symbol of 4 bits, 5.5 Mb/s."""
    return cck16_symbol_error(8.0 * sinr)


def cck11_symbol_error(sinr: float) -> float:
    """Error probability of a CCK symbol of 8 bits, 11 Mb/s."""
    right = 1.0 - cck16_symbol_error(4.0 * sinr)
    return 1.0 - right * right


def bit_error_rate(rate_mbps: float, sinr_db: float) -> float:
    """Bit error rate at a rate; for CCK the rate that gives the same frame success bit by bit."""
    if sinr_db >= CERTAIN_SINR_DB:
        return 0.0
    sinr = elementary.power_of_ten(sinr_db / 10.0)
    if rate_mbps == 1.0:
        return dbpsk_ber(sinr)
    if rate_mbps == 2.0:
        return dqpsk_ber(sinr)
    if rate_mbps == 5.5:
        return -elementary.expm1(elementary.log1p(-min(cck55_symbol_error(sinr), 1.0 - 1e-15)) / 4.0)
    return -elementary.expm1(elementary.log1p(-min(cck11_symbol_error(sinr), 1.0 - 1e-15)) / 8.0)


def frame_success(rate_mbps: float, sinr_db: float, bits: float) -> float:
    """Probability that a frame, or a stretch of one, of `bits` has no bit error."""
    if sinr_db >= CERTAIN_SINR_DB:
        return 1.0
    return elementary.exp(bits * elementary.log1p(-bit_error_rate(rate_mbps, sinr_db)))


def thesis_ber(sinr_db: float, bits: int) -> float:
    """Bit error rate by eq. 3.24 and 3.25 read literally, with SINR shared by the bits of a packet.

    It draws the thesis's curves (0.39 at 32 dB, 800 B) but cannot drive loss: reported, never used.
    """
    return 0.5 * elementary.exp(-elementary.power_of_ten(sinr_db / 10.0) / bits)
