"""`onehop sweep` as people start it: on one core, on two, on Dask; killed, stopped, refused."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from onehop import study
from onehop.study.sweeping import ROWS, TABLE
from tests.onehop.command_line import onehop
from tests.onehop.scenes import FIELD

OVER = ("--over", "gains.k_rho_min=0.3,1", "--over", "faults[0].duration_s=2,8")
HOLD = ("--set", 'faults=[{kind="hold", at_s=8, robots=[1, 2]}]')


def command(folder: Path, *arguments: str) -> list[str]:
    """The command of the small scene."""
    (folder / "field.toml").write_text(FIELD)
    return [sys.executable, "-m", "onehop", "sweep", str(folder / "field.toml"), *arguments]


def sweep(folder: Path, *arguments: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(command(folder, *arguments), capture_output=True, text=True, check=False)


def told(done: "subprocess.CompletedProcess[str]") -> dict[str, Any]:
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def names(folder: Path) -> list[str]:
    return [json.loads(line)["name"] for line in (folder / ROWS).read_text().splitlines()[1:]]


@pytest.mark.slow
def test_one_job_two_jobs_and_dask_say_the_same(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    pytest.importorskip("polars")
    found = []
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
    ) as cluster:
        for name, how in (
            ("one", ("--jobs", "1")),
            ("two", ("--jobs", "2")),
            ("dask", ("--dask", cluster.scheduler_address)),
        ):
            out = ("--out", str(tmp_path / name), "--json")
            answer = told(sweep(tmp_path, *OVER, *HOLD, "--seeds", "2", *how, *out))
            assert answer["table"] == str(tmp_path / name / TABLE)
            found.append((answer["cells"], answer["differences"], Path(answer["table"]).read_bytes()))
    assert found[0] == found[1] == found[2]
    assert [cell["seeds"] for cell in found[0][0]] == [2, 2, 2, 2]
    assert len({cell["error_m_mean"] for cell in found[0][0]}) == 4


@pytest.mark.slow
def test_a_notebook_gets_a_table(tmp_path: Path) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    over = {"gains.policy": ["constant", "throughput"], "team.spacing": [3, 4.0]}
    for _ in range(2):
        missions = study.sweep(
            tmp_path / "field.toml",
            over,
            out=tmp_path / "out",
            seeds=2,
            jobs=2,
            settings=["clock.limit_s=9"],
        )
        assert len(missions) == 8
        assert missions["team.spacing"].tolist() == [3.0, 3.0, 4.0, 4.0] * 2
        assert missions.differences()[0]["against"] == "constant"


@pytest.mark.slow
def test_a_table_for_people_has_each_cell_and_each_difference(tmp_path: Path) -> None:
    limit = ("--set", "clock.limit_s=2")
    done = sweep(
        tmp_path, "--over", "team.spacing=3,4", *limit, "--seeds", "2", "--out", str(tmp_path / "out")
    )
    assert done.returncode == 0, done.stderr
    assert "spacing against 3.0, seed by seed" in done.stdout
    assert "missions    4" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--over", "gains.k_rho_min=1,9"), "--over gains.k_rho_min=9"),
        (("--over", "team.sise=3"), "did you mean size?"),
        (("--over", "team.size="), "--over team.size="),
        (("--seeds", "0"), "--seeds 0: out of range"),
        (("--keep", "some"), "--keep"),
        (("--jobs", "0"), "--jobs"),
        (("--set", "team.size=0"), "team.size"),
        pytest.param(
            ("--dask", "tcp://127.0.0.1:1"), "--dask tcp://127.0.0.1:1", marks=pytest.mark.slow
        ),
    ],
)
def test_what_cannot_be_run_is_one_line(arguments: tuple[str, ...], says: str, tmp_path: Path) -> None:
    done = onehop(*command(tmp_path, *arguments)[3:], "--out", tmp_path / "out")
    assert (done.returncode, done.stdout) == (2, "")
    assert len(done.stderr.splitlines()) == 1
    assert says in done.stderr


@pytest.mark.slow
def test_without_polars_one_line_says_how_to_get_it_and_the_rows_stay(tmp_path: Path) -> None:
    arguments = command(
        tmp_path, "--set", "clock.limit_s=1", "--seeds", "1", "--out", str(tmp_path / "out")
    )
    hidden = "import sys, runpy; sys.modules['polars'] = None; sys.argv = sys.argv[1:]; "
    program = [sys.executable, "-c", hidden + "runpy.run_module('onehop', run_name='__main__')"]
    done = subprocess.run(
        [*program, *arguments[2:], "--json"], capture_output=True, text=True, check=False, cwd=Path.cwd()
    )
    assert told(done)["table"] is None
    assert done.stderr.count("pip install 'onehop[tables]'") == 1
    assert len(names(tmp_path / "out")) == 1
