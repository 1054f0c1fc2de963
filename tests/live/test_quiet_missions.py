"""Missions in which all goes well say nothing but their progress: not the launcher, not its children."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

MISSIONS = int(os.environ.get("ONEHOP_QUIET_MISSIONS", "200"))
"""How many missions the campaign runs; some seconds each."""

TINY = """
name = "tiny"
[map]
width = 40
height = 40
[start]
x = 8
y = 8
[goal]
x = 30
y = 14
[team]
size = {robots}
[clock]
limit_s = {limit_s}
"""


def _words_of(folder: Path, number: int) -> list[str]:
    """Run a mission of one or two robots and up to eight ticks; all lines that are no progress."""
    scenario, out = folder / f"{number}.toml", folder / f"{number}"
    scenario.write_text(TINY.format(robots=1 + number % 2, limit_s=0.05 * (1 + number % 8)))
    record = "--record" if number % 4 == 0 else "--no-record"
    figure = "--figure" if number == 0 else "--no-figure"
    command = [sys.executable, "-m", "onehop", "run", str(scenario), "--no-view", figure, record]
    result = subprocess.run(
        [*command, "--out", str(out)], capture_output=True, text=True, timeout=60.0, check=False
    )
    assert result.returncode == 1, result.stderr  # the time is up
    assert "digest      none" not in result.stdout
    words = [line for line in result.stderr.splitlines() if not line.startswith("tiny ")]
    for file in (out / "stderr").glob("*"):
        words += [f"{file.name}: {line}" for line in file.read_text().splitlines()]
    return words


@pytest.mark.live
def test_tiny_missions_say_nothing(tmp_path: Path) -> None:
    assert [_words_of(tmp_path, number) for number in range(4)] == [[]] * 4


@pytest.mark.slow
@pytest.mark.campaign
def test_hundreds_of_tiny_missions_say_nothing(tmp_path: Path) -> None:
    assert [words for number in range(MISSIONS) if (words := _words_of(tmp_path, number))] == []
