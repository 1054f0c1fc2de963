"""The radio section of a scenario."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Literal

from onehop.contracts.plugin_names import PluginName, name_problems
from onehop.contracts.problems import Problem
from onehop.contracts.ranges import Range

RoutingName = Literal["direct", "mrsr", "mrdv"]
PropagationName = Literal["log-distance"]
"""What is built in; packages may add others."""
_LEAST_SNR_DB = {"thesis": 32.0, "physical": 32.0, "indoor": 0.0}
"""Receive threshold of each preset: the thesis's (3.7), and that of measured cards (docs/links.md)."""


@dataclass(frozen=True, slots=True)
class RadioSection:
    """Radio of all robots (thesis 3.7): propagation, the 802.11b link, and the ad hoc routing.

    link: "modelled" as all that follows says, or one of its bounds: "perfect" (every message reaches
        every robot in one hop, after its airtime alone) or "none" (nothing ever arrives, and each robot
        of the built-in team goes alone).
    preset: "thesis" (0.2 W over free space, SNR 60 dB at 1 m), "physical" (15 dBm, noise figure
        7 dB, exponent 2.6) or "indoor" (the same card in an office as it was measured, docs/links.md).
        The next seven are None to be as the preset says.
    tx_power_dbm; path_loss_exponent n; noise_dbm: floor in 22 MHz; shadowing_db: sigma of the
        log-normal fading that is drawn anew, place or no place (see fading);
        receive_threshold_db: lowest SNR of a signal that a receiver locks on;
        carrier_sense_db: lowest SNR of a carrier that makes the medium busy.
    spatial_shadowing_db: sigma of the log-normal shadowing between places. decorrelation_distance: that
        one end moves until it is correlated by 1/e [m] (Gudmundson 1991).
    fast_fading: of many paths, "none", "rayleigh" or "rician", with the Doppler of the robots' motion.
        rician_k_db: power of the line of sight over all other paths. ambient_doppler_hz: of what else
        moves; 0 leaves the channel of standing robots as it is.
    energy_detect_db: lowest power of everything received, over the noise floor, that makes the medium
        busy as well [dB]; None: only carriers do (CCA mode 2).
    preamble_sinr_db: lowest SINR at which a preamble is detected among other frames [dB]; None: the
        receive threshold.
    capture_db: a frame stronger by this takes over a receiver in the preamble of another [dB]; None:
        a receiver that is locked stays so.
    frequency_hz, antenna_gain_dbi (each end), system_loss_db, reference_distance d0 [m].
    propagation: what a signal loses between two places on the mean: "log-distance", by the keys above.
    links: file of links that were measured, beside the scenario (docs/link-traces.md). links_use:
        "instead" of path loss, walls and shadowing, so that a link which it does not have is none, or
        "on top" of them, as a further loss.
    fading: a new draw for each "frame", or one for each "exchange". wall_loss_db: per wall crossed.
    rate_mbps: of data frames. rts_threshold_bytes: longer MSDUs are sent with RTS/CTS (2304: never).
    mac_header_bytes: 34 in the thesis's sums, 28 with three addresses.
    retry_limit: attempts of one frame in all (None: 7 with preset "thesis" or as_ns3); or, if it is not
        that, short_retry_limit and long_retry_limit: failures without and after a CTS (802.11-1999,
        9.2.5.3; None: 7 and 4).
    as_ns3: read the standard as ns-3 3.44 does where it differs (docs/radio-model.md).
    cts_timeout_us: from the end of a frame until its answer is given up (SIFS + slot + preamble; 334 in
        the standard of 1999).
    queue_frames: bound of the queue of a NIC; a frame that finds it full is dropped.
    message_lifetime_s: after which a message is dropped where it waits, unless it has a lifetime of its
        own, as all messages of the team have; 0: never [s].
    routing: "direct" (one hop only), "mrsr" (on DSR) or "mrdv" (on AODV).
    neighbours: whether cards tell their robots whom they hear: SNR and RSSI of each one's last frame,
        whoever it was for.
    hello_s: period of MRDV's broadcast hellos (RFC 3561, 6.9), 0 for none [s].
    gamma_distance: remaining distance per unit of gamma in p_r = min(1, (1/v)^gamma) [m].
    """

    link: Literal["modelled", "perfect", "none"] = "modelled"
    preset: Literal["thesis", "physical", "indoor"] = "thesis"
    rate_mbps: Annotated[float, Range(1.0, 11.0)] = 1.0
    retry_limit: Annotated[int, Range(1, 255)] | None = None
    short_retry_limit: Annotated[int, Range(1, 255)] | None = None
    long_retry_limit: Annotated[int, Range(1, 255)] | None = None
    tx_power_dbm: Annotated[float, Range(-100.0, 100.0)] | None = None
    path_loss_exponent: Annotated[float, Range(1.0, 10.0)] | None = None
    noise_dbm: Annotated[float, Range(-200.0, 100.0)] | None = None
    shadowing_db: Annotated[float, Range(0.0, 40.0)] | None = None
    receive_threshold_db: Annotated[float, Range(-50.0, 100.0)] | None = None
    carrier_sense_db: Annotated[float, Range(-50.0, 100.0)] | None = None
    spatial_shadowing_db: Annotated[float, Range(0.0, 40.0)] | None = None
    decorrelation_distance: Annotated[float, Range(1e-2, 1e4)] = 1.8
    fast_fading: Literal["none", "rayleigh", "rician"] = "none"
    rician_k_db: Annotated[float, Range(-40.0, 40.0)] = 6.0
    ambient_doppler_hz: Annotated[float, Range(0.0, 1e3)] = 0.0
    energy_detect_db: Annotated[float, Range(-50.0, 100.0)] | None = None
    preamble_sinr_db: Annotated[float, Range(0.0, 100.0)] | None = None
    capture_db: Annotated[float, Range(0.0, 100.0)] | None = None
    as_ns3: bool = False
    frequency_hz: Annotated[float, Range(1e6, 1e12)] = 2.4e9
    antenna_gain_dbi: Annotated[float, Range(-50.0, 50.0)] = 0.0
    system_loss_db: Annotated[float, Range(-100.0, 100.0)] = 0.0
    reference_distance: Annotated[float, Range(1e-3, 1e3)] = 1.0
    propagation: PropagationName | PluginName = "log-distance"
    links: str = ""
    links_use: Literal["instead", "on top"] = "instead"
    fading: Literal["frame", "exchange"] = "frame"
    wall_loss_db: Annotated[float, Range(0.0, 1e3)] = 0.0
    rts_threshold_bytes: Annotated[int, Range(0, 2304)] = 0
    mac_header_bytes: Annotated[int, Range(1, 100)] = 34
    cts_timeout_us: Annotated[float, Range(222.0, 1e5)] = 222.0
    queue_frames: Annotated[int, Range(1, 100_000)] = 64
    message_lifetime_s: Annotated[float, Range(0.0, 3600.0)] = 0.0
    routing: RoutingName | PluginName = "mrdv"
    neighbours: bool = False
    hello_s: Annotated[float, Range(0.0, 3600.0)] = 0.0
    gamma_distance: Annotated[float, Range(1e-3, 1e9)] = 10.0

    @property
    def least_snr_db(self) -> float:
        """The receive threshold in force: every card knows its own [dB]."""
        given = self.receive_threshold_db
        return _LEAST_SNR_DB[self.preset] if given is None else given

    def problems(self) -> Iterator[Problem]:
        yield from name_problems("routing", self.routing)
        yield from name_problems("propagation", self.propagation)
        if self.link != "modelled":
            for key in ("links", "neighbours"):
                if getattr(self, key):
                    yield Problem(key, f'set beside link = "{self.link}"', 'link = "modelled"')
        if self.rate_mbps not in (1.0, 2.0, 5.5, 11.0):
            yield Problem("rate_mbps", f"{self.rate_mbps} Mb/s", "1, 2, 5.5 or 11 (802.11b)")
        if self.retry_limit is not None:
            for key in ("short_retry_limit", "long_retry_limit"):
                if getattr(self, key) is not None:
                    yield Problem(key, "set beside retry_limit", "one limit, or short and long ones")
