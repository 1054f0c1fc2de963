"""What is measured while a mission runs is what its log says."""

import math
from pathlib import Path

import numpy as np
import pytest

from onehop.analysis import open_log
from onehop.analysis.connectivity import Pair, is_connected
from onehop.analysis.tables import Table
from onehop.study.mission import MissionOrder, run_mission
from onehop.wire.log_reader import LogFile, digest
from tests.onehop.scenes import field

FAULTS = (
    'faults=[{kind="hold", at_s=8, robots=[1, 2], duration_s=6}, '
    '{kind="cut", at_s=12, robots=[1], duration_s=8}, {kind="kill", at_s=20, robots=[4]}]'
)


def test_the_measures_of_a_mission_are_those_of_its_log(tmp_path: Path) -> None:
    bundle = field(tmp_path, FAULTS)
    path = tmp_path / "kept.mcap"
    row = run_mission(MissionOrder("a", {}, bundle, "all", path, False))
    log, period = open_log(path), bundle.scenario.clock.period_ns / 1e9
    status, poses = log.table("status"), log.table("poses")
    following = (status["leader"] != status["robot"]) & (status["leader"] != 0)
    following &= (status["mode"] != "setup") & (status["mode"] != "stopped")
    followers = status.where(following)
    assert row["throughput_bps"] == pytest.approx(followers["throughput_bps"].mean())
    assert row["error_m"] == pytest.approx(followers["error"].mean())
    below = (followers["throughput_bps"] < followers["threshold_bps"]).sum()
    assert row["below_threshold_s"] == pytest.approx(below * period / 3)
    assert row["below_threshold_s"] > 1.0
    verdicts = log.table("verdicts")
    commands = verdicts.where((verdicts["destination"] != 0) & (verdicts["msdu_bytes"] >= 800))
    arrived = commands.where(commands["status"] == "delivered")
    delay = arrived["arrival_s"] - arrived["offered_s"]
    assert row["delay_ms"] == pytest.approx(1e3 * delay.mean())
    assert row["delivery_ratio"] == pytest.approx(len(arrived) / len(commands))
    assert row["delivery_ratio"] < 1.0
    control = log.table("control")
    assert row["routing_bytes"] == control["bytes"][control["tick"] == control["tick"].max()].sum()
    assert row["driven_m"] == pytest.approx(np.abs(poses["v"]).sum() * period / 4, rel=0.01)
    energy, links = log.table("energy"), log.table("links")
    later = energy.where(energy["tick"] > 0)
    assert row["drive_j"] == pytest.approx(later["drive_j"].sum() / 4)
    assert row["radio_j"] == pytest.approx(later["radio_j"].sum() / 4)
    looks = [links.where(links["tick"] == tick) for tick in np.unique(links["tick"][links["tick"] > 0])]
    whole = [
        is_connected(poses["robot"][poses["tick"] == one["tick"][0]].tolist(), _pairs(one))
        for one in looks
    ]
    assert row["connected_share"] == pytest.approx(np.mean(whole))
    assert 0.0 < row["connected_share"] < 1.0
    ber = [0.5 * math.exp(-(10 ** (snr_db / 10)) / 6400) for snr_db in arrived["snr_db"]]
    assert row["ber"] == pytest.approx(np.mean(ber))
    summary = log.summary
    assert summary is not None
    assert row["digest"] == digest(LogFile(path)) == summary["digest"]
    assert (row["outcome"], row["lost"], row["sim_s"]) == (
        "arrived",
        len(summary["lost"]),
        summary["sim_s"],
    )
    assert row["lost"] >= 1


def _pairs(look: Table) -> list[Pair]:
    return [Pair(*values) for values in look.rows("robot", "other", "snr_db", "linked")]


def test_who_drives_alone_follows_nobody(tmp_path: Path) -> None:
    bundle = field(tmp_path, "team.size=1", "clock.limit_s=6")
    row = run_mission(MissionOrder("a", {}, bundle, "none", tmp_path / "none.mcap", False))
    assert (row["throughput_bps"], row["error_m"], row["delay_ms"]) == (None, None, None)
    assert row["below_threshold_s"] == 0.0
    assert row["driven_m"] == row["led_m"] > 1.0


@pytest.mark.parametrize(
    ("keep", "limit_s", "kept"),
    [("none", 1, False), ("all", 1, True), ("failures", 1, True), ("failures", 900, False)],
)
def test_logs_are_kept_of_whom_it_was_asked(tmp_path: Path, keep, limit_s, kept) -> None:
    bundle = field(tmp_path, f"clock.limit_s={limit_s}", "team.size=2")
    path = tmp_path / "mission.mcap"
    row = run_mission(MissionOrder("a", {}, bundle, keep, path, False))
    assert (row["outcome"], row["lost"]) == (("failed", 2) if limit_s == 1 else ("arrived", 0))
    assert row["log"] == ("mission.mcap" if kept else None)
    assert [file.suffix for file in tmp_path.iterdir()].count(".mcap") == kept
    assert not list(tmp_path.glob("*.part"))
