"""The radio section of a scenario."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from onehop.contracts.problems import Problem, positive


@dataclass(frozen=True, slots=True)
class RadioSection:
    """Radio of all robots (thesis 3.7): propagation, the 802.11b link, and the ad hoc routing.

    preset: "thesis" (0.2 W over free space, SNR 60 dB at 1 m) or "physical" (15 dBm, noise figure
        7 dB, exponent 2.6). The next six are None to be as the preset says.
    tx_power_dbm; path_loss_exponent n; noise_dbm: floor in 22 MHz; shadowing_db: sigma of the
        log-normal fading; receive_threshold_db: lowest SINR that is received;
        carrier_sense_db: lowest SNR of a carrier that makes the medium busy.
    frequency_hz, antenna_gain_dbi (each end), system_loss_db, reference_distance d0 [m].
    fading: a new draw for each "frame", or one for each "exchange". wall_loss_db: per wall crossed.
    rate_mbps: of data frames. rts_threshold_bytes: longer MSDUs are sent with RTS/CTS (2304: never).
    mac_header_bytes: 34 in the thesis's sums, 28 with three addresses.
    retry_limit: attempts of one frame. cts_timeout_us: from the end of a frame until its answer is
        given up (SIFS + slot + preamble; 334 in the standard of 1999).
    queue_frames: bound of a card's queue; a frame that finds it full is dropped.
    routing: "direct" (one hop only), "mrsr" (on DSR) or "mrdv" (on AODV).
    gamma_distance: remaining distance per unit of gamma in p_r = min(1, (1/v)^gamma) [m].
    """

    preset: Literal["thesis", "physical"] = "thesis"
    rate_mbps: float = 1.0
    retry_limit: int = 7
    tx_power_dbm: float | None = None
    path_loss_exponent: float | None = None
    noise_dbm: float | None = None
    shadowing_db: float | None = None
    receive_threshold_db: float | None = None
    carrier_sense_db: float | None = None
    frequency_hz: float = 2.4e9
    antenna_gain_dbi: float = 0.0
    system_loss_db: float = 0.0
    reference_distance: float = 1.0
    fading: Literal["frame", "exchange"] = "frame"
    wall_loss_db: float = 0.0
    rts_threshold_bytes: int = 0
    mac_header_bytes: int = 34
    cts_timeout_us: float = 222.0
    queue_frames: int = 64
    routing: Literal["direct", "mrsr", "mrdv"] = "mrdv"
    gamma_distance: float = 10.0

    def problems(self) -> Iterator[Problem]:
        if self.rate_mbps not in (1.0, 2.0, 5.5, 11.0):
            yield Problem("rate_mbps", f"{self.rate_mbps} Mb/s", "1, 2, 5.5 or 11 (802.11b)")
        above_zero = (
            "retry_limit frequency_hz reference_distance mac_header_bytes queue_frames gamma_distance"
        )
        yield from positive(self, *above_zero.split())
        for key in ("wall_loss_db", "rts_threshold_bytes", "shadowing_db"):
            value = getattr(self, key)
            if value is not None and value < 0:
                yield Problem(key, f"{value} is negative", "0 or more")
        if self.path_loss_exponent is not None and self.path_loss_exponent < 1:
            yield Problem("path_loss_exponent", f"{self.path_loss_exponent} < 1", "2 is free space")
        if self.cts_timeout_us < 222.0:
            yield Problem(
                "cts_timeout_us",
                f"{self.cts_timeout_us} us ends before an answer can begin",
                "222 or more",
            )
