"""Missions whose processes are on several hosts, with certificates: the same bytes as in one process.

Hosts are network namespaces where this system lets tests make them, and otherwise processes on loopback
that nobody but the test starts.
"""

import contextlib
import json
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import zenoh

from onehop.contracts.fault_section import FaultSection
from onehop.contracts.messages import Truth
from onehop.mission.injection import inject
from onehop.mission.rendezvous import way_into
from onehop.wire.codec import decode
from tests.live.hosts import LINK, Router, ended, hosts, made_keys, stranger, tls_endpoint
from tests.live.mission import CREEPING, DEADLINE_S, Mission, contents, gone, proven
from tests.onehop.scenes import field, log_of

pytestmark = pytest.mark.live

SHORT = ("team.size=6", "clock.limit_s=4")

LONGER = ("team.size=6", "clock.limit_s=15")


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made_keys(tmp_path_factory.mktemp("hosts") / "keys", range(1, 7), f"{LINK}1")


def robot(number: int, endpoint: str, keys: Path, *more: str) -> list[str]:
    """What is typed on the host of a robot."""
    return ["robot_agent", "--id", str(number), "--connect", endpoint, "--keys", str(keys), *more]


def started(words: list[str]) -> "subprocess.Popen[str]":
    """A process of another host, here."""
    return subprocess.Popen([sys.executable, "-m", *words], text=True, stderr=subprocess.PIPE)


def on_bus(endpoint: str, keys: Path, remote: str, *more: str) -> tuple[str, ...]:
    return ("--bus", endpoint, "--keys", str(keys), "--remote", remote, *more)


def copied(keys: Path, folder: Path, *names: str) -> Path:
    """What is copied to a host: the folders of its own processes, and nothing else."""
    for name in names:
        subprocess.run(["cp", "-a", "-t", _made(folder), str(keys / name)], check=True)
    return folder


def _made(folder: Path) -> str:
    folder.mkdir(exist_ok=True)
    return str(folder)


def test_six_robots_on_three_hosts_log_what_one_process_does(tmp_path: Path, keys: Path) -> None:
    """World, recorder and robots 1 and 2 on one, 3 and 4 on the next, radio, 5 and 6 on the third."""
    inline = log_of(field(tmp_path, *SHORT), tmp_path / "inline.mcap")
    endpoint = f"tls/{LINK}1:7447"
    with hosts(3) as (base, second, third):
        names = ("world", "recorder", "operator", "injector", "robot-1", "robot-2")
        here = copied(keys, tmp_path / "base", *names)
        options = on_bus(endpoint, here, "3,4,5,6,radio")
        there = copied(keys, tmp_path / "second", "robot-3", "robot-4")
        elsewhere = copied(keys, tmp_path / "third", "robot-5", "robot-6", "radio")
        children = [
            second.start(*robot(3, endpoint, there)),
            second.start(*robot(4, endpoint, there)),
            third.start(*robot(5, endpoint, elsewhere)),
            third.start(*robot(6, endpoint, elsewhere)),
            third.start("radio_proxy", "--connect", endpoint, "--keys", str(elsewhere)),
        ]
        with ended(*children):
            within = ("ip", "netns", "exec", base.namespace)
            summary, said = Mission(tmp_path, *SHORT, options=options, within=within).finish_and_say()
            assert [child.wait(DEADLINE_S) for child in children] == [0] * len(children)
    assert summary["digest"] == inline
    assert [one["name"] for one in summary["processes"]] == ["world", "recorder", "robot-1", "robot-2"]
    assert "waiting for robot-3, robot-4, robot-5, robot-6, radio, 300 s at most; there: " in said
    assert f"python -m robot_agent --id 3 --connect {endpoint} --keys DIR" in said
    proven(tmp_path / "out" / "mission.mcap")


@contextlib.contextmanager
def rogues(endpoint: str, keys: Path, foreign: Path) -> Iterator[None]:
    """All at once that a stranger or an unfaithful member can do to a router, until it is left."""
    over = threading.Event()

    def pester(keys: Path | None, name: str, own_id: str | None, *puts: tuple[str, int]) -> None:
        while not over.is_set():
            with contextlib.suppress(zenoh.ZError):
                session = stranger(endpoint, keys, name, own_id, timeout_ms=1000)
                session.declare_subscriber("**", zenoh.handlers.FifoChannel(10))
                ends = time.monotonic() + 0.5
                while time.monotonic() < ends and not over.is_set():
                    for key, size in puts:
                        session.put(f"onehop/{key}", bytes(size))
                session.close()  # type: ignore[no-untyped-call]

    forged = (("from/robot-1/out", 500), ("to/robot-2/percept", 500), ("from/operator/control", 4))
    works = [
        (None, "robot-1", None),
        (foreign, "robot-1", None),
        (keys, "robot-1", "1abc", *forged),
        (keys, "robot-1", None, *forged),
        (keys, "injector", None, *forged, ("from/robot-3/out", 100_000_000)),
    ]
    threads = [threading.Thread(target=pester, args=work, daemon=True) for work in works]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        over.set()
        for thread in threads:
            thread.join(DEADLINE_S)


def test_a_mission_logs_the_same_bytes_whatever_rogue_clients_do(tmp_path: Path, keys: Path) -> None:
    inline = log_of(field(tmp_path, *LONGER), tmp_path / "inline.mcap")
    endpoint = tls_endpoint()
    foreign = made_keys(tmp_path / "foreign", (1,))
    mission = Mission(tmp_path, *LONGER, options=on_bus(endpoint, keys, "3"))
    with ended(started(robot(3, endpoint, keys))):
        mission.await_ticks(0)
        with rogues(endpoint, keys, foreign):
            summary = mission.finish()
    assert summary["digest"] == inline
    assert {lost["why"] for lost in summary["lost"]} == {"did not arrive"}


def test_with_a_router_of_its_own_the_bytes_are_the_same(tmp_path: Path, keys: Path) -> None:
    """Twice, since the router is there before the world is, and after it."""
    inline = log_of(field(tmp_path, *SHORT), tmp_path / "inline.mcap")
    endpoint = tls_endpoint()
    options = ("--bus", endpoint, "--keys", str(keys), "--router", "external")
    with Router(keys, endpoint):
        ended_so = [Mission(tmp_path, *SHORT, options=options).finish_and_say() for _ in range(2)]
    assert [summary["digest"] for summary, _ in ended_so] == [inline] * 2, ended_so


@pytest.fixture
def running(tmp_path: Path, keys: Path) -> Iterator[tuple[Mission, str, "subprocess.Popen[str]"]]:
    """A slow mission whose robot 3 is a process of somebody else's."""
    endpoint = tls_endpoint()
    mission = Mission(tmp_path, *CREEPING, options=on_bus(endpoint, keys, "3", "--mission", "field"))
    child = started(robot(3, endpoint, keys, "--mission", "field"))
    with ended(child):
        mission.await_ticks()
        yield mission, endpoint, child


def test_a_robot_of_another_host_dies_and_comes_again(
    running: tuple[Mission, str, "subprocess.Popen[str]"], keys: Path, tmp_path: Path
) -> None:
    mission, endpoint, child = running
    child.kill()
    child.wait()
    mission.await_line("robot-3 is gone from the bus")
    with ended(started(robot(3, endpoint, keys, "--mission", "field"))):
        mission.await_line("restart.* 3")
        answer = inject(way_into(mission.out), FaultSection("hold", robots=(3,), duration_s=0.5))
        assert answer.refusal == ""
        mission.stop()
    log = proven(tmp_path / "out" / "mission.mcap")
    truths = [decode(Truth, tick.get("truth") or b"") for tick in log.ticks()]
    done = [(fault.kind, fault.robots) for truth in truths for fault in truth.faults]
    assert done == [("restart", (3,)), ("hold", (3,))]
    assert [departure.why for truth in truths for departure in truth.departures] == ["its process died"]


def test_no_secret_of_a_mission_is_seen_by_others(
    running: tuple[Mission, str, "subprocess.Popen[str]"], keys: Path
) -> None:
    """Neither on a command line nor in what the mission writes; its way in is for its owner alone."""
    mission, _, child = running
    secrets = [path.read_text().splitlines()[1] for path in keys.glob("*/key.pem")]
    way_in = mission.out / "running.json"
    assert way_in.stat().st_mode & 0o077 == 0
    for pid in (*mission.children().values(), child.pid):
        seen = Path(f"/proc/{pid}/cmdline").read_text() + Path(f"/proc/{pid}/environ").read_text()
        assert "ONEHOP_PASSWORD" not in seen
        assert "ONEHOP_CREDENTIALS" not in seen
        assert not any(secret in seen for secret in secrets)
    mission.stop()
    written = contents(mission.out)
    assert not any(secret.encode() in written for secret in secrets)
    assert {path.stat().st_mode & 0o777 for path in keys.rglob("*.pem")} == {0o600}


def test_who_does_not_come_in_time_is_named(tmp_path: Path, keys: Path) -> None:
    endpoint = tls_endpoint()
    mission = Mission(tmp_path, options=on_bus(endpoint, keys, "3,4", "--wait", "6"))
    with ended(started(robot(3, endpoint, keys))):
        summary, said = mission.finish_and_say()
    assert summary["outcome"] == "aborted"
    assert re.fullmatch("not started within 6 s: .*robot-4", summary["reason"])
    assert "waiting for robot-3, robot-4, 6 s at most" in said


def test_ctrl_c_ends_a_mission_that_waits(tmp_path: Path, keys: Path) -> None:
    mission = Mission(tmp_path, options=on_bus(tls_endpoint(), keys, "3"))
    mission.await_line("waiting for robot-3")
    children = mission.children()
    mission.child.send_signal(signal.SIGINT)
    assert mission.child.wait(DEADLINE_S) == 130
    assert gone(list(children.values()))
    written = json.loads((mission.out / "summary.json").read_text())
    assert written["reason"] == "stopped by the operator"


def test_a_port_that_is_taken_is_one_line(tmp_path: Path, keys: Path) -> None:
    endpoint = tls_endpoint()
    with ended(started(robot(3, endpoint, keys))):
        first = Mission(tmp_path, *CREEPING, options=on_bus(endpoint, keys, "3"))
        first.await_ticks()
        folder = tmp_path / "second"
        folder.mkdir()
        _, said = Mission(folder, options=on_bus(endpoint, keys, "3")).child.communicate(
            timeout=DEADLINE_S
        )
    assert said.splitlines()[-1] == f"onehop: --bus {endpoint}: somebody listens there; another port"
