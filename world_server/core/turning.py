"""Sine and cosine for the compiled kernels, the same bits on every processor.

A compiled `math.sin` calls the C library, which picks its code by the processor (see
`onehop.contracts.elementary`). These are the polynomials of FreeBSD's msun (k_sin.c, k_cos.c, Sun
Microsystems 1993), made of +, - and * only, which the compiler neither reorders nor fuses.
"""

import math

from onehop.contracts.kernels import kernel

_RIGHT_ANGLES = 2.0 / math.pi
_QUARTER = 1.57079632673412561417
_QUARTER_REST = 6.07710050650619224932e-11
"""pi/2 in two parts, the first of 33 bits: its product with a small whole number is exact."""


@kernel()
def direction(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle below 10^5 rad in size, each within 2e-16."""
    quarters = math.floor(angle * _RIGHT_ANGLES + 0.5)
    x = (angle - quarters * _QUARTER) - quarters * _QUARTER_REST
    z = x * x
    sine = x + x * z * (
        -1.66666666666666324348e-01
        + z * (8.33333333332248946124e-03
        + z * (-1.98412698298579493134e-04
        + z * (2.75573137070700676789e-06
        + z * (-2.50507602534068634195e-08
        + z * 1.58969099521155010221e-10))))
    )  # fmt: skip
    cosine = 1.0 - (0.5 * z - z * z * (
        4.16666666666666019037e-02
        + z * (-1.38888888888741095749e-03
        + z * (2.48015872894767294178e-05
        + z * (-2.75573143513906633035e-07
        + z * (2.08757232129817482790e-09
        + z * -1.13596475577881948265e-11))))
    ))  # fmt: skip
    quadrant = int(quarters) & 3
    if quadrant == 0:
        return cosine, sine
    if quadrant == 1:
        return -sine, cosine
    if quadrant == 2:
        return -cosine, -sine
    return sine, -cosine
