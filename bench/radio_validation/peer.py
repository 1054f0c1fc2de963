"""ns-3 as a process of its own interpreter: which one has the wheel, and runs that are sent to it."""

import contextlib
import json
import subprocess
import threading
from pathlib import Path
from typing import Any

NOT_INSTALLED = 77
"""Exit status when there is no ns-3: "skipped", as test drivers of Automake read it."""

WORKER = Path(__file__).with_name("ns3_worker.py")
_VERSION = "from importlib.metadata import version; import ns3; print(version('ns3'))"


def installed(python: str) -> str | None:
    """The version of ns-3 that an interpreter has, None without."""
    try:
        found = subprocess.run(
            [python, "-P", "-c", _VERSION], capture_output=True, text=True, check=False
        )
    except OSError:
        return None
    return found.stdout.strip() or None


class Ns3:
    """One worker, started when it is first needed and again after a run that killed it."""

    def __init__(self, python: str, patience_s: float = 900.0) -> None:
        self._python = python
        self._patience_s = patience_s
        self._process: subprocess.Popen[str] | None = None

    def simulate(self, run: dict[str, Any]) -> dict[str, Any]:
        """What the worker answers; {"error": ...} when it dies of the run or takes too long."""
        if self._process is None:
            self._process = subprocess.Popen(
                [self._python, str(WORKER)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,  # cppyy names symbols that it does without
                text=True,
            )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        overdue = threading.Timer(self._patience_s, self._process.kill)
        overdue.start()
        try:
            self._process.stdin.write(json.dumps(run) + "\n")
            self._process.stdin.flush()
            answer = self._process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        finally:
            overdue.cancel()
        if answer:
            said: dict[str, Any] = json.loads(answer)
            return said
        status = self._process.wait()
        self._process = None
        return {"error": f"ns-3 ended with status {status}"}

    def close(self) -> None:
        """End the worker."""
        if self._process is not None:
            assert self._process.stdin is not None
            with contextlib.suppress(BrokenPipeError):
                self._process.stdin.close()
            self._process.wait()
            self._process = None
