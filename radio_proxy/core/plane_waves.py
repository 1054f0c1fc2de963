"""A sum of plane waves over the places of both ends of a link: a fixed field that needs no memory.

h(a, b) = sum over n of exp(i (u_n(a) + v_n(b))) + exp(i (u_n(b) + v_n(a))), u and v being the phases
of a wave at one end and the other. A link is the same from either end, a place is the same whoever
comes there, and each end alone decorrelates it by the spectrum of its waves: Z. Wang, E. K. Tameh and
A. R. Nix, "Joint shadowing process in urban peer-to-peer radio channels", IEEE Transactions on
Vehicular Technology 57(1), 2008, who found that displacements of the two ends have an independent and
equal effect on the correlation, and who also build the process out of sinusoids.

A pair costs a few products: cosines are taken for each station and not for each pair.
"""

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray


class PlaneWaves:
    """The waves of a field, and what they are where the stations stand.

    first, second: (2, n) wave vectors at either end [turns/m]; offset: (n,) phases [turns].
    """

    def __init__(self, first: FloatArray, second: FloatArray, offset: FloatArray, stations: int) -> None:
        self._vectors = np.concatenate((first, second), axis=1)
        self._offset = offset
        self._waves = len(offset)
        self._places = np.full((stations, 2), np.nan)
        self._cosines = np.zeros((stations, 2 * self._waves))
        self._sines = np.zeros((stations, 2 * self._waves))

    def place(self, places: FloatArray, drift: FloatArray | None = None) -> None:
        """Where the stations are, (stations, 2) [m]. drift: (n,), of the waves in time [turns]."""
        moved = (places != self._places).any(axis=1)
        offset = self._offset
        if drift is not None:
            moved[:] = True
            offset = offset + drift
        self._places[moved] = places[moved]
        turns = places[moved, :1] * self._vectors[0] + places[moved, 1:] * self._vectors[1]
        turns[:, : self._waves] += offset
        self._cosines[moved], self._sines[moved] = elementary.circle(turns)

    def real(self, station: int) -> FloatArray:
        """Real part of h between a station and each, (stations,); its variance is near n."""
        return self._both_ways(self._cosines, self._cosines, station) - self._both_ways(
            self._sines, self._sines, station
        )

    def imaginary(self, station: int) -> FloatArray:
        """Imaginary part of h between a station and each, (stations,)."""
        return self._both_ways(self._cosines, self._sines, station) + self._both_ways(
            self._sines, self._cosines, station
        )

    def _both_ways(self, first: FloatArray, second: FloatArray, station: int) -> FloatArray:
        """Sum of the products of the first wave at one end and the second at the other, and back."""
        n = self._waves
        there = first[:, :n] * second[station, n:]
        back = second[:, n:] * first[station, :n]
        return np.asarray((there + back).sum(axis=1))


def strata(stream: np.random.Generator, count: int) -> FloatArray:
    """Numbers in [0, 1), (count,): one out of each of `count` equal parts, in random order.

    M. D. McKay, R. J. Beckman and W. J. Conover, Technometrics 21(2), 1979: Latin hypercube sampling.
    """
    return (stream.permutation(count) + stream.random(count)) / count


def directions(stream: np.random.Generator, count: int) -> FloatArray:
    """Unit vectors (2, count), from all sides alike."""
    return np.stack(elementary.circle(strata(stream, count)))
