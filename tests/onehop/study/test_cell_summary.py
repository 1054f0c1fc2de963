"""What `--json` says of a cell."""

import json

from onehop.study.cell_summary import TOLD, cell, changed
from onehop.study.table import COLUMNS
from tests.onehop.study.rows import row

PROMISED = {
    "seeds", "lost_mean", "lost_ci95", "lost_any", "throughput_mean_bps", "below_threshold_s",
    "ber_mean", "overhead_bytes", "delay_ms",
}  # fmt: skip

ROWS = [row({"policy": "a"}, seed, lost=seed % 2, ber=0.1 * seed) for seed in range(4)] + [
    row({"policy": "b"}, seed, lost=0, ber=0.1 * seed + 0.2) for seed in range(4)
]


def test_a_cell_has_every_promised_key_and_an_interval_for_each_mean() -> None:
    found = cell({"policy": "a"}, ROWS[:4])
    assert found.keys() >= PROMISED
    assert (found["seeds"], found["lost_mean"], found["lost_any"]) == (4, 0.5, 0.5)
    assert found["lost_ci95"][0] < 0.5 < found["lost_ci95"][1]
    for name in TOLD:
        assert len(found[f"{name.removesuffix('_mean')}_ci95"]) == 2
    json.dumps(found, allow_nan=False)


def test_every_measure_is_one_of_a_mission() -> None:
    assert [measure for measure in TOLD.values() if measure not in COLUMNS] == ["lost_any"]


def test_a_change_is_told_like_a_cell() -> None:
    found = changed({"key": "policy"}, ROWS, {"policy": "a"}, {"policy": "b"}, [{}])
    assert found.keys() == {"key", *cell({}, [])}
    assert (found["seeds"], found["lost_mean"]) == (4, -0.5)
    assert abs(found["ber_mean"] - 0.2) < 1e-12
