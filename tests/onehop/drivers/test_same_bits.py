"""A mission has one digest, whichever instructions the processor has."""

import json
import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

from onehop.analysis import open_log
from onehop.contracts.team import Mode, Shape
from tests.onehop.scenes import field

MAP3 = Path(__file__).parents[3] / "scenarios" / "map3.toml"

LIKE_AN_OLD_PROCESSOR = {
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL",
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
    "NUMBA_CPU_NAME": "generic",
    "OPENBLAS_CORETYPE": "Nehalem",
}
"""Takes FMA and AVX2 from the C library, NumPy, the compiler of the kernels, and BLAS."""

EVERYTHING = """
name = "everything"
seed = 3
faults = [{ kind = "kill", at_s = 50, robots = [3] }]
[map]
width = 50
height = 40
obstacles = [
    # A pocket that is open towards the start: the leader turns round in it, before its followers.
    [[22, 14], [28, 14], [28, 26], [22, 26], [22, 25], [27, 25], [27, 15], [22, 15]],

    # A wall; its passage is 3.5 m wide.
    [[36, 0], [38, 0], [38, 4], [36, 4]],
    [[36, 7.5], [38, 7.5], [38, 40], [36, 40]],

    # A block between followers and their slots.
    [[14, 8], [16, 8], [16, 11], [14, 11]],
]
[start]
x = 8
y = 20
[goal]
x = 46
y = 20
[robot]
# Of the directions that a follower chooses from with this one, 27.345 degrees is among the few whose
# cosine the C library's pow squares in another way without FMA.
laser_fov_deg = 173.31
"""

FADED = """
[radio]
preset = "indoor"
tx_power_dbm = -25.0
fast_fading = "rician"
ambient_doppler_hz = 1.0
"""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        platform.machine() != "x86_64" or platform.libc_ver()[0] != "glibc",
        reason="glibc on x86-64 can be told to do without instructions",
    ),
]


@pytest.fixture(scope="module")
def kernels(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the kernels are kept that are compiled here, for either processor."""
    return tmp_path_factory.mktemp("kernels")


def _digest(scenario: Path, out: Path, kernels: Path, environment: dict[str, str]) -> str:
    command = [
        sys.executable, "-m", "onehop", "run", str(scenario), "--driver", "inline", "--json",
        "--no-view", "--out", str(out),
    ]  # fmt: skip
    settings = os.environ | {"NUMBA_CACHE_DIR": str(kernels)} | environment
    ended = subprocess.run(command, env=settings, capture_output=True, check=True)
    digest: str = json.loads(ended.stdout)["digest"]
    return digest


def _is_the_same(scenario: Path, folder: Path, kernels: Path) -> bool:
    here = _digest(scenario, folder / "here", kernels, {})
    return here == _digest(scenario, folder / "old", kernels, LIKE_AN_OLD_PROCESSOR)


def test_a_mission_has_the_same_digest_without_fma_and_avx(tmp_path: Path, kernels: Path) -> None:
    field(tmp_path)
    assert _is_the_same(tmp_path / "field.toml", tmp_path, kernels)


def test_a_study_map_has_the_same_digest_without_fma_and_avx(tmp_path: Path, kernels: Path) -> None:
    assert _is_the_same(MAP3, tmp_path, kernels)


def test_shadows_and_fades_have_the_same_digest_without_fma_and_avx(
    tmp_path: Path, kernels: Path
) -> None:
    field(tmp_path)
    scenario = tmp_path / "field.toml"
    scenario.write_text(f"{scenario.read_text()}\n{FADED}")
    assert _is_the_same(scenario, tmp_path, kernels)
    losses = open_log(tmp_path / "here" / "mission.mcap").tables("verdicts")["verdicts"]
    assert (losses["status"] == "below threshold").any(), "nothing was in a shadow"


def test_what_a_team_can_do_has_the_same_digest_without_fma_and_avx(
    tmp_path: Path, kernels: Path
) -> None:
    """Followers draw aside for their leader, drive in column and along a border, and elect another."""
    scenario = tmp_path / "everything.toml"
    scenario.write_text(EVERYTHING)
    assert _is_the_same(scenario, tmp_path, kernels)
    tables = open_log(tmp_path / "here" / "mission.mcap").tables("status", "notes")
    status, notes = tables["status"], tables["notes"]
    for mode in (Mode.GIVING_WAY, Mode.NARROW, Mode.BORDER):
        assert status.where(status["mode"] == mode)["v"].max() > 0.3, f"nobody drove while {mode}"
    assert (status["shape"] == Shape.COLUMN).any()
    assert {"narrow", "lost_leader", "elected"} <= set(notes["kind"].tolist())
    assert set(status.where(status["time_s"] > 60.0)["leader"].tolist()) == {4}
