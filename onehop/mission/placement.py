"""Where the processes of a mission run: all here on loopback, or some of them on other hosts."""

import ipaddress
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from onehop.contracts import topics
from onehop.contracts.errors import InputError
from onehop.node.identity import TLS
from onehop.node.startup import DEFAULT_MISSION, certificate, require_keys_for_tls

WAIT_S = 300.0
"""How long a mission waits for processes on other hosts [s], if nothing else is said."""

PROGRAMS = {topics.RADIO: "radio_proxy", "robot": "robot_agent"}
"""What is started for a name, without its number."""

BASE_DRIVER = "base_driver.py"
"""What people call the driver of their base who begin with examples/base_driver.py."""

NO_BASES: Mapping[int, Sequence[str]] = {}
"""Of a team that is all simulated."""


@dataclass(frozen=True, slots=True)
class Placement:
    """The bus of a mission, and who is where.

    mission: prefix of its keys. listen, connect: endpoints, of the world and of everyone else here.
    keys: folder of certificates, None: passwords. remote: names of processes on other hosts, and wait_s
    how long they may take to come [s]. external: the router is a process of somebody else's (zenohd),
    and the world its client.
    """

    mission: str
    listen: str
    connect: str
    keys: Path | None = None
    remote: tuple[str, ...] = ()
    wait_s: float = WAIT_S
    external: bool = False

    def world_arguments(self) -> list[str]:
        """Options of the world's process."""
        patience = ["--start-s", f"{self.wait_s:g}"] if self.remote else []
        bus = ["--connect", self.connect] if self.external else ["--listen", self.listen]
        return [*bus, *self._keys(), *patience]

    def client_arguments(self) -> list[str]:
        """Options of every other process."""
        return ["--connect", self.connect, *self._keys()]

    def invitation(self) -> str:
        """What people are told who have to start the rest: one command for each kind of process."""
        prefix = "" if self.mission == DEFAULT_MISSION else f" --mission {self.mission}"
        names = ", ".join(self.remote)
        kinds = {name.rstrip("0123456789"): name for name in reversed(self.remote)}
        there = "; ".join(
            f"python {_command(name)} --connect {self.listen}{prefix} --keys DIR"
            for name in reversed(kinds.values())
        )
        return f"waiting for {names}, {self.wait_s:g} s at most; there: {there}"

    def _keys(self) -> list[str]:
        return [] if self.keys is None else ["--keys", str(self.keys)]


def on_hosts(
    bus: str,
    keys: Path | None,
    remote: str,
    mission: str,
    wait_s: float,
    robots: Sequence[int],
    external: bool = False,
    bases: Mapping[int, Sequence[str]] = NO_BASES,
) -> Placement:
    """A mission on a bus that other hosts reach, as options of the command line say it.

    bus: where the world listens, or the router that is there. remote: ids of robots, "radio", and names
    of drivers of real bases, with commas. bases: of robots that have one, what starts its driver here;
    one that nothing starts here is remote. Raises InputError.
    """
    option = f"--bus {bus}"
    parted = re.fullmatch(r"(tls|tcp)/(.+):(\d+)", bus)
    if parted is None or not 0 < int(parted[3]) < 65536:
        raise InputError(option, "no endpoint", "tls/HOST:PORT, e.g. tls/10.0.0.1:7447")
    if not bus.startswith(TLS):
        why = "passwords and what is said would cross the network in the open"
        raise InputError(option, why, "tls/HOST:PORT with --keys DIR (onehop keys DIR)")
    require_keys_for_tls(bus, keys)
    assert keys is not None
    if re.fullmatch(r"[\w.-]{1,64}", mission) is None:
        raise InputError(f"--mission {mission}", "no name of a mission", "letters, digits, . _ and -")
    host, port = parted[2].strip("[]"), parted[3]
    everywhere = _is_everywhere(host)
    world = certificate(keys, topics.WORLD)
    if not (everywhere or external) and host not in world.hosts:
        good = f"for {', '.join(world.hosts)}"
        remedy = f"onehop keys {keys} --reissue world --host {host}"
        raise InputError(option, f"the world's certificate is {good}", remedy)
    connect = f"{TLS}127.0.0.1:{port}" if everywhere else bus
    elsewhere = [*_names(remote, robots, bases)]
    elsewhere += [topics.base_name(robot) for robot, command in bases.items() if not command]
    names = tuple(dict.fromkeys(elsewhere))
    return Placement(mission, bus, connect, keys.absolute(), names, wait_s, external)


def _is_everywhere(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_unspecified
    except ValueError:
        return False


def _names(remote: str, robots: Sequence[int], bases: Iterable[int]) -> tuple[str, ...]:
    """Names of those who are on other hosts. Raises InputError."""
    of_bases = tuple(map(topics.base_name, bases))
    allowed = [topics.RADIO, *map(str, robots), *of_bases]
    words = [word.strip() for word in remote.split(",") if word.strip()]
    for word in words:
        if word not in allowed:
            team = ", ".join(allowed)
            raise InputError(f"--remote {remote}", f"{word!r:.40} cannot be elsewhere", f"of {team}")
    whole = {topics.RADIO, *of_bases}
    named = (word if word in whole else topics.robot_name(word) for word in words)
    return tuple(dict.fromkeys(named))


def _command(name: str) -> str:
    """What is started there: a program of ours, or for a base the driver that somebody has made."""
    stem, _, number = name.partition("-")
    if name.startswith(topics.base_name("")):
        return f"{BASE_DRIVER} --id {number}"
    return f"-m {PROGRAMS[stem]}" + (f" --id {number}" if number else "")
