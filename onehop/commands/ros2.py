"""`--ros2` of `onehop run`: the bridge to ROS 2 nodes as a process of its own, beside the mission."""

import contextlib
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from onehop.commands.output import say
from onehop.contracts.errors import MissionError
from onehop.wire.output_folder import LOG

LEAVE_S = 10.0
"""How long the bridge may take to publish the end of the log [s]."""


@dataclass(frozen=True, slots=True)
class Ros2:
    """Where the topics go. router: of rmw_zenoh. domain: ROS_DOMAIN_ID. distro: "humble", or "jazzy"."""

    router: str
    domain: int
    distro: str


@contextlib.contextmanager
def bridge(ros2: Ros2, folder: Path) -> Iterator[None]:
    """A bridge for the mission that is about to start; it is at its router when this is entered.

    Raises InputError when rosbags is missing, MissionError when it does not start; it has said why.
    """
    from onehop.analysis.ros2.types import typestore

    typestore()
    log = folder / LOG
    command = [sys.executable, "-m", "onehop.ros2", str(log), "--router", ros2.router]
    command += ["--domain", str(ros2.domain), "--distro", ros2.distro, "--until-stdin-closes", "--new"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, process_group=0
    ) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        try:
            told = child.stdout.readline()
            if not told:
                raise MissionError("the bridge to ROS 2 did not start")
            say(told.rstrip())
            yield
        finally:
            child.stdin.close()
            try:
                child.wait(LEAVE_S)
            except subprocess.TimeoutExpired:
                child.kill()
                say("the bridge to ROS 2 did not end by itself")
