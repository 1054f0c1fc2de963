"""By how much places at one distance differ: the distribution of spatial shadowing and fast fading.

For the tables of `onehop link`. A robot that stands has the gain of its place; only one that moves meets
many. Formulas: normal in dB within the clip of shadowing.py; the power |s + r exp(i phi)|^2 of a line of
sight s and scattered paths r exp(i phi), r^2 exponential (S. O. Rice, Bell System Technical Journal 24,
1945).
"""

import math
from statistics import NormalDist

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.fast_fading import DEEPEST, rician_k
from radio_proxy.core.link_budget import CLIP, LinkBudget

STEPS = 400
"""Quantiles of either distribution."""

PHASES = 16


def place_gains_db(budget: LinkBudget, section: RadioSection) -> FloatArray:
    """Equally likely gains of a place over the mean at its distance, ascending [dB]."""
    shadows, fades = _shadows(budget.spatial_shadowing_db), _fades(section)
    return np.sort((shadows[:, None] + fades).ravel())


def _midpoints() -> list[float]:
    return [(step + 0.5) / STEPS for step in range(STEPS)]


def _shadows(sigma_db: float) -> FloatArray:
    if sigma_db == 0.0:
        return np.zeros(1)
    quantiles = [NormalDist().inv_cdf(share) for share in _midpoints()]
    return sigma_db * np.clip(quantiles, -CLIP, CLIP)


def _fades(section: RadioSection) -> FloatArray:
    if section.fast_fading == "none":
        return np.zeros(1)
    k = rician_k(section)
    radius = np.sqrt([-elementary.log1p(-share) / (k + 1.0) for share in _midpoints()])
    cosines, sines = elementary.circle(np.arange(PHASES) / PHASES)
    along = math.sqrt(k / (k + 1.0)) + radius[:, None] * cosines
    across = radius[:, None] * sines
    power = np.maximum(along * along + across * across, DEEPEST)
    return np.array([10.0 * elementary.log10(one) for one in power.ravel().tolist()])
