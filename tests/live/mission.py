"""A mission as a child of the test, with its own children, which tests kill and stop."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from onehop.checking import judge
from onehop.drivers.replay import replay
from onehop.wire.log_reader import LogFile
from tests.onehop.scenes import FIELD

DEADLINE_S = 120.0

PATIENCE_S = 60.0
"""How long what should be so at once may take on a busy machine."""

CREEPING = ("robot.leader_speed=0.05", "clock.limit_s=600")
"""Settings of a mission that lasts as long as a test needs it: 12,000 ticks, and nobody arrives."""

STARTED: "list[Mission]" = []
"""Missions of the test that runs: what it leaves running ends with it (conftest.py)."""


class Mission:
    """`onehop run` of the small scene in a child, with its log growing in `out`.

    It draws no figure and adds no viewer layer, unless the options say so: they take as long as a start.

    shell: what a shell does before, such as `ulimit`. options: of the command. within: what the command
    is started by, such as `ip netns exec`. environment: added to ours. scenario: another one's file.
    """

    def __init__(
        self,
        folder: Path,
        *settings: str,
        shell: str = "",
        options: Sequence[str] = (),
        within: Sequence[str] = (),
        environment: Mapping[str, str] | None = None,
        scenario: Path | None = None,
    ) -> None:
        self.out = folder / "out"
        if scenario is None:
            scenario = folder / "field.toml"
            scenario.write_text(FIELD)
        command = [
            sys.executable,
            "-m",
            "onehop",
            "run",
            str(scenario),
            "--json",
            "--no-view",
            "--no-figure",
            "--out",
            str(self.out),
            *options,
        ]
        for setting in settings:
            command += ["--set", setting]
        command = [*within, *command]
        if shell:
            command = ["bash", "-c", f'{shell}; exec "$@"', "bash", *command]
        self.child = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            env={**os.environ, **(environment or {})},
        )
        STARTED.append(self)

    def finish(self) -> dict[str, Any]:
        """The summary; the child's own end is part of what is tested."""
        return self.finish_and_say()[0]

    def finish_and_say(self) -> tuple[dict[str, Any], str]:
        """The summary, and what was said on stderr."""
        printed, said = self.child.communicate(timeout=DEADLINE_S)
        assert printed, said
        return json.loads(printed), said

    def await_line(self, pattern: str) -> None:
        """Wait until the mission says something, on stderr."""
        assert self.child.stderr is not None
        for line in self.child.stderr:
            if re.search(pattern, line):
                return
        raise AssertionError(f"nothing was said of {pattern!r}")

    def children(self) -> dict[str, int]:
        """Processes of the mission by name, from the process table: what `ps` would show."""
        found: dict[str, int] = {}
        for entry in Path("/proc").iterdir():
            try:
                words = (entry / "cmdline").read_text().split("\0") if entry.name.isdigit() else []
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1]) if words else 0
            except OSError:
                continue
            if parent == self.child.pid and len(words) > 1:
                name = words[words.index("-m") + 1] if "-m" in words else words[1]
                if name == "robot_agent":
                    name += f" {words[words.index('--id') + 1]}"
                found[name] = int(entry.name)
        return found

    def await_child(self, name: str) -> int:
        """The process id of a child, as soon as it has been started."""
        deadline = time.monotonic() + DEADLINE_S
        while (pid := self.children().get(name)) is None:
            assert time.monotonic() < deadline
            assert self.child.poll() is None
        return pid

    def end_s(self) -> float:
        """When the mission was over, as its summary says (time.time() [s])."""
        return (self.out / "summary.json").stat().st_mtime

    def stop(self) -> dict[str, Any]:
        """Ctrl-C, once the test has seen enough; the summary."""
        self.child.send_signal(signal.SIGINT)
        self.child.communicate(timeout=DEADLINE_S)
        assert self.child.returncode == 128 + signal.SIGINT
        summary: dict[str, Any] = json.loads((self.out / "summary.json").read_text())
        return summary

    def log_bytes(self) -> int:
        """How long the log is by now; -1 if there is none."""
        log = self.out / "mission.mcap"
        return log.stat().st_size if log.exists() else -1

    def await_ticks(self, size: int = 60_000) -> None:
        """Wait until the log has grown: the mission is under way."""
        deadline = time.monotonic() + DEADLINE_S
        while self.log_bytes() <= size:
            assert time.monotonic() < deadline
            assert self.child.poll() is None
            time.sleep(0.005)


def proven(path: Path) -> LogFile:
    """The log of a mission that happens again, tick by tick, and in which every promise held."""
    log = LogFile(path)
    assert replay(log).divergences == 0
    assert judge(log).violations == ()
    return log


def contents(out: Path) -> bytes:
    """All that a mission has written: its files, and what is compressed in its log."""
    files = [path.read_bytes() for path in sorted(out.rglob("*")) if path.is_file()]
    messages = [data for tick in LogFile(out / "mission.mcap").ticks() for _, data in tick.messages]
    return b"\n".join([*files, *messages])


def gone(pids: list[int]) -> bool:
    """Whether all of these processes have ended, or do so in time."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if not any(Path(f"/proc/{pid}").exists() for pid in pids):
            return True
        time.sleep(0.05)
    return False
