"""Shadowing that belongs to places: what stands between two places weakens every frame between them.

M. Gudmundson, "Correlation model for shadow fading in mobile radio systems", Electronics Letters 27(23),
1991: log-normal with the autocorrelation exp(-d / D) over the distance d that one end has moved. When
both move, the factors of both ends multiply (Wang, Tameh and Nix 2008, see plane_waves.py).

It is a field and no process in time: a robot that comes back meets what it left, and two robots side by
side hear a third one alike (P. Agrawal and N. Patwari, "Correlated link shadow fading in multi-hop
wireless networks", IEEE Transactions on Wireless Communications 8(8), 2009). It is a sum of sinusoids
(X. Cai and G. B. Giannakis, "A two-dimensional channel simulation model for shadowing processes", IEEE
Transactions on Vehicular Technology 52(6), 2003). Differs from them: frequencies are drawn out of equal
parts of the spectrum instead of anywhere, so 64 waves do.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from onehop.contracts.randomness import generator
from radio_proxy.core.link_budget import CLIP, LinkBudget
from radio_proxy.core.plane_waves import PlaneWaves, directions, strata

WAVES = 64
"""Autocorrelation of one seed in one direction: within 0.05 (r.m.s.) of the exponential."""

ONE_PLACE = 8.0
"""Ends further apart than so many decorrelation distances are of no account to each other (1e-7)."""


class Shadowing:
    """The shadowing between the stations of a mission. sigma_db: its standard deviation [dB].

    decorrelation: distance that one end moves until the correlation is 1/e [m].
    """

    def __init__(self, stream: np.random.Generator, sigma_db: float, decorrelation: float) -> None:
        first = _wave_vectors(stream, decorrelation)
        second = _wave_vectors(stream, decorrelation)
        self._waves = PlaneWaves(first, second, stream.random(WAVES))
        self._sigma_db = sigma_db
        self._decorrelation = decorrelation
        self._places: list[tuple[float, float]] = []

    def place(self, places: list[tuple[float, float]]) -> None:
        """Where the stations are [m]."""
        self._places = places
        self._waves.place(np.array(places))

    def row_db(self, station: int) -> list[float]:
        """What each station hears `station` stronger by, within +-CLIP standard deviations [dB]."""
        scale, here, row = 1.0 / math.sqrt(WAVES), self._places[station], []
        for there, total in zip(self._places, self._waves.real(station).tolist(), strict=True):
            value = scale * total
            apart = math.dist(here, there) / self._decorrelation
            if apart < ONE_PLACE:  # the two halves of the sum agree, the more the nearer
                value /= math.sqrt(1.0 + elementary.exp(-2.0 * apart))
            row.append(self._sigma_db * min(max(value, -CLIP), CLIP))
        return row


def shadowing(budget: LinkBudget, seed: int) -> Shadowing | None:
    """The shadowing of a mission, if its places have any."""
    if budget.spatial_shadowing_db == 0.0:
        return None
    stream = generator(seed, "shadowing")
    return Shadowing(stream, budget.spatial_shadowing_db, budget.decorrelation_distance)


def _wave_vectors(stream: np.random.Generator, decorrelation: float) -> FloatArray:
    """Wave vectors (2, WAVES) whose field has the autocorrelation exp(-d / decorrelation) [turns/m].

    Its spectrum over the plane is (1 + (k D)^2)^(-3/2), so a share u of it lies below
    k D = sqrt(1 / (1 - u)^2 - 1).
    """
    rest = 1.0 - strata(stream, WAVES)
    radii = np.sqrt(1.0 / (rest * rest) - 1.0) / (2.0 * math.pi * decorrelation)
    return radii * directions(stream, WAVES)
