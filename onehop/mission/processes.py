"""The processes of one mission: children of the launcher, started, restarted, watched, ended."""

import os
import resource
import shutil
import signal
import socket
import subprocess
import sys
import time
import uuid
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from onehop.contracts import topics
from onehop.contracts.errors import InputError
from onehop.contracts.operation import Death
from onehop.contracts.printable import printable
from onehop.mission.placement import Placement
from onehop.node.identity import Identity, make_credentials
from onehop.node.startup import (
    CREDENTIALS_VARIABLE,
    PASSWORD_VARIABLE,
    PROGRAM_FAILED,
    WORLD_IS_GONE,
    certificate,
)
from onehop.programs.host import ACCOUNT_LINES
from onehop.wire.summary import Process

GRACE_S = 3.0
"""Time between asking the children to end and killing them [s]."""

LAST_WORDS = 300
"""Characters of a child's last line that are repeated where its death is told."""

OPEN_FILES = 48
"""Descriptors that the world needs beside one for each of its clients; it has 11 when all goes well, and
reads its modules' files before."""


def require_descriptors(clients: int) -> None:
    """See that the world can hold a connection to each client, as far as this user may decide.

    Raises InputError when the hard limit is too low.
    """
    needed = OPEN_FILES + clients
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard != resource.RLIM_INFINITY and hard < needed:
        raise InputError(
            "open files", f"{hard} are allowed here, {needed} are needed", f"ulimit -n {needed} or more"
        )
    if soft != resource.RLIM_INFINITY and soft < needed:
        resource.setrlimit(resource.RLIMIT_NOFILE, (needed, hard))


def free_endpoint() -> str:
    """A TCP endpoint on loopback that nobody listens on right now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


def on_loopback() -> Placement:
    """A mission of its own on this machine."""
    endpoint = free_endpoint()
    return Placement(f"onehop-{uuid.uuid4().hex[:8]}", endpoint, endpoint)


@dataclass(slots=True)
class _Child:
    """The latest process of a name. incarnation: how often it was started again."""

    process: subprocess.Popen[bytes]
    incarnation: int
    death_told: bool = False


class ProcessGroup:
    """All children of one mission. Leaving the context ends every one of them.

    Each gets its own password through its environment, or is told where its certificate is, a lifeline
    that ends it when this process dies, and a file in the folder `words` for what it says. If nobody
    said anything the folder goes. What the placement has on other hosts is not started here.
    programs: where robots and radio look for what is not installed. commands: of robots that are not
    ours; they are started in the folder `programs`, with what ours are told. bases: the same of the
    drivers of real bases. Raises InputError when this system does not let so many processes work
    together.
    """

    def __init__(
        self,
        placement: Placement,
        robots: Sequence[int],
        words: Path,
        programs: str,
        commands: Mapping[int, Sequence[str]],
        bases: Mapping[int, Sequence[str]],
    ) -> None:
        self._placement = placement
        self._words = words
        self._programs = programs
        self._search = ["--programs", programs] if programs else []
        self._commands = commands
        self._bases = bases
        names = topics.clients(robots, bases)
        require_descriptors(len(names))
        self._passwords = make_credentials(names) if placement.keys is None else {}
        self._lifeline, self._keep_open = os.pipe()
        self._children: dict[str, _Child] = {}
        self.processes: list[Process] = []
        shutil.rmtree(words, ignore_errors=True)  # of an earlier mission in the same folder
        words.mkdir()

    def __enter__(self) -> "ProcessGroup":
        return self

    def __exit__(self, *_: object) -> None:
        self.end()
        os.close(self._keep_open)
        os.close(self._lifeline)
        if not self.said_something:
            shutil.rmtree(self._words, ignore_errors=True)

    def identity(self, name: str) -> Identity:
        """What the bus knows a process by. Raises InputError when its certificate is of no use."""
        keys = self._placement.keys
        return self._passwords[name] if keys is None else certificate(keys, name)

    def is_here(self, name: str) -> bool:
        """Whether a process is a child of this one, and not started on another host."""
        return name not in self._placement.remote

    @property
    def said_something(self) -> bool:
        """Whether any child has said something on stderr: none has a reason to, if all is well."""
        return any(file.stat().st_size for file in self._words.glob("*"))

    def start_world(self, arguments: Sequence[str]) -> None:
        self._start(topics.WORLD, "world_server", [*arguments, *self._placement.world_arguments()])

    def start_radio(self) -> None:
        arguments = [*self._placement.client_arguments(), *self._search]
        self._start(topics.RADIO, "radio_proxy", arguments)

    def start_recorder(self, out: Path, with_file: bool, claim: int) -> None:
        """claim: descriptor that holds the folder `out`, from now on for the recorder too."""
        arguments = [
            *self._placement.client_arguments(),
            "--out",
            str(out),
            *([] if with_file else ["--no-file"]),
        ]
        self._start(topics.RECORDER, "onehop.recorder", arguments, claim)

    def start_robot(self, robot: int) -> None:
        """Raises InputError when its command names nothing that can be started."""
        name = topics.robot_name(robot)
        command = self._commands.get(robot)
        if command is None:
            arguments = ["--id", str(robot), *self._placement.client_arguments(), *self._search]
            self._start(name, "robot_agent", arguments)
        else:
            self._start_theirs(name, robot, command, "command")

    def start_base(self, robot: int) -> None:
        """The driver of a robot's real base. Raises InputError when its command names nothing."""
        self._start_theirs(topics.base_name(robot), robot, self._bases[robot], "base_command")

    def _start_theirs(self, name: str, robot: int, command: Sequence[str], key: str) -> None:
        """A process of somebody else's making. Raises InputError."""
        arguments = ["--id", str(robot), *self._placement.client_arguments()]
        try:
            self._start_command(name, command, arguments, folder=self._programs)
        except OSError as error:
            remedy = "a program in PATH, or ./NAME in the scenario's folder"
            what = f"{command[0]!r:.200} cannot be started ({error.strerror})"
            raise InputError(f"robots: {key} of robot {robot}", what, remedy) from None

    def _start(self, name: str, module: str, arguments: Sequence[str], *inherited: int) -> None:
        self._start_command(name, [sys.executable, "-m", module], arguments, *inherited)

    def _start_command(
        self,
        name: str,
        command: Sequence[str],
        arguments: Sequence[str],
        *inherited: int,
        folder: str | None = None,
    ) -> None:
        own = os.path.dirname(sys.executable)
        path = os.pathsep.join((own, os.environ.get("PATH", os.defpath)))
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "PATH": path}
        if name in self._passwords:
            environment[PASSWORD_VARIABLE] = self._passwords[name]
        elif self._passwords:
            words = (f"{user}:{password}" for user, password in self._passwords.items())
            environment[CREDENTIALS_VARIABLE] = " ".join(words)
        shared = ["--mission", self._placement.mission, "--lifeline", str(self._lifeline)]
        with self._file(name).open("ab") as stderr:
            process = subprocess.Popen(
                [*command, *shared, *arguments],
                stdin=subprocess.DEVNULL,
                stdout=stderr,
                stderr=stderr,
                pass_fds=(self._lifeline, *inherited),
                env=environment,
                cwd=folder,
                process_group=0,  # Ctrl-C is the launcher's; a session of its own would cost it 5 %
            )
        before = self._children.get(name)
        self._children[name] = _Child(process, before.incarnation + 1 if before else 0)
        self.processes.append(Process(name, process.pid))

    def send(self, name: str, number: signal.Signals) -> None:
        """Send a signal to a child, if it still runs."""
        if self.is_here(name):
            self._children[name].process.send_signal(number)

    def exit_status(self, name: str) -> int | None:
        """Exit status of a child, negative for a signal, None while it runs."""
        return self._children[name].process.poll()

    def is_stopped(self, name: str) -> bool:
        """Whether a child has been stopped (SIGSTOP, SIGTSTP) and not been continued."""
        process = self._children[name].process
        if process.poll() is not None:
            return False
        return os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WNOHANG | os.WNOWAIT) is not None

    def deaths(self) -> list[Death]:
        """Children that have died since the last call, other than because the world was gone."""
        deaths = []
        for name, child in self._children.items():
            if not child.death_told and child.process.poll() not in (None, 0, WORLD_IS_GONE):
                child.death_told = True
                deaths.append(Death(name, child.incarnation, self.account(name)))
        return deaths

    def account(self, name: str) -> str:
        """How a child that has ended did so, with its last words, in one line.

        Of a robot whose program has failed it is all that it said, which is a block of lines.
        """
        status = self._children[name].process.returncode
        if status == PROGRAM_FAILED:
            return f"the program of {name} failed:\n{self._last_block(name)}"
        how = _signal_name(-status) if status < 0 else f"exit status {status}"
        account, words = f"the {name} process died ({how})", self.last_words(name)
        if not words:
            return account
        return f"{account}: {words:.{LAST_WORDS}}; all it said is in {self._file(name)}"

    def last_words(self, name: str) -> str:
        """The last line that a child said on stderr, empty if it said nothing or the file is gone."""
        try:
            lines = self._file(name).read_text(errors="replace").strip().splitlines()
        except OSError:
            return ""
        return printable(lines[-1].strip()) if lines else ""

    def _last_block(self, name: str) -> str:
        """The last lines that a child said, as many as a program's account has."""
        try:
            lines = self._file(name).read_text(errors="replace").rstrip().splitlines()
        except OSError:
            return ""
        return "\n".join(printable(line) for line in lines[-ACCOUNT_LINES - 1 :])

    def _file(self, name: str) -> Path:
        return self._words / f"{name}.txt"

    def end(self, leave_s: float = 0.0) -> None:
        """Give the children some time to leave [s], ask those that still run, then kill what does not.

        First of all those that have been stopped go on: only then they can hear anything.
        """
        for number, wait_s in (
            (signal.SIGCONT, leave_s),
            (signal.SIGTERM, GRACE_S),
            (signal.SIGKILL, GRACE_S),
        ):
            running = [one.process for one in self._children.values() if one.process.poll() is None]
            for process in running:
                process.send_signal(number)
            _wait(running, wait_s)


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:  # a real-time signal
        return f"signal {number}"


def _wait(processes: Sequence[subprocess.Popen[bytes]], seconds: float) -> None:
    deadline = time.monotonic() + seconds
    for process in processes:
        try:
            process.wait(max(0.0, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            return
