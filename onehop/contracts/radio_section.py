"""The radio section of a scenario."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Literal

from onehop.contracts.problems import Problem
from onehop.contracts.ranges import Range


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
    queue_frames: bound of the queue of a NIC; a frame that finds it full is dropped.
    message_lifetime_s: after which a message is dropped where it waits, unless it has a lifetime of its
        own, as all messages of the team have; 0: never [s].
    routing: "direct" (one hop only), "mrsr" (on DSR) or "mrdv" (on AODV).
    hello_s: period of MRDV's broadcast hellos (RFC 3561, 6.9), 0 for none [s].
    gamma_distance: remaining distance per unit of gamma in p_r = min(1, (1/v)^gamma) [m].
    """

    preset: Literal["thesis", "physical"] = "thesis"
    rate_mbps: Annotated[float, Range(1.0, 11.0)] = 1.0
    retry_limit: Annotated[int, Range(1, 255)] = 7
    tx_power_dbm: Annotated[float, Range(-100.0, 100.0)] | None = None
    path_loss_exponent: Annotated[float, Range(1.0, 10.0)] | None = None
    noise_dbm: Annotated[float, Range(-200.0, 100.0)] | None = None
    shadowing_db: Annotated[float, Range(0.0, 40.0)] | None = None
    receive_threshold_db: Annotated[float, Range(-50.0, 100.0)] | None = None
    carrier_sense_db: Annotated[float, Range(-50.0, 100.0)] | None = None
    frequency_hz: Annotated[float, Range(1e6, 1e12)] = 2.4e9
    antenna_gain_dbi: Annotated[float, Range(-50.0, 50.0)] = 0.0
    system_loss_db: Annotated[float, Range(-100.0, 100.0)] = 0.0
    reference_distance: Annotated[float, Range(1e-3, 1e3)] = 1.0
    fading: Literal["frame", "exchange"] = "frame"
    wall_loss_db: Annotated[float, Range(0.0, 1e3)] = 0.0
    rts_threshold_bytes: Annotated[int, Range(0, 2304)] = 0
    mac_header_bytes: Annotated[int, Range(1, 100)] = 34
    cts_timeout_us: Annotated[float, Range(222.0, 1e5)] = 222.0
    queue_frames: Annotated[int, Range(1, 100_000)] = 64
    message_lifetime_s: Annotated[float, Range(0.0, 3600.0)] = 0.0
    routing: Literal["direct", "mrsr", "mrdv"] = "mrdv"
    hello_s: Annotated[float, Range(0.0, 3600.0)] = 0.0
    gamma_distance: Annotated[float, Range(1e-3, 1e9)] = 10.0

    def problems(self) -> Iterator[Problem]:
        if self.rate_mbps not in (1.0, 2.0, 5.5, 11.0):
            yield Problem("rate_mbps", f"{self.rate_mbps} Mb/s", "1, 2, 5.5 or 11 (802.11b)")
