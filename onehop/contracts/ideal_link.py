"""How long an undisturbed 802.11b exchange lasts, and the throughput that it allows (thesis 3.7).

Both ends of a link need this: the radio to move frames, a follower to know what its slot would give at
best. Long preamble (192 us) and control frames at 1 Mb/s (IEEE 802.11-1999, 15.2 and 18.2).
"""

PREAMBLE_US = 192.0
"""Long PLCP preamble and header, sent at 1 Mb/s [us]."""

SIFS_US = 10.0
DIFS_US = 50.0
SLOT_US = 20.0
CW_MIN = 31
CW_MAX = 1023
"""Inter-frame spaces, slot [us] and contention windows [slots] of 802.11b (15.3.3, 18.3.3)."""

MAC_HEADER_BYTES = 34
"""MAC header with four addresses and check sequence, as the thesis's source counts it [B]."""

RTS_BYTES = 20
ACK_BYTES = 14
"""Control frames; CTS and ACK are of one size [B] (802.11-1999, 7.2.1)."""

BASIC_RATE_MBPS = 1.0
"""Rate of control frames and broadcasts [Mb/s]."""


def frame_us(size_bytes: float, rate_mbps: float) -> float:
    """Airtime of one frame of `size_bytes`, MAC header included [us] (thesis eq. 3.18 to 3.20)."""
    return PREAMBLE_US + 8.0 * size_bytes / rate_mbps


def mean_backoff_us() -> float:
    """Mean first backoff: half the minimum window in slots [us] (thesis eq. 3.21)."""
    return CW_MIN * SLOT_US / 2.0


def exchange_us(
    rate_mbps: float,
    msdu_bytes: int,
    rts_cts: bool = True,
    mac_header_bytes: int = MAC_HEADER_BYTES,
    propagation_us: float = 0.0,
) -> float:
    """Mean time of one successful exchange, from DIFS to the end of the ACK [us].

    Differs: eq. 3.16 as printed leaves out the ACK and a SIFS although the text around it speaks of a
    full RTS, CTS, DATA, ACK exchange; this is the full exchange, because it is what the air carries.
    """
    data = frame_us(mac_header_bytes + msdu_bytes, rate_mbps)
    ack = frame_us(ACK_BYTES, BASIC_RATE_MBPS)
    total = DIFS_US + mean_backoff_us() + data + SIFS_US + ack + 2.0 * propagation_us
    if rts_cts:
        total += frame_us(RTS_BYTES, BASIC_RATE_MBPS) + ack + 2.0 * (SIFS_US + propagation_us)
    return total


def ideal_throughput_bps(
    rate_mbps: float,
    msdu_bytes: int,
    rts_cts: bool = True,
    mac_header_bytes: int = MAC_HEADER_BYTES,
    propagation_us: float = 0.0,
) -> float:
    """Highest throughput of one link, one sender, no error [bit/s] (thesis eq. 3.15)."""
    return (
        8e6 * msdu_bytes / exchange_us(rate_mbps, msdu_bytes, rts_cts, mac_header_bytes, propagation_us)
    )


LIGHT_M_PER_US = 299.792458
"""Speed of light [m/us]."""

THESIS_THRESHOLD_BPS = 0.5333e6
"""Throughput below which the thesis's followers hurry, at 1 Mb/s and 800 B (3.8.3) [bit/s]."""


def propagation_us(distance: float) -> float:
    """How long a signal takes over a distance in metres [us] (thesis eq. 3.22)."""
    return distance / LIGHT_M_PER_US


def threshold_bps(rate_mbps: float, msdu_bytes: int, propagation_us: float = 0.0) -> float:
    """The same share of the ideal throughput at any rate and size, 0.684 [bit/s]."""
    share = THESIS_THRESHOLD_BPS / ideal_throughput_bps(1.0, 800)
    ideal = ideal_throughput_bps(rate_mbps, msdu_bytes, propagation_us=propagation_us)
    return share * ideal
