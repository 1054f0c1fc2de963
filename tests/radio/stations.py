"""Saturated stations for the tests: Bianchi's own timing, and runs of the event engine."""

from radio_proxy.core.airtime import Timing


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
        answer_timeout=300_000,
        mac_header_bytes=34,
        rate_mbps=1.0,
        cw_min=window - 1,
        cw_max=(window << stages) - 1,
    )
