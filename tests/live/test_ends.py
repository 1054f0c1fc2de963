"""How missions end that people, a full disk or a broken installation end: in order, with the reason."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from onehop.mission.processes import free_endpoint
from onehop.node.bus import LEASE_MS, open_client, open_router
from onehop.node.identity import make_credentials
from onehop.wire.log_reader import LogFile, digest
from tests.live.mission import CREEPING, DEADLINE_S, Mission, gone, proven
from tests.onehop.scenes import field, log_of

pytestmark = pytest.mark.live

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]

SOON_S = LEASE_MS / 1000.0 + 30.0
"""A stopped process's lease, and the end of the rest on a busy machine."""

Start = Callable[..., Mission]


@pytest.fixture
def start(tmp_path: Path) -> Start:
    """Starts missions whose temporary files have a folder of their own."""
    (tmp_path / "temporary").mkdir()

    def begin(*settings: str, **options: Any) -> Mission:
        environment = {"TMPDIR": str(tmp_path / "temporary"), **options.pop("environment", {})}
        return Mission(tmp_path, *settings, environment=environment, **options)

    return begin


def _end(mission: Mission) -> tuple[int, str]:
    """Exit status, and what was said on stderr besides the progress."""
    _, said = mission.child.communicate(timeout=DEADLINE_S)
    return mission.child.returncode, "\n".join(
        line for line in said.splitlines() if not line.startswith("field ")
    )


def _replayed(mission: Mission) -> LogFile:
    return proven(mission.out / "mission.mcap")


def _nothing_lies_about(mission: Mission, folder: Path) -> None:
    assert list((folder / "temporary").iterdir()) == []
    assert not (mission.out / "stderr").exists()


@pytest.mark.parametrize("number", SIGNALS)
def test_a_mission_that_is_asked_to_end_at_its_start_ends_in_order(
    start: Start, tmp_path: Path, number: signal.Signals
) -> None:
    mission = start()
    mission.await_child("world_server")
    children = mission.children()
    mission.child.send_signal(number)
    status, said = _end(mission)
    assert status == 128 + number
    assert said.startswith("onehop: ended by SIG")
    assert gone(list(children.values()))
    _nothing_lies_about(mission, tmp_path)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_mission_that_is_asked_to_end_finishes_its_log(
    start: Start, tmp_path: Path, number: signal.Signals
) -> None:
    """A terminal that closes says so more than once."""
    mission = start(*CREEPING)
    mission.await_ticks()
    children = mission.children()
    for _ in range(3):
        mission.child.send_signal(number)
    status, said = _end(mission)
    assert (status, said) == (128 + number, f"onehop: ended by {number.name}")
    assert gone(list(children.values()))
    log = _replayed(mission)
    assert log.summary is not None
    assert log.summary["reason"] == "stopped by the operator"
    _nothing_lies_about(mission, tmp_path)


def test_a_program_that_is_to_outlive_its_terminal_does(start: Start) -> None:
    mission = start("clock.limit_s=10", shell="trap '' HUP")
    mission.await_ticks(0)
    mission.child.send_signal(signal.SIGHUP)
    assert mission.finish()["reason"] == "time limit of 10 s"


@pytest.mark.campaign
def test_a_killed_launcher_leaves_no_file_and_its_folder_free(start: Start, tmp_path: Path) -> None:
    mission = start("clock.limit_s=60")
    mission.await_child("world_server")
    for wait_s in (0.0, 0.3, 0.6, 0.9, 1.2):  # through the world's start
        time.sleep(wait_s)
        children = mission.children()
        mission.child.kill()
        assert gone(list(children.values()))
        assert list((tmp_path / "temporary").iterdir()) == []
        mission.child.communicate()
        mission = start("clock.limit_s=2")
        mission.await_child("world_server")
    assert mission.finish()["reason"] == "time limit of 2 s"
    assert not (mission.out / "stderr").exists()


SPY = """
import contextlib, pathlib, sys, threading
done = threading.Event()
threading.Thread(target=lambda: (sys.stdin.read(), done.set())).start()
print("looking", flush=True)
found = set()
while not done.is_set():
    for file in pathlib.Path(sys.argv[1]).iterdir():
        with contextlib.suppress(OSError):
            found.add(file.read_text())
print(*found, end="")
"""


def test_passwords_never_lie_in_a_file_with_a_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However suddenly the world is killed while its bus opens, nobody finds them."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    words = make_credentials(["robot-1"])
    endpoint = free_endpoint()
    spy = subprocess.Popen(
        [sys.executable, "-c", SPY, str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert spy.stdout is not None
    assert spy.stdout.readline() == "looking\n"
    with open_router("m", endpoint, words), open_client("m", endpoint, "robot-1", words["robot-1"]):
        assert spy.communicate(timeout=DEADLINE_S)[0].strip() == ""


def test_a_launcher_that_was_stopped_to_the_end_takes_the_result_from_where_it_lies(
    start: Start, tmp_path: Path
) -> None:
    mission = start("clock.limit_s=20")
    mission.await_ticks()
    world = mission.children()["world_server"]
    mission.child.send_signal(signal.SIGSTOP)
    deadline = time.monotonic() + DEADLINE_S
    while _state(world) != "Z":  # it has ended, and its parent has yet to see it
        assert time.monotonic() < deadline
        time.sleep(0.05)
    mission.child.send_signal(signal.SIGCONT)
    summary = mission.finish()
    assert summary["digest"] == log_of(field(tmp_path, "clock.limit_s=20"), tmp_path / "inline.mcap")
    assert summary["outcome"] in ("arrived", "failed")
    assert len(summary["processes"]) == 7


def test_a_launcher_that_was_stopped_for_a_while_sees_the_mission_to_its_end(
    start: Start, tmp_path: Path
) -> None:
    """Robot 4 is stopped in its start, so that the world waits for it all the while."""
    mission = start("clock.limit_s=10")
    robot = mission.await_child("robot_agent 4")
    os.kill(robot, signal.SIGSTOP)
    while not (mission.out / "mission.mcap").exists():
        assert mission.child.poll() is None
        time.sleep(0.05)
    time.sleep(1.0)
    mission.child.send_signal(signal.SIGSTOP)
    time.sleep(LEASE_MS / 1000.0 + 2.0)
    mission.child.send_signal(signal.SIGCONT)
    time.sleep(1.0)
    os.kill(robot, signal.SIGCONT)
    summary = mission.finish()
    assert summary["digest"] == log_of(field(tmp_path, "clock.limit_s=10"), tmp_path / "inline.mcap")


@pytest.mark.parametrize(
    "wait_s", [0.0, 0.8, *(pytest.param(wait_s, marks=pytest.mark.campaign) for wait_s in (0.4, 1.6))]
)
def test_a_world_that_is_stopped_in_its_start_ends_the_mission(start: Start, wait_s: float) -> None:
    mission = start(*CREEPING)
    world = mission.await_child("world_server")
    time.sleep(wait_s)
    children = mission.children()
    os.kill(world, signal.SIGSTOP)
    stopped_s = time.time()
    summary = mission.finish()
    assert summary["outcome"] == "aborted"
    assert summary["reason"].startswith(
        ("the world process has been stopped", "the world process is gone")
    )
    assert mission.end_s() - stopped_s < SOON_S
    assert gone(list(children.values()))


def test_a_full_disk_ends_the_mission_with_its_log_up_to_there(start: Start) -> None:
    mission = start(*CREEPING, shell="ulimit -f 200")  # kilobytes a file
    summary = mission.finish()
    assert summary["outcome"] == "aborted"
    assert summary["reason"].startswith(f"{mission.out / 'mission.mcap'}: File too large")
    assert mission.child.returncode == 1
    log = _replayed(mission)
    assert log.torn
    assert digest(log)


def test_a_folder_that_vanishes_ends_the_mission_with_the_reason(start: Start) -> None:
    mission = start(*CREEPING)
    mission.await_ticks()
    mission.out.rename(mission.out.with_name("elsewhere"))
    for path in sorted(mission.out.with_name("elsewhere").rglob("*"), reverse=True):
        path.unlink() if path.is_file() else path.rmdir()
    status, said = _end(mission)
    assert status == 2
    assert f"aborted: {mission.out / 'mission.mcap'}: deleted while it was written" in said
    assert said.splitlines()[-1].startswith(f"onehop: {mission.out / 'summary.json'}: No such file")


def test_a_second_mission_into_the_same_folder_is_refused(start: Start, tmp_path: Path) -> None:
    mission = start(*CREEPING)
    mission.await_ticks(0)
    for driver in ("processes", "inline"):
        command = ["run", str(tmp_path / "field.toml"), "--driver", driver, "--out", str(mission.out)]
        second = subprocess.run(
            [sys.executable, "-m", "onehop", *command], capture_output=True, text=True, check=False
        )
        assert second.returncode == 2
        assert second.stderr == (
            f"onehop: {mission.out}: another mission or campaign is writing there; "
            "wait for its end, or give another --out\n"
        )
    assert mission.stop()["digest"] == digest(_replayed(mission))


def test_few_descriptors_are_said_before_anything_starts(start: Start) -> None:
    mission = start(shell="ulimit -n 24")
    status, said = _end(mission)
    assert status == 2
    assert said == ("onehop: open files: 24 are allowed here, 56 are needed; ulimit -n 56 or more")


def test_a_soft_limit_of_descriptors_is_raised(start: Start) -> None:
    mission = start("clock.limit_s=1", "team.size=12", "team.spacing=1", shell="ulimit -Sn 20")
    assert mission.finish()["ticks"] == 20


BROKEN = """
def body():
    raise RuntimeError("no such card")
body()
"""


@pytest.mark.parametrize(
    ("module", "name"),
    [("world_server", "world"), ("radio_proxy", "radio"), ("robot_agent", "robot-1")],
)
def test_a_process_that_cannot_be_imported_is_told_with_its_whole_traceback_kept(
    start: Start, tmp_path: Path, module: str, name: str
) -> None:
    broken = tmp_path / "path" / module
    broken.mkdir(parents=True)
    (broken / "__init__.py").write_text(BROKEN)
    mission = start(shell=f"cd {tmp_path / 'path'}")
    summary = mission.finish()
    words = mission.out / "stderr" / f"{name}.txt"
    reason = "process died (exit status 1): RuntimeError: no such card; all it said is in"
    if module == "robot_agent":  # whichever of the four is seen first
        assert reason in summary["reason"]
    else:
        assert summary["reason"] == f"the {name} {reason} {words}"
    assert words.read_text().startswith("Traceback")
    assert "in body" in words.read_text()


def test_a_crash_in_machine_code_leaves_a_traceback(start: Start) -> None:
    mission = start(*CREEPING)
    mission.await_ticks()
    os.kill(mission.children()["radio_proxy"], signal.SIGSEGV)
    summary = mission.finish()
    assert summary["reason"].startswith("the radio process died (SIGSEGV): ")
    assert "radio_proxy/process.py" in (mission.out / "stderr" / "radio.txt").read_text()


def _state(pid: int) -> str:
    """State letter of a process, Z when it has ended and its parent has not seen it yet."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return "Z"
