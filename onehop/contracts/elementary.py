"""Elementary functions that give the same bits on every machine.

+, -, *, / and the square root are exact to the last bit everywhere (IEEE 754); sin, exp and their kin
are not: the C library and NumPy pick other code on a processor with FMA or AVX-512 than without, and
their results differ in the last place. A mission feeds such a result back into itself thousands of
times a second, and its digest would be the processor's.

Here the C library's value is rounded to a coarse grid, on which all libraries agree. Where it lies so
close to the middle between two grid points that they might not, the value is computed anew with 60
decimal digits (Ziv's strategy: ACM Transactions on Mathematical Software 17, 1991).

sin, cos, atan2, log10 are multiples of 2^-36 (0.007 nrad); the others keep 40 significant bits.
Assumed of a library: errors below 4 units in the last place (glibc promises 2, NumPy 4).
`math.hypot`, `math.dist` and `math.remainder` are CPython's own exact arithmetic and need none of this;
`x**2` of floats is the C library's `pow`, and `@` is BLAS: the cores use neither. A probability that is
only compared with a draw may come from anywhere: the last place decides once in 10^15 draws.
"""

import math
from collections.abc import Callable
from decimal import Decimal, localcontext

import numpy as np

from onehop.contracts.arrays import FloatArray

_BITS = 36
_SHIFT = 1.5 * 2.0 ** (52 - _BITS)
"""Adding it and taking it away again rounds what is below 2^15 to a multiple of 2^-36."""

_SURE = 2.0 ** -(_BITS + 1) - 2.0**-48
"""A value that is moved by less lies in the same cell of the grid for every library."""

_SHARE_SHIFT = 1.5 * 2.0**12
_SHARE_SURE = 2.0**-41 - 2.0**-50
"""The same for a mantissa in [1/2, 1) and 40 bits."""


def _series(first: int) -> tuple[float, ...]:
    """Coefficients of cos(pi x) (first 0) or sin(pi x) / x (first 1) in powers of x^2."""
    term = math.pi if first else 1.0
    terms = []
    for power in range(first, 18, 2):
        terms.append(term)
        term *= -math.pi * math.pi / ((power + 1) * (power + 2))
    return tuple(terms)


_HALF_COSINE = _series(0)
_HALF_SINE = _series(1)

_DIGITS = 60
_PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803")


def sin(angle: float) -> float:
    """Sine of an angle [rad]."""
    value = math.sin(angle)
    rounded = (value + _SHIFT) - _SHIFT
    return rounded if abs(value - rounded) < _SURE else _on_grid(_exact_sin, angle)


def cos(angle: float) -> float:
    """Cosine of an angle [rad]."""
    value = math.cos(angle)
    rounded = (value + _SHIFT) - _SHIFT
    return rounded if abs(value - rounded) < _SURE else _on_grid(_exact_cos, angle)


def atan2(y: float, x: float) -> float:
    """Direction of (x, y) in (-pi, pi) [rad]; what is due backwards counts as just left of it."""
    value = math.atan2(y, x)
    rounded = (value + _SHIFT) - _SHIFT
    return rounded if abs(value - rounded) < _SURE else _on_grid(_exact_atan2, y, x)


def log10(x: float) -> float:
    """Decimal logarithm; its size must stay below 16."""
    value = math.log10(x)
    rounded = (value + _SHIFT) - _SHIFT
    return rounded if abs(value - rounded) < _SURE else _on_grid(_exact_log10, x)


def exp(x: float) -> float:
    """e to the power of x."""
    return _settled(math.exp(x), _exact_exp, x)


def power_of_ten(x: float) -> float:
    """10 to the power of x."""
    return _settled(math.pow(10.0, x), _exact_power_of_ten, x)


def log1p(x: float) -> float:
    """Natural logarithm of 1 + x."""
    return _settled(math.log1p(x), _exact_log1p, x)


def expm1(x: float) -> float:
    """exp(x) - 1."""
    return _settled(math.expm1(x), _exact_expm1, x)


def erf(x: float) -> float:
    """Error function."""
    return _settled(math.erf(x), _exact_erf, x)


def sines(angles: FloatArray) -> FloatArray:
    """Sines of angles [rad], (n,)."""
    return _settled_all(np.sin(angles), _exact_sin, angles)


def cosines(angles: FloatArray) -> FloatArray:
    """Cosines of angles [rad], (n,)."""
    return _settled_all(np.cos(angles), _exact_cos, angles)


def directions(y: FloatArray, x: FloatArray) -> FloatArray:
    """Directions of points (x, y), (n,) [rad]; as `atan2`."""
    return _settled_all(np.arctan2(y, x), _exact_atan2, y, x)


def circle(turns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Cosines and sines of angles in whole turns, of any shape, each within 1e-11.

    For the many angles of a sum of waves: Taylor's series of half the angle, products and sums of whole
    arrays, which need no second look.
    """
    x = turns - np.rint(turns)
    z = x * x
    sines = x * _polynomial(z, _HALF_SINE)
    twice = 2.0 * sines
    return 1.0 - twice * sines, twice * _polynomial(z, _HALF_COSINE)


def lengths(x: FloatArray, y: FloatArray) -> FloatArray:
    """Lengths of vectors (x, y), (n,): only a square root, and so right to the last bit."""
    return np.asarray(np.sqrt(x * x + y * y))


def _polynomial(z: FloatArray, coefficients: tuple[float, ...]) -> FloatArray:
    """Horner's scheme. coefficients: of 1, z, z^2, ..."""
    total = coefficients[-1] * z
    for coefficient in coefficients[-2:0:-1]:
        total += coefficient
        total *= z
    total += coefficients[0]
    return total


def _settled(value: float, exact: Callable[[Decimal], Decimal], x: float) -> float:
    """The value with 40 significant bits, by the exact function where it must be."""
    share, exponent = math.frexp(value)
    rounded = (share + _SHARE_SHIFT) - _SHARE_SHIFT
    if abs(share - rounded) >= _SHARE_SURE:
        with localcontext(prec=_DIGITS):
            scaled = exact(Decimal(x)) * Decimal(2) ** (40 - exponent)
            rounded = int(scaled.to_integral_value()) / 2.0**40
    return math.ldexp(rounded, exponent)


def _settled_all(
    values: FloatArray, exact: Callable[..., Decimal], *arguments: FloatArray
) -> FloatArray:
    rounded = (values + _SHIFT) - _SHIFT
    unsure = np.abs(values - rounded) >= _SURE
    if unsure.any():
        for place in np.flatnonzero(unsure).tolist():
            rounded[place] = _on_grid(exact, *(float(each[place]) for each in arguments))
    return rounded


def _on_grid(exact: Callable[..., Decimal], *arguments: float) -> float:
    if any(x != x for x in arguments):
        return math.nan  # no series ends on it
    with localcontext(prec=_DIGITS):
        scaled = exact(*(Decimal(x) for x in arguments)) * 2**_BITS
        return int(scaled.to_integral_value()) / 2.0**_BITS


def _exact_sin(angle: Decimal) -> Decimal:
    """By its series, after whole turns are taken off."""
    angle = angle.remainder_near(2 * _PI)
    return _alternating(angle, angle * angle, 1)


def _exact_cos(angle: Decimal) -> Decimal:
    angle = angle.remainder_near(2 * _PI)
    return _alternating(Decimal(1), angle * angle, 0)


def _alternating(term: Decimal, square: Decimal, power: int) -> Decimal:
    """Series of sine or cosine from its first term, that of x^power, on."""
    total = Decimal(0)
    while total + term != total:
        total += term
        power += 2
        term *= -square / (power * (power - 1))
    return total


def _exact_atan2(y: Decimal, x: Decimal) -> Decimal:
    """One Newton step from the library's value doubles its 16 digits; that is enough."""
    near = Decimal(math.atan2(y, x))
    s, c = _exact_sin(near), _exact_cos(near)
    return near + (y * c - x * s) / (x * c + y * s)


def _exact_log10(x: Decimal) -> Decimal:
    return x.log10()


def _exact_exp(x: Decimal) -> Decimal:
    return x.exp()


def _exact_power_of_ten(x: Decimal) -> Decimal:
    return Decimal(10) ** x


def _exact_log1p(x: Decimal) -> Decimal:
    return (1 + x).ln()


def _exact_expm1(x: Decimal) -> Decimal:
    return x.exp() - 1


def _exact_erf(x: Decimal) -> Decimal:
    """2/sqrt(pi) exp(-x^2) sum of 2^n x^(2n+1) / (2n+1)!! (Abramowitz and Stegun, 7.1.6)."""
    total, term, odd = Decimal(0), x, 1
    while total + term != total:
        total += term
        odd += 2
        term *= 2 * x * x / odd
    return 2 / _PI.sqrt() * (-x * x).exp() * total
