"""Fast fading: many paths between two places that add up or cancel, wavelength by wavelength.

R. H. Clarke, "A statistical theory of mobile-radio reception", Bell System Technical Journal 47(6),
1968: many waves from all sides give a Rayleigh envelope with the autocorrelation J0(2 pi f_D t), f_D
being speed over wavelength. With both ends under way the factors of both multiply (A. S. Akki and
F. Haber, "A statistical model of mobile-to-mobile land communication channel", IEEE Transactions on
Vehicular Technology 35(1), 1986). A line of sight of K times the power of all the rest makes it Rician.

The waves stand in space, so the Doppler shift is whatever the motion makes of them: robots that stand
have a channel that stands, unless people walk about (`ambient_doppler_hz`, J0(2 pi f t) as well). Within
a tick robots move straight from where they were to where they are.

Differs: gains hold for a millisecond, in which 5 m/s are 0.04 wavelengths.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.randomness import generator
from radio_proxy.core.airtime import SPEED_OF_LIGHT
from radio_proxy.core.plane_waves import PlaneWaves, directions, strata

WAVES = 32
GRAIN = 1_000_000
"""Time for which gains hold [ns]."""

DEEPEST = 1e-6
"""Least power gain, -60 dB: a deeper fade is never met in a mission."""


class FastFading:
    """The gains between the stations of a mission. wavelength [m].

    k: power of the line of sight over that of all other paths. ambient: Doppler of what moves besides
    the robots [Hz].
    """

    def __init__(self, stream: np.random.Generator, wavelength: float, k: float, ambient: float) -> None:
        first, second = directions(stream, WAVES), directions(stream, WAVES)
        offset = stream.random(WAVES)
        self._waves = PlaneWaves(first / wavelength, second / wavelength, offset)
        self._shifts = ambient * elementary.circle(strata(stream, WAVES))[0] if ambient else None
        self._wavelength = wavelength
        self._sight = math.sqrt(k / (k + 1.0))
        self._scatter = math.sqrt(0.5 / (WAVES * (k + 1.0)))
        self._before = self._after = np.zeros((0, 2))
        self._start = self._end = 0
        self._grain = -1
        self._places = self._after
        self._rows: dict[int, list[float]] = {}

    def move(
        self, before: list[tuple[float, float]], after: list[tuple[float, float]], start: int, end: int
    ) -> None:
        """From where to where the stations move [m], and from when to when [ns]."""
        self._before, self._after = np.array(before), np.array(after)
        self._start, self._end = start, end
        self._grain = -1

    def row_db(self, station: int, now: int) -> list[float]:
        """What each station hears `station` stronger by at a time [dB]."""
        if now // GRAIN != self._grain:
            self._grain = now // GRAIN
            self._rows = {}
            self._place(GRAIN * self._grain)
        row = self._rows.get(station)
        if row is None:
            row = self._rows[station] = self._compute_row(station)
        return row

    def _compute_row(self, station: int) -> list[float]:
        real, imaginary = (
            self._scatter * self._waves.real(station),
            self._scatter * self._waves.imaginary(station),
        )
        if self._sight:
            apart = self._places - self._places[station]
            sight = elementary.circle(elementary.lengths(apart[:, 0], apart[:, 1]) / self._wavelength)
            real, imaginary = real + self._sight * sight[0], imaginary + self._sight * sight[1]
        power = np.maximum(real * real + imaginary * imaginary, DEEPEST)
        return [10.0 * elementary.log10(one) for one in power.tolist()]

    def _place(self, time: int) -> None:
        length = self._end - self._start
        share = min(max(time - self._start, 0), length) / length if length else 1.0
        self._places = self._before + share * (self._after - self._before)
        self._waves.place(self._places, None if self._shifts is None else self._shifts * (time / 1e9))


def fast_fading(section: RadioSection, seed: int) -> FastFading | None:
    """The fast fading of a mission, if it has any."""
    if section.fast_fading == "none":
        return None
    k, wavelength = rician_k(section), SPEED_OF_LIGHT / section.frequency_hz
    return FastFading(generator(seed, "fast fading"), wavelength, k, section.ambient_doppler_hz)


def rician_k(section: RadioSection) -> float:
    """Power of the line of sight over that of all other paths; 0 under Rayleigh fading."""
    if section.fast_fading == "rician":
        return elementary.power_of_ten(section.rician_k_db / 10.0)
    return 0.0
