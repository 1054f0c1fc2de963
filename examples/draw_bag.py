"""Draw a moment of a bag as rviz2 would show it: ground, scans, odometry and links, from the bag alone.

    onehop export runs/demo/mission.mcap --to ros2 -o runs/demo/bag
    python examples/draw_bag.py runs/demo/bag --at 60 -o bag.png

It knows nothing of Onehop: the types come with the bag (rosbags reads them), the places of scans from
/tf and /tf_static.
"""

import argparse
import math
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib import pyplot as plt
from rosbags.highlevel import AnyReader

COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#5B5B5B", "#B8A800")
"""Of Okabe and Ito (2008), one after the other for the robots by their numbers."""

Frame = tuple[float, float, float]
"""A frame in another one: x, y [m], heading [rad]."""


class Moment:
    """The newest message of each topic at a time, and the way of every robot until then.

    frames: by child, its parent and its place there.
    """

    def __init__(self, bag: Path, at_s: float) -> None:
        self.newest: dict[str, Any] = {}
        self.frames: dict[str, tuple[str, Frame]] = {}
        self.trails: dict[str, list[tuple[float, float]]] = {}
        with AnyReader([bag]) as reader:
            for connection, _, data in reader.messages(stop=reader.start_time + int(at_s * 1e9) + 1):
                message = reader.deserialize(data, connection.msgtype)
                self.newest[connection.topic] = message
                if connection.topic in ("/tf", "/tf_static"):
                    for one in message.transforms:
                        self.frames[one.child_frame_id] = one.header.frame_id, _frame(one.transform)
                elif connection.topic.endswith("/odom"):
                    x, y, _ = self.in_map(message.child_frame_id)
                    self.trails.setdefault(message.child_frame_id, []).append((x, y))
        self.after_s = at_s

    def in_map(self, frame: str) -> Frame:
        """Where a frame is in the fixed one."""
        x, y, heading = 0.0, 0.0, 0.0
        while frame in self.frames:
            frame, (px, py, turn) = self.frames[frame]
            x, y = (
                px + math.cos(turn) * x - math.sin(turn) * y,
                py + math.sin(turn) * x + math.cos(turn) * y,
            )
            heading += turn
        return x, y, heading

    def points(self, scan: Any) -> npt.NDArray[np.float64]:
        """(n, 2) [m]: where a scan has hit something, in the fixed frame."""
        x, y, heading = self.in_map(scan.header.frame_id)
        angles = heading + scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
        hit = np.isfinite(scan.ranges)
        reach = scan.ranges[hit].astype(np.float64)
        return np.column_stack((x + reach * np.cos(angles[hit]), y + reach * np.sin(angles[hit])))


def _frame(transform: Any) -> Frame:
    place, turn = transform.translation, transform.rotation
    return place.x, place.y, 2.0 * math.atan2(turn.z, turn.w)


def draw(moment: Moment, out: Path) -> None:
    """Write the picture."""
    mpl.use("Agg")
    figure, axes = plt.subplots(figsize=(8.6, 6.6), layout="constrained")
    ground = moment.newest["/map"]
    info = ground.info
    cells = np.reshape(ground.data, (info.height, info.width))
    left, low = info.origin.position.x, info.origin.position.y
    right, high = left + info.width * info.resolution, low + info.height * info.resolution
    axes.imshow(cells, origin="lower", extent=(left, right, low, high), cmap="Greys", vmin=0, vmax=200)
    robots = sorted({topic.split("/")[1] for topic in moment.newest if topic.endswith("/odom")})
    for number, robot in enumerate(robots):
        colour = COLOURS[number % len(COLOURS)]
        base = f"{robot}/base_link"
        axes.plot(*zip(*moment.trails[base], strict=True), color=colour, lw=1.2, alpha=0.7)
        if (scan := moment.newest.get(f"/{robot}/scan")) is not None:
            axes.scatter(*moment.points(scan).T, s=3, color=colour, label=f"/{robot}/scan")
        x, y, heading = moment.in_map(base)
        axes.plot(x, y, "o", color=colour, ms=8, mec="black")
        axes.plot(
            [x, x + 2.0 * math.cos(heading)], [y, y + 2.0 * math.sin(heading)], color="black", lw=1
        )
        if (link := moment.newest.get(f"/{robot}/link")) is not None:
            to_x, to_y, _ = moment.in_map(f"robot_{link.leader}/base_link")
            is_weak = link.throughput_bps < link.threshold_bps
            axes.plot(
                [x, to_x],
                [y, to_y],
                "--" if is_weak else "-",
                color="#B2182B" if is_weak else "#009E73",
                lw=1,
            )
    axes.set(
        xlabel="x [m]",
        ylabel="y [m]",
        title=f"/map, /tf, scan, odom and link after {moment.after_s:.0f} s",
    )
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), markerscale=3, frameon=False)
    figure.savefig(out, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("bag", type=Path, metavar="BAG", help="folder of a rosbag2")
    parser.add_argument("--at", type=float, default=60.0, metavar="SECONDS", help="since its begin")
    parser.add_argument("-o", "--out", type=Path, default=Path("bag.png"), metavar="PNG")
    options = parser.parse_args()
    draw(Moment(options.bag, options.at), options.out)


if __name__ == "__main__":
    main()
