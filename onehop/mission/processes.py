"""The processes of one mission: children of the launcher, started, restarted, ended."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from onehop.contracts import topics
from onehop.node.bus import make_credentials
from onehop.node.startup import CREDENTIALS_VARIABLE, PASSWORD_VARIABLE
from onehop.wire.summary import Process

GRACE_S = 3.0
"""Time between asking the children to end and killing them."""


def free_endpoint() -> str:
    """A TCP endpoint on loopback that nobody listens on right now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


class ProcessGroup:
    """All children of one mission. Leaving the context ends every one of them.

    Each gets its own password through its environment, a lifeline that ends it when this process dies,
    and a file in `logs` for what it says on stderr.
    """

    def __init__(self, endpoint: str, mission: str, robots: Sequence[int], folder: Path) -> None:
        self._endpoint = endpoint
        self._mission = mission
        self._folder = folder
        names = [topics.RADIO, topics.RECORDER, topics.OPERATOR, *map(topics.robot_name, robots)]
        self._passwords = make_credentials(names)
        self._lifeline, self._keep_open = os.pipe()
        self.children: dict[str, subprocess.Popen[bytes]] = {}
        self.processes: list[Process] = []

    def __enter__(self) -> "ProcessGroup":
        return self

    def __exit__(self, *_: object) -> None:
        self.end()
        os.close(self._keep_open)
        os.close(self._lifeline)

    @property
    def operator_password(self) -> str:
        return self._passwords[topics.OPERATOR]

    def start_world(self, arguments: Sequence[str]) -> None:
        self._start(topics.WORLD, "world_server", [*arguments, "--listen", self._endpoint])

    def start_radio(self) -> None:
        self._start(topics.RADIO, "radio_proxy", ["--connect", self._endpoint])

    def start_recorder(self, out: Path, with_file: bool) -> None:
        arguments = ["--connect", self._endpoint, "--out", str(out)]
        self._start(topics.RECORDER, "onehop.recorder", arguments + ([] if with_file else ["--no-file"]))

    def start_robot(self, robot: int) -> None:
        arguments = ["--id", str(robot), "--connect", self._endpoint]
        self._start(topics.robot_name(robot), "robot_agent", arguments)

    def _start(self, name: str, module: str, arguments: Sequence[str]) -> None:
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        if name in self._passwords:
            environment[PASSWORD_VARIABLE] = self._passwords[name]
        else:
            words = (f"{user}:{password}" for user, password in self._passwords.items())
            environment[CREDENTIALS_VARIABLE] = " ".join(words)
        command = [sys.executable, "-m", module, "--mission", self._mission]
        with (self._folder / f"{name}.stderr").open("ab") as stderr:
            child = subprocess.Popen(
                [*command, "--lifeline", str(self._lifeline), *arguments],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=stderr,
                pass_fds=(self._lifeline,),
                env=environment,
                start_new_session=True,
            )
        self.children[name] = child
        self.processes.append(Process(name, child.pid))

    def died(self, name: str) -> bool:
        """Whether a child has ended."""
        return self.children[name].poll() is not None

    def last_words(self, name: str) -> str:
        """The last line that a child said on stderr."""
        lines = (self._folder / f"{name}.stderr").read_text(errors="replace").strip().splitlines()
        return lines[-1] if lines else "it said nothing"

    def end(self) -> None:
        """Ask every child that still runs to end, then kill what does not."""
        for send, wait_s in ((signal.SIGTERM, GRACE_S), (signal.SIGKILL, GRACE_S)):
            running = [child for child in self.children.values() if child.poll() is None]
            for child in running:
                child.send_signal(send)
            _wait(running, wait_s)

    def await_end(self, seconds: float) -> None:
        """Give the children time to end by themselves."""
        _wait(list(self.children.values()), seconds)


def _wait(children: Sequence[subprocess.Popen[bytes]], seconds: float) -> None:
    deadline = time.monotonic() + seconds
    for child in children:
        try:
            child.wait(max(0.0, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            return
