"""One laser scan, side by side: our kernel, numpy brute force, and embreex if it is installed.

Scans of 181 beams, 180 degrees, 10 m, from random free poses on a map of 100 m x 100 m with 200 and with
2000 wall segments. Prints one JSON object. Run from the repository: python bench/laser.py
"""

import importlib.util
import json
import math
import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from onehop.contracts.arrays import FloatArray
from onehop.contracts.sections import MapSection, Point, RobotSection
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from world_server.core.laser import Laser

BODY = RobotSection()
SIDE = 100.0
BATCH = 50
BUDGET_S = 2.0


def blocks(count: int, size: float, random: np.random.Generator) -> tuple[tuple[Point, ...], ...]:
    """Squares with `size` metres a side, turned and placed at random."""
    corners = size * np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    polygons = []
    for _ in range(count):
        angle = random.uniform(0.0, math.tau)
        c, s = math.cos(angle), math.sin(angle)
        centre = random.uniform(size, SIDE - size, 2)
        square = corners @ np.array([[c, s], [-s, c]]) + centre
        polygons.append(tuple((float(x), float(y)) for x, y in square))
    return tuple(polygons)


def free_poses(walls: WallMap, random: np.random.Generator) -> FloatArray:
    """BATCH random poses clear of walls, (BATCH, 3)."""
    poses = random.uniform((0.0, 0.0, -math.pi), (SIDE, SIDE, math.pi), (20 * BATCH, 3))
    return poses[walls.free(poses[:, :2], BODY.radius)][:BATCH]


def brute_force(segments: FloatArray, pose: FloatArray, fan: FloatArray) -> FloatArray:
    """Every beam against every segment, (n_beams,) [m]."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    ray = fan @ np.array([[c, s], [-s, c]])
    start, run = segments[:, :2] - pose[:2], segments[:, 2:] - segments[:, :2]
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = ray[:, None, 0] * run[None, :, 1] - ray[:, None, 1] * run[None, :, 0]
        reach = (start[:, 0] * run[:, 1] - start[:, 1] * run[:, 0])[None, :] / turn
        along = (start[None, :, 0] * ray[:, None, 1] - start[None, :, 1] * ray[:, None, 0]) / turn
    hit = (reach >= 0.0) & (reach <= BODY.laser_range) & (along >= 0.0) & (along <= 1.0)
    nearest: FloatArray = np.where(hit, reach, math.inf).min(axis=1)
    return nearest


def embree(segments: FloatArray, poses: FloatArray, fan: FloatArray) -> Callable[[], object] | None:
    """A batch of scans by embreex (every wall two upright triangles), or None if it is not installed."""
    if importlib.util.find_spec("embreex") is None:
        return None
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    x0, y0, x1, y1 = segments.T.astype(np.float32)
    low, high = np.full_like(x0, -1.0), np.full_like(x0, 1.0)
    a, b = np.stack((x0, y0, low), 1), np.stack((x1, y1, low), 1)
    c, d = np.stack((x1, y1, high), 1), np.stack((x0, y0, high), 1)
    scene = rtcore_scene.EmbreeScene()
    mesh = TriangleMesh(scene, np.concatenate((np.stack((a, b, c), 1), np.stack((a, c, d), 1))))
    angles = np.arctan2(fan[:, 1], fan[:, 0])[None, :] + poses[:, 2:]
    rays = np.stack((np.cos(angles), np.sin(angles), np.zeros_like(angles)), 2).reshape(-1, 3)
    origins = np.repeat(np.column_stack((poses[:, :2], np.zeros(len(poses)))), len(fan), axis=0)
    rays, origins = rays.astype(np.float32), origins.astype(np.float32)
    limits = np.full(len(rays), BODY.laser_range, dtype=np.float32)
    assert mesh is not None
    return lambda: scene.run(origins, rays, limits, query="DISTANCE")


def scan_us(batch: Callable[[], object], scans: int) -> float:
    """Best time of one scan over the batches that fit into BUDGET_S [us]: the least disturbed one."""
    batch()
    best, end = math.inf, time.perf_counter() + BUDGET_S
    while time.perf_counter() < end:
        begin = time.perf_counter()
        batch()
        best = min(best, time.perf_counter() - begin)
    return best / scans * 1e6


def compare(name: str, count: int, size: float) -> dict[str, object]:
    random = np.random.default_rng(7)
    obstacles = blocks(count, size, random)
    walls = load_map(MapSection(width=SIDE, height=SIDE, obstacles=obstacles), {})
    poses = free_poses(walls, random)
    looking: npt.NDArray[np.int32] = np.arange(len(poses), dtype=np.int32)
    half = math.radians(BODY.laser_fov_deg) / 2.0
    angles = np.linspace(-half, half, BODY.laser_beams)
    fan = np.column_stack((np.cos(angles), np.sin(angles)))
    laser = Laser(walls, BODY)
    alone = RobotSection(radius=1e-9)
    exact = np.array([brute_force(walls.segments, pose, fan) for pose in poses])
    found = Laser(walls, alone).scans(poses, looking)
    both = np.isfinite(exact) & np.isfinite(found)
    ours = scan_us(lambda: laser.scans(poses, looking), len(poses))
    peer = embree(walls.segments, poses, fan)
    embree_us = None if peer is None else scan_us(peer, len(poses))
    numpy_us = scan_us(lambda: [brute_force(walls.segments, pose, fan) for pose in poses], len(poses))
    return {
        "map": name,
        "segments": len(walls.segments),
        "batch": len(poses),
        "onehop_us": round(ours, 2),
        "numpy_brute_us": round(numpy_us, 1),
        "embreex_us": "not installed" if embree_us is None else round(embree_us, 2),
        "times_numpy": round(numpy_us / ours, 1),
        "times_embreex": "not installed" if embree_us is None else round(embree_us / ours, 1),
        "beams_that_differ": int((np.isfinite(exact) != np.isfinite(found)).sum()),
        "largest_difference_m": float(np.abs(exact[both] - found[both]).max()),
    }


if __name__ == "__main__":
    rows = [compare("200 segments", 49, 4.0), compare("2000 segments", 499, 2.0)]
    print(json.dumps({"bench": "laser", "beams": BODY.laser_beams, "rows": rows}, indent=2))
