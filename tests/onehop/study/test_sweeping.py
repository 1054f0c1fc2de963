"""A sweep in its folder: paired, gone on with, no row twice. Missions of a second, in this process."""

import json
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest

from onehop.campaign.lines import Row
from onehop.campaign.workers import Crash, Done
from onehop.contracts.errors import InputError
from onehop.scenario import scenario_file
from onehop.study.grid import axis, cells
from onehop.study.mission import Keep
from onehop.study.sweeping import LOGS, ROWS, TABLE, Sweep, Wanted
from tests.onehop.scenes import FIELD

SHORT = ("clock.limit_s=0.5",)


class Heard:
    """What a progress display is told."""

    def __init__(self) -> None:
        self.before = -1
        self.rows: list[Row] = []

    def begin(self, before: int) -> None:
        self.before = before

    def show(self, row: Row) -> None:
        self.rows.append(row)


def here(work: Callable[[Any], Any], items: Iterable[Any]) -> Iterator[Done[Any, Any]]:
    """Works in this process."""
    return (Done(item, work(item)) for item in items)


def backwards(work: Callable[[Any], Any], items: Iterable[Any]) -> Iterator[Done[Any, Any]]:
    """Works in another order."""
    return here(work, reversed(list(items)))


def stopping_after(count: int) -> Callable[..., Iterator[Done[Any, Any]]]:
    """Works until somebody stops it."""

    def run(work: Callable[[Any], Any], items: Iterable[Any]) -> Iterator[Done[Any, Any]]:
        for number, item in enumerate(items):
            if number == count:
                raise KeyboardInterrupt
            yield Done(item, work(item))

    return run


def crashing_at(name: str) -> Callable[..., Iterator[Done[Any, Any]]]:
    """Works, but for one mission."""

    def run(work: Callable[[Any], Any], items: Iterable[Any]) -> Iterator[Done[Any, Any]]:
        for item in items:
            yield Done(item, Crash("its process died") if item.name == name else work(item))

    return run


def wanted(
    folder: Path, over: str = "gains.k_rho_min=0.5,1", seeds: range = range(1, 4), *settings: str,
    keep: Keep = "none",
) -> Wanted:  # fmt: skip
    path = folder / "field.toml"
    path.write_text(FIELD)
    every = [*SHORT, *settings]
    base = scenario_file.load(path, every)
    return Wanted([base], cells(path, every, [axis(over)], seeds[0]), seeds, keep)


def rows_of(folder: Path) -> list[Row]:
    return [json.loads(line) for line in (folder / ROWS).read_text().splitlines()[1:]]


def test_every_cell_has_the_same_seeds_and_each_mission_a_row(tmp_path: Path) -> None:
    heard = Heard()
    one = Sweep(wanted(tmp_path), tmp_path, here, heard)
    summary = one.run()
    assert [(row["values"]["gains.k_rho_min"], row["seed"]) for row in one.rows] == [
        (0.5, 1), (0.5, 2), (0.5, 3), (1.0, 1), (1.0, 2), (1.0, 3),
    ]  # fmt: skip
    assert len({row["digest"] for row in one.rows}) == 6
    assert (heard.before, len(heard.rows), one.run_now) == (0, 6, 6)
    assert summary["missions"] == summary["wanted"] == 6
    assert summary["missions_per_s"] > 0
    assert [cell["seeds"] for cell in summary["cells"]] == [3, 3]
    assert json.loads((tmp_path / "sweep.json").read_text()) == summary


@pytest.mark.parametrize("count", [0, 1, 4])
def test_what_was_stopped_is_gone_on_with_and_no_row_is_there_twice(tmp_path: Path, count: int) -> None:
    first = Sweep(wanted(tmp_path), tmp_path, stopping_after(count), Heard())
    with pytest.raises(KeyboardInterrupt):
        first.run()
    assert len(first.rows) == count
    assert first.summary is not None
    assert first.summary["missions"] == count
    heard = Heard()
    again = Sweep(wanted(tmp_path), tmp_path, here, heard)
    resumed = again.run()
    assert (heard.before, again.run_now) == (count, 6 - count)
    assert sorted(row["name"] for row in rows_of(tmp_path)) == sorted(row["name"] for row in again.rows)
    assert len({row["name"] for row in again.rows}) == 6
    whole = tmp_path / "whole"
    whole.mkdir()
    straight = Sweep(wanted(tmp_path), whole, here, Heard())
    assert straight.run()["cells"] == resumed["cells"]
    assert again.rows == straight.rows


def test_the_order_in_which_missions_end_changes_nothing(tmp_path: Path) -> None:
    found = []
    for name, run in (("a", here), ("b", backwards)):
        (tmp_path / name).mkdir()
        one = Sweep(wanted(tmp_path), tmp_path / name, run, Heard())
        summary = one.run()
        table = (tmp_path / name / TABLE).read_bytes() if summary["table"] else b""
        found.append((one.rows, summary["cells"], summary["differences"], table))
    assert found[0] == found[1]


def test_missions_come_seed_by_seed(tmp_path: Path) -> None:
    orders = wanted(tmp_path).orders(tmp_path)
    assert [order.bundle.scenario.seed for order in orders] == [1, 1, 2, 2, 3, 3]


def test_more_values_and_more_seeds_are_added_to_what_there_is(tmp_path: Path) -> None:
    Sweep(wanted(tmp_path), tmp_path, here, Heard()).run()
    more = Sweep(wanted(tmp_path, "gains.k_rho_min=0.2,0.5,1", range(1, 5)), tmp_path, here, Heard())
    more.run()
    assert (len(more.rows), more.run_now) == (12, 6)
    less = Sweep(wanted(tmp_path, "gains.k_rho_min=1", range(2, 4)), tmp_path, here, Heard())
    rate = less.run()["missions_per_s"]
    assert ([row["seed"] for row in less.rows], less.run_now) == ([2, 3], 0)
    assert rate == 0.0


@pytest.mark.parametrize(
    ("over", "setting", "says"),
    [
        ("gains.k_rho_max=3,4", "team.size=4", "over differ"),
        ("gains.k_rho_min=1", "team.size=3", "scenarios differ"),
    ],
)
def test_rows_of_another_sweep_are_not_mixed_in(tmp_path: Path, over, setting, says) -> None:
    Sweep(wanted(tmp_path), tmp_path, here, Heard()).run()
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir() if file.suffix != ".toml"}
    with pytest.raises(InputError, match=says):
        Sweep(wanted(tmp_path, over, range(1, 4), setting), tmp_path, here, Heard()).run()
    assert {name: (tmp_path / name).read_bytes() for name in before} == before


def test_the_seed_of_the_scenario_is_none_of_the_sweep(tmp_path: Path) -> None:
    Sweep(wanted(tmp_path), tmp_path, here, Heard()).run()
    again = Sweep(
        wanted(tmp_path, "gains.k_rho_min=0.5,1", range(1, 4), "seed=9"), tmp_path, here, Heard()
    )
    again.run()
    assert again.run_now == 0


def test_a_mission_that_crashed_has_no_row_and_is_tried_again(tmp_path: Path) -> None:
    name = "gains.k_rho_min=0.5 seed=2"
    one = Sweep(wanted(tmp_path), tmp_path, crashing_at(name), Heard())
    summary = one.run()
    assert summary["crashed"] == [{"mission": name, "why": "its process died"}]
    assert (summary["missions"], [cell["seeds"] for cell in summary["cells"]]) == (5, [2, 3])
    assert [pair["seeds"] for pair in summary["differences"]] == [2]
    again = Sweep(wanted(tmp_path), tmp_path, here, Heard())
    again.run()
    assert (again.crashed, again.run_now, len(again.rows)) == ([], 1, 6)


def test_each_log_that_is_kept_has_a_name_of_its_own(tmp_path: Path) -> None:
    one = Sweep(wanted(tmp_path, 'name="a b","a_b"', range(1, 3), keep="all"), tmp_path, here, Heard())
    one.run()
    logs = {path.name for path in (tmp_path / LOGS).iterdir()}
    assert logs == {row["log"] for row in one.rows}
    assert len(logs) == 4
