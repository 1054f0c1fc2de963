"""What the bridge to ROS 2 costs a mission: its lock-step rate with and without it, in turn.

Prints one JSON object. Nobody listens to the topics, and the bridge is the router of its own; status 77
where the libraries of `onehop[ros2]` are not installed.
"""

import argparse
import importlib.util
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from onehop.mission.processes import free_endpoint

SCENARIO = Path(__file__).parents[1] / "scenarios" / "map1.toml"


def rate(folder: Path, *options: str) -> float:
    """Ticks a second of one mission."""
    command = [sys.executable, "-m", "onehop", "run", str(SCENARIO), "--json", "--no-view", *options]
    done = subprocess.run([*command, "--out", str(folder)], capture_output=True, text=True, check=True)
    return float(json.loads(done.stdout)["ticks_per_s"])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    if importlib.util.find_spec("rosbags") is None or importlib.util.find_spec("xxhash") is None:
        print("pip install 'onehop[ros2]'", file=sys.stderr)
        return 77
    without: list[float] = []
    bridged: list[float] = []
    with tempfile.TemporaryDirectory() as name:
        for _ in range(rounds):
            without.append(rate(Path(name)))
            bridged.append(rate(Path(name), "--ros2", "--ros-router", free_endpoint()))
    result = {
        "rounds": rounds,
        "ticks_per_s": {
            "without": round(statistics.median(without), 1),
            "bridged": round(statistics.median(bridged), 1),
        },
        "ratio_of_each_round": [round(b / a, 3) for a, b in zip(without, bridged, strict=True)],
        "bridged_over_without": round(statistics.median(bridged) / statistics.median(without), 3),
    }
    print(json.dumps(result, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
