"""Say how a mission in containers ended, and whether one process logs the same bytes for it."""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

containers = json.loads(Path(sys.argv[1]).read_text())
with tempfile.TemporaryDirectory() as folder:
    command = [sys.executable, "-m", "onehop", "run", sys.argv[2], "--driver", "inline", "--json"]
    command += ["--no-record", "--out", folder]
    asked = subprocess.run(command, capture_output=True, text=True, check=False)
inline = json.loads(asked.stdout)
print(
    f"containers  {containers['outcome']}: {containers['reason']}, {containers['ticks_per_s']} ticks/s"
)
print(f"containers  {containers['digest']}")
print(f"inline      {inline['digest']}")
same = containers["digest"] == inline["digest"] and containers["outcome"] == "arrived"
print("the same bytes" if same else "NOT the same bytes")
sys.exit(0 if same else 1)
