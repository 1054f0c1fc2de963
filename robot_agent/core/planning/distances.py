"""Squared distances of many points from many points and segments, in single precision.

These matrices are most of a planning moment. They are computed relative to their first point, so that
single precision is enough anywhere on a map, and in place: allocating fresh ones costs more than filling
them.
"""

import numpy as np
import numpy.typing as npt

from onehop.contracts.arrays import FloatArray

Float32Array = npt.NDArray[np.float32]

BLOCK = 16384
"""Elements worked on at once: 64 KB stay in the cache and off the page allocator."""


def squared_distances(a: FloatArray, b: FloatArray) -> Float32Array:
    """All squared distances between (n, 2) and (m, 2) points, (n, m) float32 [m2]."""
    if not len(a) or not len(b):
        return np.empty((len(a), len(b)), dtype=np.float32)
    single_a, single_b = (a - a[0]).astype(np.float32), (b - a[0]).astype(np.float32)
    dx: Float32Array = single_a[:, :1] - single_b[:, 0]
    dy = single_a[:, 1:] - single_b[:, 1]
    dx *= dx
    dy *= dy
    dx += dy
    return dx


def squared_segment_distances(a: FloatArray, b: FloatArray, points: FloatArray) -> Float32Array:
    """Squared distances of (m, 2) points from segments a[i]-b[i], (n, m) float32 [m2]."""
    result = np.empty((len(a), len(points)), dtype=np.float32)
    if not result.size:
        return result
    ax, ay = (a - a[0]).astype(np.float32).T
    bx, by = (b - a[0]).astype(np.float32).T
    ox, oy = (points - a[0]).astype(np.float32).T.copy()
    dx, dy = bx - ax, by - ay
    over_length2 = np.float32(1.0) / np.maximum(dx * dx + dy * dy, np.float32(1e-9))
    rows = max(1, BLOCK // len(points))
    for low in range(0, len(a), rows):
        part = slice(low, low + rows)
        px = np.subtract(ox, ax[part, None], out=result[part])
        py = oy - ay[part, None]
        t = px * dx[part, None]
        work = py * dy[part, None]
        t += work
        t *= over_length2[part, None]
        np.clip(t, 0.0, 1.0, out=t)
        px -= np.multiply(t, dx[part, None], out=work)
        py -= np.multiply(t, dy[part, None], out=work)
        px *= px
        py *= py
        px += py
    return result
