"""`onehop study` as people start it: on one core, on two, refused."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from onehop import study
from onehop.study.chapter4.failing import EXPECTED
from onehop.study.chapter4.missions import MAPS
from tests.onehop.command_line import onehop
from tests.onehop.scenes import FIELD

NEAR = FIELD.replace("x = 30\ny = 14", "x = 14\ny = 8").replace("size = 4", "size = 6")
NEAR += "[clock]\nlimit_s = 5.0\n"
"""Six robots, 6 m to go, and not the time for it."""

POLICIES = ("--k-rho-min", "0.3,1", "--hold", "2,8", "--set", "faults[0].at_s=3")


def scenarios(folder: Path) -> Path:
    """A folder like scenarios/thesis, of missions of some seconds."""
    made = folder / "scenarios"
    made.mkdir(exist_ok=True)
    for name in (*MAPS, *EXPECTED):
        (made / f"{name}.toml").write_text(f'profile = "thesis"\n{NEAR}')
    return made


def command(what: str, folder: Path, out: str, *arguments: str) -> list[str]:
    where = ["--scenarios", str(scenarios(folder))]
    if what == "policies":
        where = [str(scenarios(folder) / "map1.toml"), *POLICIES]
    every = [*where, "--out", str(folder / out), "--seeds", "2", "--json", *arguments]
    return [sys.executable, "-m", "onehop", "study", what, *every]


def told(what: str, folder: Path, out: str, *arguments: str) -> dict[str, Any]:
    done = subprocess.run(
        command(what, folder, out, *arguments), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def without_rate(answer: dict[str, Any]) -> dict[str, Any]:
    """What must be the same wherever it is computed."""
    changing = ("missions_per_s", "sim_s_per_s", "table", "page")
    return {key: value for key, value in answer.items() if key not in changing}


@pytest.mark.slow
def test_chapter_4_says_the_same_on_one_core_and_with_dask(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    one = told("thesis", tmp_path, "one", "--jobs", "1")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
    ) as cluster:
        address = cluster.scheduler_address
        dask = told("thesis", tmp_path, "dask", "--dask", address, "--no-figures")
    assert dask["page"] is None
    assert without_rate(one) == without_rate(dask)
    assert (one["missions"], len(one["cells"]), len(one["bounds"])) == (24, 12, 6)
    assert {(cell["map"], cell["routing"], cell["policy"]) for cell in one["cells"]} == {
        (m, r, p) for m in MAPS for r in ("mrsr", "mrdv") for p in ("constant", "throughput")
    }
    page = Path(one["page"]).read_text(encoding="utf-8")
    assert "<script" not in page
    assert "http" not in page
    assert page.count("data:image/png;base64,") == 2 + 3 * 6
    figures = {path.suffix for path in (tmp_path / "one" / "figures").iterdir()}
    assert figures == {".png", ".svg"}


@pytest.mark.slow
def test_the_phase_diagram_is_the_same_on_one_core_and_on_two_and_in_a_notebook(tmp_path: Path) -> None:
    one = told("policies", tmp_path, "one", "--jobs", "1")
    two = told("policies", tmp_path, "two", "--jobs", "2", "--no-figures")
    assert without_rate(one) == without_rate(two)
    assert [(cell["k_rho_min"], cell["hold_s"], cell["policy"]) for cell in one["cells"]] == [
        (k, hold_s, policy)
        for k in (0.3, 1.0)
        for hold_s in (2.0, 8.0)
        for policy in ("constant", "throughput")
    ]
    summary = study.policies(
        scenarios(tmp_path) / "map1.toml", k_rho_min=[0.3, 1], hold_s=[2, 8], seeds=2,
        settings=["faults[0].at_s=3"], out=tmp_path / "one", jobs=1,
    )  # fmt: skip
    assert without_rate(summary) == without_rate(one)
    assert "<script" not in Path(one["page"]).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("thesis", "--scenarios", "nowhere"), "nowhere/map1.toml: no such file"),
        (("thesis", "--seeds", "0"), "--seeds 0: out of range"),
        (("thesis", "--set", "gains.k_rho_min=9"), "gains.k_rho_max"),
        (("policies", "--policies", "constant"), "nothing to compare"),
        (("policies", "--policies", "constant,none"), "gains.policy"),
        (("policies", "--hold", "5,x"), "--hold 5,x: no list of numbers above 0"),
        (("policies", "--k-rho-min", "0"), "--k-rho-min 0"),
        (("policies", "nowhere.toml"), "nowhere.toml"),
    ],
)
def test_what_cannot_be_run_is_one_line(arguments: tuple[str, ...], says: str, tmp_path: Path) -> None:
    done = onehop("study", *arguments, "--out", tmp_path / "out")
    assert (done.returncode, done.stdout) == (2, "")
    assert len(done.stderr.splitlines()) == 1
    assert says in done.stderr
