"""What a program imports at its start: a mission has nine of them, and begins when the last is there."""

import json
import subprocess
import sys

import pytest

LARGE = ("PIL", "cattrs", "matplotlib", "numba", "ssl")
"""Libraries of 5 ms and more, each of which somebody needs."""

LOOK = "import json, sys, {module}; print(json.dumps([name for name in {large} if name in sys.modules]))"


@pytest.mark.parametrize(
    ("module", "needed"),
    [
        ("robot_agent.process", []),
        ("radio_proxy.process", []),
        ("onehop.recorder", ["cattrs"]),
        ("world_server.process", ["cattrs", "numba"]),
    ],
)
def test_a_program_starts_without_what_others_need(module: str, needed: list[str]) -> None:
    look = LOOK.format(module=module, large=LARGE)
    done = subprocess.run([sys.executable, "-c", look], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == needed
