"""What the examples promise, measured from a log: python examples/measure.py LOG

Everything is taken from ground truth and from what the radio delivered, nothing from what programs say
of themselves.
"""

import struct
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from onehop.analysis import open_log
from onehop.analysis.log import Log
from onehop.maps.map_file import load_map

UNDER_WAY = 0.3
"""Mean speed of a flock that is on its way [m/s]."""

CONNECTED_S = 2.0
"""A rover is connected while the latest word of the base that it has is no older [s]."""

SWATH = 2.0
"""A place is covered once a robot has been this near [m]."""

HULL = 0.35
"""Ground that is nearer to a wall is nobody's to cover [m]."""


def polarisation(log: Log) -> NDArray[np.float64]:
    """Length of the mean of all unit headings in each tick in which the robots are on their way.

    It is 1 when all head in one direction. On their way: their mean speed is above UNDER_WAY.
    """
    poses = log.table("poses")
    own = [poses.of(robot) for robot in log.robots]
    headings, speeds = (np.array([one[name] for one in own]) for name in ("heading", "v"))
    together = np.hypot(np.cos(headings).mean(axis=0), np.sin(headings).mean(axis=0))
    return np.asarray(together[speeds.mean(axis=0) > UNDER_WAY])


def spread(log: Log) -> NDArray[np.float64]:
    """Mean distance of the robots from their middle, tick by tick [m]."""
    poses = log.table("poses")
    places = np.array([[poses.of(robot)[axis] for axis in "xy"] for robot in log.robots])
    return np.asarray(np.hypot(*np.moveaxis(places - places.mean(axis=0), 1, 0)).mean(axis=0))


def connected(log: Log) -> float:
    """Share of the ticks in which the rover has a word of the base that is not too old."""
    ticks, rover = len(log.table("poses").of(log.robots[-1])), log.robots[-1]
    period_s = log.scenario.clock.period_ms / 1000.0
    heard = log.table("receptions").of(rover)
    latest = np.full(ticks, -np.inf)
    for tick, payload in zip(heard["tick"].tolist(), heard["payload"], strict=True):
        (said,) = struct.unpack_from("<i", payload)
        latest[tick] = max(latest[tick], said)
    age_s = (np.arange(ticks) - np.maximum.accumulate(latest)) * period_s
    return float((age_s <= CONNECTED_S).mean())


def covered(log: Log) -> NDArray[np.float64]:
    """Share of the ground that has been covered, tick by tick."""
    ground = log.scenario.map
    x, y = np.meshgrid(np.arange(0.5, ground.width), np.arange(0.5, ground.height))
    cells = np.column_stack((x.ravel(), y.ravel()))
    cells = cells[load_map(ground, {}).clearance(cells) > HULL]
    poses = log.table("poses")
    ticks = len(poses.of(log.robots[0]))
    first = np.full(len(cells), ticks)
    for robot in log.robots:
        own = poses.of(robot)
        for tick, at in enumerate(np.column_stack((own["x"], own["y"]))[::5]):
            near = np.hypot(*(cells - at).T) < SWATH
            first[near] = np.minimum(first[near], 5 * tick)
    return np.asarray(np.searchsorted(np.sort(first), np.arange(ticks), side="right") / len(cells))


def main(path: Path) -> None:
    log = open_log(path)
    match log.scenario.team.program:
        case "flocking:Flocking":
            together, apart = polarisation(log), spread(log)
            whole = f"mean {together.mean():.3f}" if len(together) else "they never were"
            print(f"polarisation under way      {whole}")
            print(f"mean distance from middle   {apart[0]:.1f} m at first, {apart[-1]:.1f} m at last")
        case "relay:Relay":
            print(f"rover connected             {100.0 * connected(log):.2f} % of the ticks")
        case "mapless:Mapless":
            share = covered(log)
            period_s = log.scenario.clock.period_ms / 1000.0
            enough = int(np.searchsorted(share, 0.95))
            after = f"after {enough * period_s:.0f} s" if enough < len(share) else "never"
            print(f"covered to 95 %             {after}")
            for seconds in (45, 90, 135, 180):
                tick = min(len(share), round(seconds / period_s)) - 1
                print(f"covered after {seconds:3} s         {100.0 * share[tick]:.1f} %")
        case other:
            sys.exit(f"{path}: a mission of {other}, which promises nothing here")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
