"""The tables of `onehop link` and `onehop saturate`, out of the code that carries a mission's frames."""

from dataclasses import dataclass

from onehop.contracts.ideal_link import (
    ACK_BYTES,
    BASIC_RATE_MBPS,
    RTS_BYTES,
    ideal_throughput_bps,
    threshold_bps,
)
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.airtime import dsss, printed_throughput_bps
from radio_proxy.core.closed_forms import SaturatedLink, bianchi_normalized, frame_probability
from radio_proxy.core.error_rates import bit_error_rate, thesis_ber
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.link_rules import link_rules
from radio_proxy.core.path_loss import OWN_DB, SILENT_DB
from radio_proxy.core.place_gains import place_gains_db
from radio_proxy.core.saturation import Saturation, pair, ring


@dataclass(frozen=True, slots=True)
class LinkRow:
    """One distance. snr_db: mean; ber: at that SNR, thesis_ber: by eq. 3.24, 3.25 read literally.

    frame_success: P(a data frame gets through) over the draw of each frame. closed_form_bps: throughput
    of one saturated sender by theory. good_places: share of the places at this distance, by spatial
    shadowing and fast fading, where that reaches the threshold; nine_of_ten_bps: what nine of ten places
    reach. The rest is measured at a place of mean SNR; delay_us is None when nothing arrives.
    """

    distance_m: float
    snr_db: float
    ber: float
    thesis_ber: float
    frame_success: float
    closed_form_bps: float
    good_places: float
    nine_of_ten_bps: float
    delivery_ratio: float
    throughput_bps: float
    delay_us: float | None


@dataclass(frozen=True, slots=True)
class LinkTable:
    """Link budget over distance, with the bounds that a follower compares with.

    places_differ: by spatial shadowing or fast fading.
    """

    rows: tuple[LinkRow, ...]
    places_differ: bool
    ideal_throughput_bps: float
    eq_3_16_throughput_bps: float
    threshold_bps: float


@dataclass(frozen=True, slots=True)
class SaturationTable:
    """Saturated stations in one cell: measured, and by Bianchi's formula. normalized: share of time."""

    stations: int
    throughput_bps: float
    normalized: float
    bianchi_normalized: float
    per_station_bps: tuple[float, ...]


def link_table(
    section: RadioSection, distances: tuple[float, ...], msdu_bytes: int, seed: int, seconds: float
) -> LinkTable:
    """The link at each distance [m]; `seconds` of simulated time are measured for each."""
    rts_cts = msdu_bytes > section.rts_threshold_bytes
    header = section.mac_header_bytes
    places = Places(section, msdu_bytes)
    return LinkTable(
        rows=tuple(
            _link_row(section, distance, msdu_bytes, seed, seconds, places) for distance in distances
        ),
        places_differ=len(places.gains_db) > 1,
        ideal_throughput_bps=ideal_throughput_bps(section.rate_mbps, msdu_bytes, rts_cts, header),
        eq_3_16_throughput_bps=printed_throughput_bps(section.rate_mbps, msdu_bytes),
        threshold_bps=threshold_bps(section.rate_mbps, msdu_bytes),
    )


class Places:
    """What the places at one distance differ by. gains_db: equally likely ones, ascending [dB]."""

    def __init__(self, section: RadioSection, msdu_bytes: int) -> None:
        self._section, self._msdu_bytes = section, msdu_bytes
        self.gains_db = place_gains_db(link_budget(section), section)
        self._good_snr_db = self._least_good_snr_db()

    def good_share(self, snr_db: float) -> float:
        """Share of the places of this mean SNR where one saturated sender reaches the threshold."""
        return float((snr_db + self.gains_db >= self._good_snr_db).mean())

    def nine_of_ten_bps(self, snr_db: float) -> float:
        """Throughput that nine of ten places of this mean SNR reach [bit/s]."""
        worst_tenth_db = float(self.gains_db[len(self.gains_db) // 10])
        return _closed_form_bps(self._section, snr_db + worst_tenth_db, self._msdu_bytes)

    def _least_good_snr_db(self) -> float:
        """SNR from which on the throughput reaches the threshold, by bisection."""
        least_bps = threshold_bps(self._section.rate_mbps, self._msdu_bytes)
        low, high = SILENT_DB, OWN_DB
        while high - low > 0.01:
            middle = (low + high) / 2.0
            if _closed_form_bps(self._section, middle, self._msdu_bytes) >= least_bps:
                high = middle
            else:
                low = middle
        return high


def _link_row(
    section: RadioSection, distance: float, msdu_bytes: int, seed: int, seconds: float, places: Places
) -> LinkRow:
    budget, timing = link_budget(section), dsss(section)
    snr_db = budget.mean_snr_db(distance)
    size_bytes = timing.mac_header_bytes + msdu_bytes
    load = pair(distance, msdu_bytes, msdu_bytes > section.rts_threshold_bytes)
    tally = Saturation(load, timing, budget, seed, link_rules(section)).run(seconds)
    delivered = tally.delivered[0]
    ended = delivered + tally.given_up
    success = frame_probability(budget, snr_db, section.rate_mbps, size_bytes)
    return LinkRow(
        distance_m=distance,
        snr_db=snr_db,
        ber=bit_error_rate(section.rate_mbps, snr_db),
        thesis_ber=thesis_ber(snr_db, 8 * msdu_bytes),
        frame_success=success,
        closed_form_bps=_closed_form_bps(section, snr_db, msdu_bytes),
        good_places=places.good_share(snr_db),
        nine_of_ten_bps=places.nine_of_ten_bps(snr_db),
        delivery_ratio=delivered / ended if ended else 0.0,
        throughput_bps=8.0 * msdu_bytes * delivered / seconds,
        delay_us=tally.delay / delivered / 1000.0 if delivered else None,
    )


def _closed_form_bps(section: RadioSection, snr_db: float, msdu_bytes: int) -> float:
    """Throughput of one saturated sender by the sum over its attempts."""
    budget, rts_cts = link_budget(section), msdu_bytes > section.rts_threshold_bytes
    theory = SaturatedLink(dsss(section), msdu_bytes, link_rules(section).retries, rts_cts)
    size_bytes = section.mac_header_bytes + msdu_bytes
    data = frame_probability(budget, snr_db, section.rate_mbps, size_bytes)
    if section.fading == "exchange":
        return 1e6 * theory.one_draw_per_exchange(data)[1]
    rts, ack = (
        frame_probability(budget, snr_db, BASIC_RATE_MBPS, size) for size in (RTS_BYTES, ACK_BYTES)
    )
    return 1e6 * theory.one_draw_per_frame(rts, ack, data, ack)[1]


def saturation_table(
    section: RadioSection, stations: int, msdu_bytes: int, rts_cts: bool, seed: int, seconds: float
) -> SaturationTable:
    """`stations` of one cell that always have a message, without fading, for `seconds` of time."""
    timing = dsss(section)
    budget = link_budget(section).without_fading()
    load, rules = ring(stations, msdu_bytes, rts_cts), link_rules(section)
    tally = Saturation(load, timing, budget, seed, rules).run(seconds)
    bits = 8.0 * msdu_bytes
    throughput_bps = bits * sum(tally.delivered) / seconds
    return SaturationTable(
        stations=stations,
        throughput_bps=throughput_bps,
        normalized=throughput_bps / (1e6 * section.rate_mbps),
        bianchi_normalized=bianchi_normalized(stations, timing, msdu_bytes, rts_cts),
        per_station_bps=tuple(bits * delivered / seconds for delivered in tally.delivered),
    )
