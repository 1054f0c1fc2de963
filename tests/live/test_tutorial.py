"""docs/tutorial.md, as somebody new types it: a fresh environment, an empty folder, every command."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from onehop.analysis import open_log

pytestmark = [pytest.mark.live, pytest.mark.slow]

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "tutorial.md"
NO_INDEX = re.compile(r"No matching distribution|Could not find a version|Failed to establish|timed out")
PATIENCE_S = 1800.0


def commands() -> str:
    """Every command of the page; what is installed is what CI has tested."""
    blocks = re.findall(r"```sh\n(.*?)```", PAGE.read_text(), flags=re.S)
    assert len(blocks) >= 7
    return "".join(blocks)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where all commands have been run, one after the other, by a shell that stops at a mistake."""
    home = tmp_path_factory.mktemp("home")
    (home / "onehop").symlink_to(ROOT)
    work = home / "work"
    work.mkdir()
    own = {
        name: os.environ[name]
        for name in os.environ
        if name.startswith(("PIP_", "SSL_", "http", "HTTP"))
    }
    cache = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    tools = home / "bin"
    tools.mkdir()
    (tools / "python3").symlink_to(getattr(sys, "_base_executable", sys.executable))
    done = subprocess.run(
        ["bash", "-euxo", "pipefail", "-c", commands()],
        cwd=work,
        env={
            **own,
            "HOME": str(home),
            "PATH": f"{tools}:/usr/bin:/bin",
            "LANG": "C.UTF-8",
            "PIP_CACHE_DIR": f"{cache}/pip",
            "PIP_CONSTRAINT": str(ROOT / "constraints.txt"),
            "PIP_NO_COMPILE": "1",
        },
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    (work / "said.txt").write_text(done.stdout)
    if done.returncode and NO_INDEX.search(done.stderr) and not (work / "my_robots").exists():
        pytest.skip("no package index here: nothing can be installed")
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return work


def test_every_command_of_the_page_does_what_it_should(folder: Path) -> None:
    for name in ("first", "second", "broken"):
        assert (folder / "runs" / name / "report" / "report.html").exists()
    said = (folder / "said.txt").read_text()
    assert "0 divergences: every message is the same, byte for byte" in said
    assert "the same bytes every time, in one process and in many" in said
    assert (folder / "runs" / "second" / "report" / "values.png").exists()
    shown = {run: values_of(folder / "runs" / run / "mission.mcap") for run in ("first", "second")}
    assert shown["second"] - shown["first"] == {"nearest"}


def values_of(log: Path) -> set[str]:
    """Names of what its programs show."""
    return set(open_log(log).table("values")["name"].tolist())


def test_what_was_installed_is_no_checkout(folder: Path) -> None:
    python = folder / "venv" / "bin" / "python"
    where = subprocess.run(
        [python, "-c", "import onehop; print(onehop.__file__)"],
        cwd=folder, capture_output=True, text=True, check=True, env={},
    ).stdout  # fmt: skip
    assert Path(where.strip()).is_relative_to(folder / "venv")
