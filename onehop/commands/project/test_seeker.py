"""The mission arrives, and happens again: run with pytest."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent


def onehop(*words: str) -> dict[str, Any]:
    done = subprocess.run(
        [sys.executable, "-m", "onehop", *words, "--json"], cwd=FOLDER, capture_output=True, text=True
    )
    assert done.stdout, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def test_everybody_arrives_and_touches_nothing(tmp_path: Path) -> None:
    inline = onehop("run", "mission.toml", "--driver", "inline", "--out", str(tmp_path))
    assert inline["arrived"] == [1, 2, 3, 4, 5]
    assert inline["collisions"] == 0
    assert onehop("replay", inline["log"])["divergences"] == 0


def test_processes_write_the_same_bytes(tmp_path: Path) -> None:
    digests = {
        onehop("run", "mission.toml", "--driver", driver, "--out", str(tmp_path / driver))["digest"]
        for driver in ("inline", "processes")
    }
    assert len(digests) == 1
