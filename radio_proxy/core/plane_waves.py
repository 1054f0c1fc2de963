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

    def __init__(self, first: FloatArray, second: FloatArray, offset: FloatArray) -> None:
        self._vectors = np.stack((first, second), axis=1)
        self._offset = offset
        self._places = np.zeros((0, 2))
        self._phasors = np.zeros((0, 4, len(offset)))

    def place(self, places: FloatArray, drift: FloatArray | None = None) -> None:
        """Where the stations are, (stations, 2) [m]. drift: (n,), of the waves in time [turns]."""
        if drift is None and np.array_equal(places, self._places):
            return
        self._places = places
        x, y = places[:, 0, None, None], places[:, 1, None, None]
        turns = x * self._vectors[0] + y * self._vectors[1]
        turns[:, 0] += self._offset if drift is None else self._offset + drift
        self._phasors = np.concatenate(elementary.circle(turns), axis=1)

    def real(self, station: int) -> FloatArray:
        """Real part of h between a station and each, (stations,); its variance is near n.

        Sums are taken in an order that both ends share, here and in the imaginary part.
        """
        u, v, u_sine, v_sine = self._phasors[station]
        products = self._phasors * np.array((v, u, -v_sine, -u_sine))
        waves = (products[:, 0] + products[:, 1]) + (products[:, 2] + products[:, 3])
        return np.asarray(waves.sum(axis=1))

    def imaginary(self, station: int) -> FloatArray:
        """Imaginary part of h between a station and each, (stations,)."""
        products = self._phasors * self._phasors[station, ::-1]
        waves = (products[:, 0] + products[:, 3]) + (products[:, 1] + products[:, 2])
        return np.asarray(waves.sum(axis=1))


def strata(stream: np.random.Generator, count: int) -> FloatArray:
    """Numbers in [0, 1), (count,): one out of each of `count` equal parts, in random order.

    M. D. McKay, R. J. Beckman and W. J. Conover, Technometrics 21(2), 1979: Latin hypercube sampling.
    """
    return (stream.permutation(count) + stream.random(count)) / count


def directions(stream: np.random.Generator, count: int) -> FloatArray:
    """Unit vectors (2, count), from all sides alike."""
    return np.stack(elementary.circle(strata(stream, count)))
