"""Last step of the image: compile what missions compile, and make the folders that volumes take over.

A volume takes the owner of the folder where it is mounted first, so each process's user owns its own.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

SCENARIO = """
[map]
width = 40
height = 40
obstacles = [[[18, 24], [24, 24], [24, 30], [18, 30]]]
[start]
x = 8
y = 8
[goal]
x = 30
y = 14
[clock]
limit_s = 1
"""
"""A mission that compiles every kernel. The image has no scenario of its own: robots know no map."""

user = int(os.environ["USER_ID"])
with tempfile.TemporaryDirectory() as folder:
    scenario = Path(folder) / "trial.toml"
    scenario.write_text(SCENARIO)
    command = [sys.executable, "-m", "onehop", "run", str(scenario), "--driver", "inline"]
    command += ["--no-record", "--out", folder, "--json"]
    status = subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode
    if status not in (0, 1):
        sys.exit(f"a mission cannot be run in this image: exit status {status}")
subprocess.run([sys.executable, "-c", "import onehop.commands.report, onehop.commands.keys"], check=True)
keys = Path("/keys")
owned = [Path("/log"), keys, *(keys / name for name in os.environ["PROCESSES"].split())]
for path in owned:
    path.mkdir(mode=0o700, exist_ok=True)
for path in (*owned, kernels := Path(os.environ["NUMBA_CACHE_DIR"]), *kernels.rglob("*")):
    os.chown(path, user, user)
