"""Plugins that are installed, in a mission of processes."""

import json
from pathlib import Path

import pytest

from tests.onehop.command_line import in_shell as onehop
from tests.onehop.plugins.conftest import parts
from tests.onehop.plugins.package import MODULE
from tests.onehop.scenes import field, log_of

__all__ = ["parts"]

pytestmark = pytest.mark.live

ALL = (
    "planner.kind=beeline", "gains.policy=steady", "radio.routing=deaf", "radio.propagation=flat",
    "clock.limit_s=4",
)  # fmt: skip


def run_of(folder: Path) -> tuple[str | Path, ...]:
    """The command that runs the small scene."""
    return "run", folder / "field.toml", "--json", "--no-view", "--no-figure", "--out", folder / "out"


def test_processes_find_what_is_installed_and_write_the_same_bytes(parts: Path, tmp_path: Path) -> None:
    digest = log_of(field(tmp_path, *ALL), tmp_path / "inline.mcap")
    wanted = [word for setting in ALL for word in ("--set", setting)]
    done = onehop(*run_of(tmp_path), *wanted, PYTHONPATH=str(parts))
    assert json.loads(done.stdout)["digest"] == digest, done.stderr


def test_radio_and_robots_look_in_the_folder_of_the_scenario_too(tmp_path: Path) -> None:
    (tmp_path / "own_part.py").write_text(MODULE)
    wanted = ("gains.policy=own_part:Steady", "radio.propagation=own_part:Flat", "clock.limit_s=2")
    digest = log_of(field(tmp_path, *wanted), tmp_path / "inline.mcap")
    settings = [word for setting in wanted for word in ("--set", setting)]
    done = onehop(*run_of(tmp_path), *settings)
    assert json.loads(done.stdout)["digest"] == digest, done.stderr
