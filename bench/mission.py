"""Whole missions a second: one process, lock-step over processes, and IR-SIM with the same laser.

Prints one JSON object. The peer is measured in the same run, in turns with ours, and medians are taken,
because absolute times on shared machines drift by a factor of two. Without `pip install ir-sim` the
peer's figure is "not installed". IR-SIM moves robots and casts the laser; ours also runs radio, team,
planner and recording.
"""

import argparse
import contextlib
import io
import json
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

from onehop.drivers import inline
from onehop.mission import launcher
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.wire.journal import Journal
from onehop.wire.log_writer import LogWriter
from onehop.wire.output_folder import claimed

SCENARIO = Path(__file__).parents[1] / "scenarios" / "map1.toml"
ROUNDS = 3
PEER_STEPS = 300
LIDAR = {"name": "lidar2d", "range_min": 0, "range_max": 10, "angle_range": 3.14, "number": 181}


def one_process(bundle: Bundle, folder: Path, record: bool) -> float:
    """Ticks a second of the inline driver."""
    log = LogWriter(folder / "inline.mcap", bundle, "inline") if record else None
    journal = Journal(log.write) if log is not None else None
    started = time.perf_counter()
    outcome = inline.run(bundle, journal)
    if log is not None:
        log.close(None)
    return outcome.ticks / (time.perf_counter() - started)


def processes(scenario: Path, settings: list[str], bundle: Bundle, folder: Path, record: bool) -> float:
    """Ticks a second of the lock-step driver, from the first tick to the last."""
    arguments = launcher.world_arguments(scenario, settings, None, None, None, None)
    with claimed(folder) as claim:
        plan = launcher.plan(bundle, arguments, folder, claim, record)
        return float(launcher.run(plan, lambda _: None)["ticks_per_s"])


def ir_sim(bundle: Bundle, folder: Path) -> float | None:
    """Steps a second of IR-SIM with as many robots, the same map, laser and period."""
    try:
        import irsim
    except ImportError:
        return None
    section = bundle.scenario.map
    count = len(bundle.scenario.team.robots)
    world = {
        "world": {"width": section.width, "height": section.height, "step_time": 0.05},
        "robot": [
            {
                "number": count,
                "distribution": {"name": "manual"},
                "kinematics": {"name": "diff"},
                "shape": [{"name": "circle", "radius": 0.2}],
                "state": [[8 + 2 * (i % 3), 8 + 2 * (i // 3), 0.7] for i in range(count)],
                "goal": [[90, 90, 0]] * count,
                "sensors": [LIDAR],
            }
        ],
        "obstacle": [
            {"shape": {"name": "polygon", "vertices": [list(p) for p in corners]}}
            for corners in section.obstacles
        ],
    }
    path = folder / "world.yaml"
    path.write_text(json.dumps(world))  # JSON is YAML
    with contextlib.redirect_stdout(io.StringIO()):
        scene = irsim.make(str(path), headless=True, log_level="ERROR")
        import numpy as np

        twists = [np.array([[1.0], [0.05]]) for _ in range(count)]
        scene.step(twists, list(range(count)))
        started = time.perf_counter()
        for _ in range(PEER_STEPS):
            scene.step(twists, list(range(count)))
        rate = PEER_STEPS / (time.perf_counter() - started)
        scene.end()
    return rate


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenario", type=Path, default=SCENARIO)
    parser.add_argument("--robots", type=int, default=6)
    parser.add_argument("--limit", type=float, default=120.0, help="simulated seconds")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    options = parser.parse_args()
    settings = [f"team.size={options.robots}", f"clock.limit_s={options.limit}"]
    bundle = scenario_file.load(options.scenario, settings)
    rates: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        inline.run(scenario_file.load(options.scenario, [settings[0], "clock.limit_s=1"]), None)
        for _ in range(options.rounds):
            for key, rate in {
                "inline_recording": one_process(bundle, folder, True),
                "inline": one_process(bundle, folder, False),
                "lockstep_recording": processes(options.scenario, settings, bundle, folder, True),
                "lockstep": processes(options.scenario, settings, bundle, folder, False),
                "ir_sim": ir_sim(bundle, folder),
            }.items():
                if rate is not None:
                    rates.setdefault(key, []).append(rate)
    medians = {key: round(statistics.median(values), 1) for key, values in rates.items()}
    result: dict[str, Any] = {
        "robots": options.robots,
        "rounds": options.rounds,
        "ticks_per_s": medians,
        "recording_share": round(1 - medians["inline_recording"] / medians["inline"], 3),
    }
    if "ir_sim" in medians:
        ratio = medians["inline_recording"] / medians["ir_sim"]
        result["inline_recording_over_ir_sim"] = round(ratio, 2)
    else:
        result["ir_sim"] = "not installed"
    print(json.dumps(result, indent=1))


main()
