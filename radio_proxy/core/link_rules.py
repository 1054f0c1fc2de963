"""Which rules a receiver and a station of the DCF keep, where a scenario has a choice."""

from dataclasses import dataclass

from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.link_budget import link_budget

SHORT_RETRY_LIMIT = 7
LONG_RETRY_LIMIT = 4
"""dot11ShortRetryLimit and dot11LongRetryLimit (802.11-1999, 9.2.5.3 and annex D)."""

SINGLE_RETRY_LIMIT = 7
"""Attempts of one frame in the thesis (3.7) and in ns-3 (FrameRetryLimit)."""


@dataclass(frozen=True, slots=True)
class RetryLimits:
    """When a frame is given up. single: attempts in all, or None: failures by short and long count."""

    single: int | None = SINGLE_RETRY_LIMIT
    short: int = SHORT_RETRY_LIMIT
    long: int = LONG_RETRY_LIMIT


@dataclass(frozen=True, slots=True)
class LinkRules:
    """Rules of reception and contention in force; the fields are those of the radio section."""

    retries: RetryLimits = RetryLimits()
    rts_threshold_bytes: int = 0
    queue_frames: int = 64
    fade_per_exchange: bool = False
    preamble_sinr_db: float | None = None
    capture_db: float | None = None
    energy_detect_db: float | None = None
    as_ns3: bool = False


def link_rules(section: RadioSection) -> LinkRules:
    """The rules of a scenario."""
    return LinkRules(
        retries=_retry_limits(section),
        rts_threshold_bytes=section.rts_threshold_bytes,
        queue_frames=section.queue_frames,
        fade_per_exchange=section.fading == "exchange",
        preamble_sinr_db=section.preamble_sinr_db,
        capture_db=section.capture_db,
        energy_detect_db=_energy_detect_db(section),
        as_ns3=section.as_ns3,
    )


def _retry_limits(section: RadioSection) -> RetryLimits:
    short, long = section.short_retry_limit, section.long_retry_limit
    single = section.retry_limit
    if single is None and short is None and long is None:
        counts_once = section.as_ns3 or section.preset == "thesis"
        single = SINGLE_RETRY_LIMIT if counts_once else None
    return RetryLimits(
        single,
        SHORT_RETRY_LIMIT if short is None else short,
        LONG_RETRY_LIMIT if long is None else long,
    )


def _energy_detect_db(section: RadioSection) -> float | None:
    """In ns-3 the sum of all frames is held against the one threshold."""
    if section.energy_detect_db is None and section.as_ns3:
        return link_budget(section).carrier_sense_db
    return section.energy_detect_db
