"""A real base among simulated robots: examples/hardware.toml, whose base is a fake one."""

import contextlib
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from onehop.contracts.errors import LogError
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.geometry import Pose
from onehop.contracts.hardware import Taken
from onehop.contracts.messages import Truth
from onehop.mission.injection import inject
from onehop.mission.operator import STOPPED
from onehop.mission.rendezvous import way_into
from onehop.wire.codec import decode
from onehop.wire.log_reader import LogFile
from onehop.wire.summary import read_summary
from tests.live.hosts import Router, ended, made_keys, tls_endpoint
from tests.live.mission import DEADLINE_S, Mission, proven

pytestmark = [pytest.mark.live, pytest.mark.slow]

EXAMPLES = Path(__file__).parents[2] / "examples"
SCENARIO = EXAMPLES / "hardware.toml"
REAL, TEAM = 5, (1, 2, 3, 4, 5, 6)


def truths(log: LogFile) -> list[Truth]:
    return [decode(Truth, one.data) for one in log.wire.select(lambda key: key == "truth")]


def way(log: LogFile, robot: int) -> list[Pose]:
    """Where a robot was, tick by tick, while it took part."""
    return [one.pose for truth in truths(log) for one in truth.present if one.robot == robot]


def gone_ahead(poses: list[Pose]) -> float:
    return math.dist((poses[0].x, poses[0].y), (poses[-1].x, poses[-1].y)) if poses else 0.0


def test_a_base_drives_with_the_team_and_when_its_driver_is_killed_the_rest_goes_on(
    tmp_path: Path,
) -> None:
    mission = Mission(tmp_path, scenario=SCENARIO)
    await_log(mission, lambda log: gone_ahead(way(log, REAL)) > 3.0, "it comes 3 m")
    os.kill(mission.children()["base_driver.py"], signal.SIGKILL)
    summary = mission.finish()
    assert summary["outcome"] == "arrived"
    assert summary["arrived"] == [1, 2, 3, 4, 6]
    assert [(one["robot"], one["why"]) for one in summary["lost"]] == [(REAL, "its base is gone")]
    log = proven(mission.out / "mission.mcap")

    taken = [decode(Taken, one.data) for one in log.wire.select(lambda key: key == f"base/{REAL}")]
    poses = way(log, REAL)
    assert (taken[0].tick, taken[0].measured.pose) == (0, poses[0])
    assert len(taken) > len(poses) / 2
    assert gone_ahead(poses) > 3.0
    for robot in TEAM:  # it has come along with the others
        assert poses[-1].x - poses[0].x > 0.5 * (
            way(log, robot)[len(poses) - 1].x - way(log, robot)[0].x
        )


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ('["./nowhere"]', "base_command of robot 5: './nowhere' cannot be started (No such file or dir"),
        (
            '["python", "-c", "exit(\'no wheels\')"]',
            "the base-5 process died (exit status 1): no wheels; all",
        ),
    ],
)
def test_a_driver_that_does_not_start_ends_the_mission_in_one_line(
    tmp_path: Path, command: str, said: str
) -> None:
    robots = f'robots=[{{id={REAL}, base="hardware", base_command={command}}}]'
    mission = Mission(tmp_path, robots, scenario=SCENARIO)
    printed, told = mission.child.communicate(timeout=DEADLINE_S)
    assert said in printed + told
    assert "Traceback" not in told
    assert mission.child.returncode in (1, 2)


def await_log(mission: Mission, happens: Callable[[LogFile], bool], what: str) -> None:
    """Wait until the log of a mission that runs shows something."""
    deadline = time.monotonic() + DEADLINE_S
    path = mission.out / "mission.mcap"
    while time.monotonic() < deadline:
        assert mission.child.poll() is None
        with contextlib.suppress(LogError):  # it has not been written yet
            if path.exists() and happens(LogFile(path)):
                return
        time.sleep(0.2)
    raise AssertionError(f"in vain: {what}")


def test_a_driver_that_is_started_by_hand_has_its_certificate_and_may_come_again(tmp_path: Path) -> None:
    keys, endpoint = made_keys(tmp_path / "keys", TEAM, bases=(REAL,)), tls_endpoint()
    words = [sys.executable, "base_driver.py", "--id", str(REAL), "--connect", endpoint]
    words += ["--keys", str(keys), "hardware.toml", "5,10.5,0"]

    def driver() -> "subprocess.Popen[str]":
        return subprocess.Popen(words, cwd=EXAMPLES, text=True, stderr=subprocess.PIPE)

    first = driver()
    with ended(first):
        robots = f'robots=[{{id={REAL}, base="hardware"}}]'
        options = ("--bus", endpoint, "--keys", str(keys))
        slowly = ("clock.limit_s=600", "robot.leader_speed=0.05")
        mission = Mission(tmp_path, robots, *slowly, scenario=SCENARIO, options=options)
        await_log(mission, lambda log: len(way(log, REAL)) > 20, "it takes part")
        first.send_signal(signal.SIGSTOP)  # for longer than a lease: as one that is cut off
        await_log(mission, lambda log: REAL not in present(log), "it leaves")
        cut = numbers(LogFile(mission.out / "mission.mcap"))[-1]
        first.send_signal(signal.SIGCONT)
        await_log(mission, lambda log: numbers(log)[-1] > cut, "its driver is back")
        bring_back(mission)
        first.send_signal(signal.SIGINT)
        assert first.wait(DEADLINE_S) == 130
        await_log(mission, lambda log: REAL not in present(log), "it leaves")
    second = driver()
    with ended(second):
        await_log(mission, lambda log: numbers(log) != sorted(numbers(log)), "its driver measures anew")
        bring_back(mission)
        mission.child.send_signal(signal.SIGINT)
        _, said = mission.child.communicate(timeout=DEADLINE_S)
        assert second.wait(DEADLINE_S) == 0
    assert "waiting for base-5, 300 s at most; there: python base_driver.py --id 5 " in said
    assert "base-5 is there" in said
    assert "base-5 is gone from the bus" in said
    summary = read_summary(mission.out)
    assert summary is not None
    assert summary["reason"] == STOPPED
    log = proven(mission.out / "mission.mcap")
    left = [(one.robot, one.why) for truth in truths(log) for one in truth.departures]
    assert set(left) == {(REAL, "its base is gone")}
    assert len(left) >= 2


@pytest.mark.campaign
def test_a_base_outlives_the_router(tmp_path: Path) -> None:
    """Its driver is started here, with its certificate; nobody leaves, and it measures and drives on."""
    keys, endpoint = made_keys(tmp_path / "keys", TEAM, bases=(REAL,)), tls_endpoint()
    options = ("--bus", endpoint, "--keys", str(keys), "--router", "external")
    with Router(keys, endpoint, (REAL,)) as router:
        mission = Mission(tmp_path, "clock.limit_s=8", scenario=SCENARIO, options=options)
        await_log(mission, lambda log: len(way(log, REAL)) > 20, "it takes part")
        before = numbers(LogFile(mission.out / "mission.mcap"))[-1]
        router.kill()
        time.sleep(3.0)
        router.start_again()
        summary = mission.finish()
    assert summary["reason"] == "time limit of 8 s"
    log = proven(mission.out / "mission.mcap")
    assert not [truth for truth in truths(log) if truth.departures]
    assert numbers(log)[-1] > before + 100


def present(log: LogFile) -> set[int]:
    """Who takes part at the end."""
    return {one.robot for one in truths(log)[-1].present}


def has_come_to(tick: int, log: LogFile) -> bool:
    return truths(log)[-1].tick >= tick


def bring_back(mission: Mission) -> None:
    """Restart the robot of the base until it stays: a driver's token may come after its measurements."""
    is_back = False
    while not is_back:
        tick = inject(way_into(mission.out), FaultSection("restart", robots=(REAL,))).tick + 20
        await_log(mission, partial(has_come_to, tick), "a second later")
        is_back = REAL in present(LogFile(mission.out / "mission.mcap"))


def numbers(log: LogFile) -> list[int]:
    """Of the measurements that were taken in."""
    taken = log.wire.select(lambda key: key == f"base/{REAL}")
    return [decode(Taken, one.data).measured.number for one in taken]
