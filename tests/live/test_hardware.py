"""A real base among simulated robots: examples/hardware.toml, whose base is a fake one."""

import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from onehop.contracts.errors import LogError
from onehop.contracts.geometry import Pose
from onehop.contracts.hardware import Taken
from onehop.contracts.messages import Truth
from onehop.mission import authority
from onehop.wire.codec import decode
from onehop.wire.log_reader import LogFile
from tests.live.hosts import DAYS, ended, tls_endpoint
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


def await_way(mission: Mission, robot: int, metres: float) -> None:
    """Wait until a robot has come so far."""
    deadline = time.monotonic() + DEADLINE_S
    path = mission.out / "mission.mcap"
    while time.monotonic() < deadline:
        assert mission.child.poll() is None
        try:
            if path.exists() and gone_ahead(way(LogFile(path), robot)) > metres:
                return
        except LogError:
            pass  # it has not been written yet
        time.sleep(0.2)
    raise AssertionError(f"robot {robot} did not come {metres} m in time")


def test_a_base_drives_with_the_team_and_when_its_driver_is_killed_the_rest_goes_on(
    tmp_path: Path,
) -> None:
    mission = Mission(tmp_path, scenario=SCENARIO)
    await_way(mission, REAL, 3.0)
    os.kill(mission.children()["base_driver.py"], signal.SIGKILL)
    summary = mission.finish()
    assert summary["outcome"] == "arrived"
    assert summary["arrived"] == [1, 2, 3, 4, 6]
    assert [(one["robot"], one["why"]) for one in summary["lost"]] == [(REAL, "its base is gone")]
    assert summary["collisions"] == 0
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


def test_a_driver_that_is_started_by_hand_comes_with_its_certificate(tmp_path: Path) -> None:
    keys, endpoint = tmp_path / "keys", tls_endpoint()
    authority.found(keys)
    for name in authority.names_of(TEAM, (REAL,)):
        authority.issue(keys, name, (), DAYS)
    driver = [sys.executable, "base_driver.py", "--id", str(REAL), "--connect", endpoint]
    driver += ["--keys", str(keys), "hardware.toml", "5,10.5,0"]
    child = subprocess.Popen(driver, cwd=EXAMPLES, text=True, stderr=subprocess.PIPE)
    with ended(child):
        robots = f'robots=[{{id={REAL}, base="hardware"}}]'
        options = ("--bus", endpoint, "--keys", str(keys))
        mission = Mission(tmp_path, robots, "clock.limit_s=4", scenario=SCENARIO, options=options)
        summary, said = mission.finish_and_say()
        assert child.wait(DEADLINE_S) == 0
    assert "waiting for base-5, 300 s at most; there: python base_driver.py --id 5 " in said
    assert "base-5 is there" in said
    assert summary["reason"] == "time limit of 4 s"
    assert {one["why"] for one in summary["lost"]} == {"did not arrive"}
    proven(mission.out / "mission.mcap")
