"""Times of the DCF and of its frames, in integer nanoseconds (thesis eq. 3.15 to 3.22).

The constants are onehop.contracts.ideal_link's; here they become the clock of the event simulation. Left
out: short preamble.
"""

from dataclasses import dataclass

from onehop.contracts import ideal_link
from onehop.contracts.radio_section import RadioSection

SPEED_OF_LIGHT = 299_792_458.0
"""Propagation speed of radio waves [m/s] (thesis eq. 3.22)."""

US = 1000
"""Nanoseconds in a microsecond."""


@dataclass(frozen=True, slots=True)
class Timing:
    """Times [ns], sizes [B] and rates [Mb/s] of one kind of DCF; windows in slots.

    response_timeout: CTSTimeout and ACKTimeout, from the end of a frame (802.11-1999, 9.2.5.7, 9.2.8).
    turnaround: a carrier that begins this short before a station's own slot is not sensed in time
        (802.11-1999, 9.2.10, aRxTxTurnaroundTime).
    """

    slot: int
    sifs: int
    difs: int
    preamble: int
    rts: int
    cts: int
    ack: int
    response_timeout: int
    mac_header_bytes: int
    rate_mbps: float
    basic_rate_mbps: float = ideal_link.BASIC_RATE_MBPS
    cw_min: int = ideal_link.CW_MIN
    cw_max: int = ideal_link.CW_MAX
    turnaround: int = 5 * US

    def data(self, msdu_bytes: int) -> int:
        """Airtime of a unicast data frame [ns] (thesis eq. 3.20)."""
        return self.preamble + round(8000 * (self.mac_header_bytes + msdu_bytes) / self.rate_mbps)

    def broadcast(self, msdu_bytes: int) -> int:
        """Airtime of a broadcast, which is sent at the basic rate [ns] (802.11-1999, 9.6)."""
        return self.preamble + round(8000 * (self.mac_header_bytes + msdu_bytes) / self.basic_rate_mbps)

    def window(self, failures: int) -> int:
        """Contention window after so many failures, min(32 * 2^i - 1, 1023) [slots]."""
        return min(((self.cw_min + 1) << failures) - 1, self.cw_max)


def dsss(section: RadioSection) -> Timing:
    """The timing of 802.11b as a scenario sets it."""
    return Timing(
        slot=round(ideal_link.SLOT_US * US),
        sifs=round(ideal_link.SIFS_US * US),
        difs=round(ideal_link.DIFS_US * US),
        preamble=round(ideal_link.PREAMBLE_US * US),
        rts=round(ideal_link.frame_us(ideal_link.RTS_BYTES, ideal_link.BASIC_RATE_MBPS) * US),
        cts=round(ideal_link.frame_us(ideal_link.ACK_BYTES, ideal_link.BASIC_RATE_MBPS) * US),
        ack=round(ideal_link.frame_us(ideal_link.ACK_BYTES, ideal_link.BASIC_RATE_MBPS) * US),
        response_timeout=round(section.cts_timeout_us * US),
        mac_header_bytes=section.mac_header_bytes,
        rate_mbps=section.rate_mbps,
    )


def delay_ns(distance: float) -> int:
    """Propagation delay over a distance [m] (thesis eq. 3.22)."""
    return round(distance * 1e9 / SPEED_OF_LIGHT)


def collision_us(propagation_us: float = 0.0) -> float:
    """Time lost when an RTS collides [us] (thesis eq. 3.17)."""
    rts = ideal_link.frame_us(ideal_link.RTS_BYTES, ideal_link.BASIC_RATE_MBPS)
    return rts + propagation_us + ideal_link.DIFS_US + ideal_link.mean_backoff_us()


def printed_exchange_us(rate_mbps: float, msdu_bytes: int, propagation_us: float = 0.0) -> float:
    """Time of a successful exchange exactly as eq. 3.16 is printed, without ACK and third SIFS [us]."""
    full = ideal_link.exchange_us(
        rate_mbps, msdu_bytes, True, ideal_link.MAC_HEADER_BYTES, propagation_us
    )
    ack = ideal_link.frame_us(ideal_link.ACK_BYTES, ideal_link.BASIC_RATE_MBPS)
    return full - ack - ideal_link.SIFS_US - propagation_us


def printed_throughput_bps(rate_mbps: float, msdu_bytes: int, propagation_us: float = 0.0) -> float:
    """Throughput by eq. 3.15 with eq. 3.16 as printed [bit/s]; the model itself never uses it."""
    return 8e6 * msdu_bytes / printed_exchange_us(rate_mbps, msdu_bytes, propagation_us)
