"""What each part of the gain policy `predictive` is worth: the policy without it, over the same seeds.

    python bench/predictive_parts.py --seeds 5 --k-rho-min 0.3 --hold 20

The missions are those of docs/policies.md: scenarios/thesis/mapN.toml, where all followers stand still
from 60 s on. Prints a table in Markdown: means of the measures of `onehop sweep`, and in brackets paired
differences from the whole policy with their 95 % intervals.
"""

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from onehop.scenario import scenario_file
from onehop.study.mission import MissionOrder, run_mission
from onehop.study.statistics import estimate
from robot_agent.core import robot
from robot_agent.core.motion.aim import Aim, Point, Report, Situation
from robot_agent.core.motion.predictive import PredictiveGain

SCENARIOS = Path(__file__).parents[1] / "scenarios" / "thesis"
MEASURES = {
    "lost": ("lost", 1.0), "throughput_bps": ("kb/s", 1e3), "below_threshold_s": ("below s", 1.0),
    "error_m": ("error m", 1.0), "drive_j": ("driving kJ", 1e3), "radio_j": ("card J", 1.0),
}  # fmt: skip


class WithoutAim(PredictiveGain):
    """Drives to where the slot was, with the gain of the throughput: neither aims nor keeps pace."""

    def aim(self, situation: Situation) -> Aim:
        gain = self._k_rho if situation.driving else self._gains.k_rho_max
        return Aim(situation.slot, gain)


class WithoutKeepingPace(PredictiveGain):
    """Aims ahead, and lags."""

    def aim(self, situation: Situation) -> Aim:
        gain = self._k_rho if situation.driving else self._gains.k_rho_max
        return super().aim(situation)._replace(k_rho=gain)


class WithoutHurryingEarly(PredictiveGain):
    """Hurries below the threshold only, as the thesis does."""

    def heard(self, throughput_bps: float, threshold_bps: float) -> float:
        low = throughput_bps < threshold_bps
        self._k_rho = self._gains.k_rho_max if low else self._gains.k_rho_min
        return self._k_rho


class WithoutFrontier(PredictiveGain):
    """Its leader never slows."""

    def pace(self, here: Point, reports: Mapping[int, Report]) -> float:  # noqa: ARG002 (the interface)
        return 1.0


POLICIES: dict[str, type[PredictiveGain]] = {
    "all of it": PredictiveGain,
    "neither aims ahead nor keeps pace": WithoutAim,
    "does not keep pace": WithoutKeepingPace,
    "does not hurry early": WithoutHurryingEarly,
    "leader never slows": WithoutFrontier,
}


def missions(options: argparse.Namespace, policy: Callable[..., PredictiveGain]) -> list[dict[str, Any]]:
    """The rows of one policy, by seed."""
    vars(robot)["make_policy"] = policy
    hold = f'{{kind="hold", at_s=60, robots=[1, 2, 4, 5, 6], duration_s={options.hold}}}'
    rows = []
    for seed in range(1, options.seeds + 1):
        settings = [
            f"seed={seed}", "gains.policy=predictive", f"gains.k_rho_min={options.k_rho_min}",
            "clock.limit_s=450", f"faults=[{hold}]",
        ]  # fmt: skip
        bundle = scenario_file.load(SCENARIOS / f"map{options.map}.toml", settings)
        rows.append(run_mission(MissionOrder("", {}, bundle, "none", Path("none.mcap"), False)))
    return rows


def cell(rows: list[dict[str, Any]], whole: list[dict[str, Any]], name: str, scale: float) -> str:
    """Mean, and what it is more than that of the whole policy."""
    mean = sum(row[name] for row in rows) / len(rows) / scale
    if rows is whole:
        return f"{mean:.3g}"
    more = estimate([(row[name] - own[name]) / scale for row, own in zip(rows, whole, strict=True)])
    return f"{mean:.3g} ({more.mean:+.2g} [{more.low:.2g}, {more.high:.2g}])"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--map", type=int, default=1)
    parser.add_argument("--k-rho-min", type=float, default=0.3, help="low gain [1/s]")
    parser.add_argument("--hold", type=float, default=20.0, help="how long followers stand [s]")
    options = parser.parse_args()
    print("| predictive |", " | ".join(heading for heading, _ in MEASURES.values()), "|")
    print("|---" * (len(MEASURES) + 1) + "|")
    whole: list[dict[str, Any]] = []
    for words, policy in POLICIES.items():
        rows = missions(options, policy)
        whole = whole or rows
        cells = (cell(rows, whole, name, scale) for name, (_, scale) in MEASURES.items())
        print(f"| {words} |", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main()
