"""What two published data sets say of links: `python bench/measured.py [--kth DIR] [--orbit DIR]`, JSON.

DIR of --kth has the walks as *.datalog (R. Parasuraman, S. Caccamo, F. Baberg and P. Ogren, CRAWDAD
kth/rss, 2016; five of them in github.com/herolab-uga/indoor-rssi-mobile-robot). A robot with five
receivers drives through a hall of 20 x 26 m with rooms; the access point is where it is said to be, or
where it fits best.

DIR of --orbit has a folder for each level of noise (S. Kaul, M. Gruteser and I. Seskar, CRAWDAD
rutgers/noise, 2007; in github.com/sensorlab/link-quality-estimation, datasets/trace1_Rutgers/data). Each
file is one link: number and RSSI of every frame that came, of 300 sent every 100 ms.
"""

import argparse
import itertools
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from onehop.contracts.arrays import FloatArray

COLUMNS = range(15, 20)
"""Of the five receivers' unfiltered RSSI; columns 3 and 4 are the place [m]."""

STATED = (9.0, 0.0)
"""Where the access point is, by the data set [m]."""

STEP = 0.1
"""Spacing of the readings that are used [m of way]."""

FRAMES = 300
NO_RSSI = 128


def fit(distance: FloatArray, rss: FloatArray) -> tuple[float, FloatArray]:
    """Path loss exponent by least squares, and what is left of each reading [dB]."""
    loss = -10.0 * np.log10(np.maximum(distance, 1.0))
    exponent, intercept = np.polyfit(loss, rss, 1)
    return float(exponent), rss - exponent * loss - intercept


def decorrelation(rest: FloatArray) -> float:
    """Way after which the autocorrelation has fallen below 1/e [m]."""
    rest = rest - rest.mean()
    for lag in range(1, len(rest)):
        if (rest[lag:] * rest[:-lag]).mean() < rest.var() / math.e:
            return round(lag * STEP, 1)
    return math.nan


def walk(file: Path) -> dict[str, Any]:
    """Exponent, sigma and decorrelation of each receiver on one walk, for two places of the sender."""
    lines = (line.split() for line in file.read_text().splitlines()[1:])
    table = np.array([[float(word) for word in line[:20]] for line in lines if len(line) >= 20])
    steps = np.hypot(np.diff(table[:, 3]), np.diff(table[:, 4]))
    way = np.concatenate(([0.0], np.cumsum(steps)))
    table = table[np.unique(np.searchsorted(way, np.arange(0.0, way[-1], STEP)))]
    readings = []
    for column in COLUMNS:
        mine = table[table[:, column] < 0.0]
        readings.append((mine[:, 3], mine[:, 4], mine[:, column]))

    def fits(place: tuple[float, float]) -> list[tuple[float, FloatArray]]:
        return [fit(np.hypot(x - place[0], y - place[1]), rss) for x, y, rss in readings]

    def left(place: tuple[float, float]) -> float:
        return sum(float(rest.var()) for _, rest in fits(place))

    places = itertools.product(np.arange(-20.0, 30.5, 0.5), np.arange(-20.0, 20.5, 0.5))
    found: dict[str, Any] = {"way_m": round(float(way[-1]), 1)}
    for name, place in (("as stated", STATED), ("fitted", min(places, key=left))):
        found[name] = {
            "access_point": [float(each) for each in place],
            "exponents": [round(exponent, 2) for exponent, _ in fits(place)],
            "sigmas_db": [round(float(rest.std()), 1) for _, rest in fits(place)],
            "decorrelation_m": [decorrelation(rest) for _, rest in fits(place)],
        }
    return found


def grid(folder: Path) -> dict[str, Any]:
    """Shares of good, grey and dead links at one level of noise, and how their losses follow."""
    ratios, memories, scatter = [], [], []
    for file in sorted(path for path in folder.rglob("*") if path.is_file()):
        lines = (line.split() for line in file.read_text().splitlines())
        frames = [(int(line[0]), int(line[1])) for line in lines if len(line) == 2]
        came = [(number, rssi) for number, rssi in frames if rssi != NO_RSSI and number < FRAMES]
        received = np.zeros(FRAMES)
        received[[number for number, _ in came]] = 1.0
        ratios.append(float(received.mean()))
        if 0.1 < ratios[-1] < 0.9:
            memories.append(float(np.corrcoef(received[1:], received[:-1])[0, 1]))
        if ratios[-1] >= 0.9:
            scatter.append(float(np.std([rssi for _, rssi in came])))
    found = np.array(ratios)
    return {
        "links": len(found),
        "good": round(float((found >= 0.9).mean()), 3),
        "grey": round(float(((found > 0.1) & (found < 0.9)).mean()), 3),
        "dead": round(float((found <= 0.1).mean()), 3),
        "correlation_of_losses_at_100_ms": round(float(np.median(memories)), 3),
        "scatter_of_rssi_db": round(float(np.median(scatter)), 2),
    }


def main() -> None:
    """Print what the data sets that are there say."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kth", type=Path)
    parser.add_argument("--orbit", type=Path)
    options = parser.parse_args()
    report: dict[str, Any] = {}
    if options.kth is not None:
        report["walks"] = {file.stem: walk(file) for file in sorted(options.kth.glob("*.datalog"))}
    if options.orbit is not None:
        report["noise"] = {each.name: grid(each) for each in sorted(options.orbit.iterdir())}
    print(json.dumps(report, indent=1))


if __name__ == "__main__":
    main()
