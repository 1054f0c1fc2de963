"""What a signal loses on its way, as a scenario sets it (thesis 3.7.1).

Pr(d) = Pt Gt Gr lambda^2 / ((4 pi d0)^2 L) * (d0/d)^n * 10^(X/10), X ~ N(0, sigma) dB. What is kept is
the mean SNR above the noise floor; the draw X of each frame is the medium's, shadowing that belongs to
places is in shadowing.py, fast fading in fast_fading.py.
"""

import math
from dataclasses import dataclass, replace

from onehop.contracts import elementary
from onehop.contracts.radio_section import RadioSection

WAVE_SPEED = 3.0e8
"""Rounded as in the sums that the thesis's and ns-3's path losses come from [m/s]."""

REACH_DB = -10.0
"""Mean SNR below which a signal is left out: it neither gets through nor interferes (0.4 dB) [dB]."""

THERMAL_NOISE_DBM = -100.55
"""kTB of a 22 MHz channel at 290 K [dBm]."""

CLIP = 3.0
"""Spatial shadowing is held within so many standard deviations, which one place in 370 would leave: so
there is a distance beyond which nobody is heard."""


@dataclass(frozen=True, slots=True)
class LinkBudget:
    """Propagation in force. snr_reference_db: mean SNR at the reference distance d0 [m]."""

    snr_reference_db: float
    reference_distance: float
    exponent: float
    noise_dbm: float
    shadowing_db: float
    receive_threshold_db: float
    carrier_sense_db: float
    wall_loss_db: float
    spatial_shadowing_db: float = 0.0
    decorrelation_distance: float = 1.0

    def mean_snr_db(self, distance: float) -> float:
        """Mean SNR without walls at a distance [m]; nearer than d0 counts as d0."""
        ratio = max(distance / self.reference_distance, 1.0)
        return self.snr_reference_db - 10.0 * self.exponent * elementary.log10(ratio)

    def without_fading(self) -> "LinkBudget":
        """The same budget with every frame at its mean SNR."""
        return replace(self, shadowing_db=0.0)

    @property
    def reach(self) -> float:
        """Distance beyond which a signal neither gets through nor interferes [m]."""
        strongest_db = self.snr_reference_db + CLIP * self.spatial_shadowing_db
        margin = strongest_db - REACH_DB
        return self.reference_distance * elementary.power_of_ten(
            max(0.0, margin / (10.0 * self.exponent))
        )


def free_space_loss_db(distance: float, frequency_hz: float) -> float:
    """Friis loss at a distance [m] (40.046 dB at 1 m, 2.4 GHz)."""
    return 20.0 * elementary.log10(4.0 * math.pi * distance * frequency_hz / WAVE_SPEED)


_PRESETS: dict[str, dict[str, float]] = {
    # 0.2 W; the floor that gives the SNR of 60 dB at 1 m of the thesis's figures.
    "thesis": {
        "tx_power_dbm": 10.0 * elementary.log10(200.0),
        "path_loss_exponent": 2.0,
        "noise_dbm": 10.0 * elementary.log10(200.0) - free_space_loss_db(1.0, 2.4e9) - 60.0,
    },
    # 15 dBm and a noise figure of 7 dB: what a laptop card of 802.11b has.
    "physical": {
        "tx_power_dbm": 15.0,
        "path_loss_exponent": 2.6,
        "noise_dbm": THERMAL_NOISE_DBM + 7.0,
    },
    # The same card in an office; docs/links.md has the measurements.
    "indoor": {
        "tx_power_dbm": 15.0,
        "path_loss_exponent": 2.4,
        "noise_dbm": THERMAL_NOISE_DBM + 7.0,
        "shadowing_db": 0.6,
        "carrier_sense_db": 0.0,
        "spatial_shadowing_db": 9.0,
    },
}
_ANY_PRESET = {
    "shadowing_db": 4.0,
    "carrier_sense_db": 10.0,
    "spatial_shadowing_db": 0.0,
}
"""Fading of the thesis's simulation; carrier sense as a DSSS receiver locks on."""


def link_budget(section: RadioSection) -> LinkBudget:
    """The propagation of a scenario: its preset, with whatever the scenario sets itself."""

    def value(key: str) -> float:
        given: float | None = getattr(section, key)
        return {**_ANY_PRESET, **_PRESETS[section.preset]}[key] if given is None else given

    received_dbm = (
        value("tx_power_dbm")
        + 2.0 * section.antenna_gain_dbi
        - section.system_loss_db
        - free_space_loss_db(section.reference_distance, section.frequency_hz)
    )
    return LinkBudget(
        snr_reference_db=received_dbm - value("noise_dbm"),
        reference_distance=section.reference_distance,
        exponent=value("path_loss_exponent"),
        noise_dbm=value("noise_dbm"),
        shadowing_db=value("shadowing_db"),
        receive_threshold_db=section.least_snr_db,
        carrier_sense_db=value("carrier_sense_db"),
        wall_loss_db=section.wall_loss_db,
        spatial_shadowing_db=value("spatial_shadowing_db"),
        decorrelation_distance=section.decorrelation_distance,
    )
