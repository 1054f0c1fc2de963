"""Robots with a real base in a scenario: what a mission with one must be, in one line each."""

from pathlib import Path

import pytest

from onehop.contracts.errors import ScenarioError
from onehop.drivers import inline
from onehop.scenario import scenario_file
from onehop.scenario.as_toml import as_toml
from tests.onehop.scenes import field

REAL_TIME = 'clock.mode="realtime"'
REAL = 'robots=[{id=3, base="hardware"}, {id=2, base="hardware", base_command=["python", "d.py"]}]'


def test_bases_are_known_by_robot_with_what_starts_their_drivers(tmp_path: Path) -> None:
    scenario = field(tmp_path, REAL_TIME, REAL).scenario
    assert scenario.bases == {2: ("python", "d.py"), 3: ()}
    assert list(scenario.bases) == [2, 3]
    assert field(tmp_path).scenario.bases == {}
    written = tmp_path / "again.toml"
    written.write_text(as_toml(scenario))
    assert scenario_file.load(written).scenario.bases == scenario.bases


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ((REAL,), r"robots\[0\].base: a real base goes by the wall clock; clock.mode = \"realtime\""),
        ((REAL, REAL_TIME, "clock.speed=2.0"), r"robots\[0\].base: a real base goes by the wall clock"),
        (
            (REAL_TIME, 'robots=[{id=2, base="wheels"}]'),
            r"robots\[0\].base: 'wheels' is unknown; one of",
        ),
        (
            (REAL_TIME, 'robots=[{id=2, base_command=["d"]}]'),
            r"base_command: a simulated base has no dri",
        ),
        (
            (REAL_TIME, 'robots=[{id=2, base="hardware", base_command=[""]}]'),
            "base_command: names no pro",
        ),
        (
            (REAL_TIME, REAL, 'faults=[{kind="kidnap", at_s=1, robots=[3], x=9, y=9}]'),
            r"faults\[0\].robots: robot 3 has a real base: nobody can put it elsewhere; a robot",
        ),
    ],
)
def test_what_cannot_be_is_one_line(tmp_path: Path, settings: tuple[str, ...], why: str) -> None:
    with pytest.raises(ScenarioError, match=why):
        field(tmp_path, *settings)


def test_one_process_has_no_real_base(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="one process has no real time"):
        inline.run(field(tmp_path, REAL_TIME, REAL), None)
