"""Missions in real time whose cables are pulled, and whose router is killed, for some seconds."""

import contextlib
import itertools
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from onehop.contracts.messages import Inbox, Truth
from onehop.contracts.realtime import Lateness
from onehop.wire.codec import decode
from onehop.wire.log_reader import LogFile
from onehop.wire.summary import read_summary
from tests.live.hosts import LINK, Host, Router, ended, hosts, made_keys, tls_endpoint
from tests.live.mission import DEADLINE_S, Mission, proven
from tests.onehop.scenes import FIELD

pytestmark = [pytest.mark.live, pytest.mark.slow]

REAL_TIME = ('clock.mode="realtime"', "robot.leader_speed=0.05", "team.size=3")

UNDER_WAY_BYTES = 60_000

CUT_S = 5.0

PERIOD_S = 0.05


def truths(log: LogFile) -> list[Truth]:
    return [decode(Truth, one.data) for one in log.wire.select(lambda key: key == "truth")]


def speaks(log: LogFile, robot: int) -> list[int]:
    """Ticks at which a robot has said something that counted."""
    return [one.tick for one in log.wire.select(lambda key: key == f"out/{robot}")]


def wait(done: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + DEADLINE_S
    while not done():
        assert time.monotonic() < deadline_s
        time.sleep(0.05)


@contextlib.contextmanager
def by_hand(folder: Path, base: Host, second: Host, third: Host, fourth: Host) -> Iterator[Path]:
    """A mission that nobody launches; gives its log. Recorder, robot 1 and radio have a host each.

    Left, it is ended by a SIGTERM to the world.
    """
    scenario, keys, out = folder / "field.toml", folder / "keys", folder / "out"
    scenario.write_text(FIELD)
    made_keys(keys, range(1, 4), base.address)
    bus = (f"tls/{LINK}1:7447", "--keys", str(keys))
    settings = itertools.chain(*(("--set", one) for one in (*REAL_TIME, "clock.limit_s=600")))
    world = base.start("world_server", str(scenario), "--listen", *bus, *settings)
    children = [
        world,
        fourth.start("radio_proxy", "--connect", *bus),
        second.start("onehop.recorder", "--out", str(out), "--connect", *bus),
        third.start("robot_agent", "--id", "1", "--connect", *bus),
        *(base.start("robot_agent", "--id", str(i), "--connect", *bus) for i in (2, 3)),
    ]
    log = out / "mission.mcap"
    with ended(*children):
        grow(log, UNDER_WAY_BYTES)
        yield log
        world.send_signal(signal.SIGTERM)
        assert [child.wait(DEADLINE_S) for child in children] == [0] * len(children)


def grow(log: Path, size: int) -> None:
    """Wait until the log has grown by so many bytes."""
    before = log.stat().st_size if log.exists() else 0
    wait(lambda: log.exists() and log.stat().st_size > before + size)


def test_whoever_s_cable_is_pulled_comes_back(tmp_path: Path) -> None:
    """A robot's for a moment, which it does not notice; then that and the recorder's for longer than a
    lease; then the radio's."""
    with hosts(4) as four, by_hand(tmp_path, *four) as path:
        _, second, third, fourth = four
        with third.cut():
            time.sleep(0.2)
        grow(path, UNDER_WAY_BYTES)
        with second.cut(), third.cut():
            time.sleep(CUT_S)
        wait(lambda: has_come_back(LogFile(path)))
        with fourth.cut():
            time.sleep(CUT_S)
        wait(lambda: has_gone_on(LogFile(path)))
    log, summary = proven(path), read_summary(path.parent)
    assert summary is not None
    timing, whole, ticks = summary["realtime"], truths(log), speaks(log, 1)
    assert [one.tick for one in whole] == list(range(summary["ticks"]))
    assert timing["unrecorded_ticks"] <= 1  # the one that was in the making when it was ended
    (held,) = held_ticks(log)
    assert timing["moved_ms"] < 1e3 * (CUT_S + 1.0)  # for the radio alone

    left = [(truth.tick, one.robot, one.why) for truth in whole for one in truth.departures]
    again = [(truth.tick, one.kind, one.robots) for truth in whole for one in truth.faults]
    assert [one[1:] for one in left] == [(1, "its process died")]
    assert [one[1:] for one in again] == [("restart", (1,))]
    rest = whole[left[0][0] - 1].present[0]
    assert (rest.robot, rest.twist.v, rest.twist.w) == (1, 0.0, 0.0)
    silence = max((later - tick, tick) for tick, later in itertools.pairwise(ticks))
    assert silence[0] * PERIOD_S > CUT_S / 2.0
    assert silence[1] < left[0][0] < again[0][0] < silence[1] + silence[0] < held


def has_come_back(log: LogFile) -> bool:
    """Whether robot 1 acts again as another incarnation."""
    since = [truth.tick for truth in truths(log) if any(one.incarnation == 1 for one in truth.present)]
    return bool(since) and max(speaks(log, 1)) > since[0]


def test_a_router_that_is_killed_and_comes_back_costs_time_and_nothing_else(tmp_path: Path) -> None:
    keys, endpoint = made_keys(tmp_path / "keys", range(1, 7), "127.0.0.1"), tls_endpoint()
    options = ("--bus", endpoint, "--keys", str(keys), "--router", "external")
    with Router(keys, endpoint) as router:
        mission = Mission(tmp_path, *REAL_TIME, "clock.limit_s=7", options=options)
        mission.await_ticks(UNDER_WAY_BYTES)
        router.kill()
        time.sleep(CUT_S - 1.0)
        router.start_again()
        summary = mission.finish()
    assert summary["reason"] == "time limit of 7 s"
    log = proven(mission.out / "mission.mcap")
    whole, timing = truths(log), summary["realtime"]
    assert [one.tick for one in whole] == list(range(summary["ticks"]))
    assert timing["moved_ms"] > 1e3 * (CUT_S - 2.0)
    assert timing["unrecorded_ticks"] == 0
    assert [(one.robot, one.incarnation) for one in whole[-1].present] == [(1, 0), (2, 0), (3, 0)]
    assert not [truth for truth in whole if truth.departures or truth.faults]
    (held,) = held_ticks(log)
    assert min(max(speaks(log, robot)) for robot in (1, 2, 3)) > held + 20
    assert is_heard(log, range(held + 1, held + 61))  # not after as long as the router was away


def held_ticks(log: LogFile) -> list[int]:
    """Ticks before which everybody has waited."""
    lates = log.wire.select(lambda key: key == "late")
    return [one.tick for one in lates if decode(Lateness, one.data).late_ns > 1e9]


def is_heard(log: LogFile, ticks: range) -> bool:
    """Whether any robot has heard another within some ticks."""
    inboxes = log.wire.select(lambda key: key.startswith("rx/"))
    return any(decode(Inbox, one.data).receptions for one in inboxes if one.tick in ticks)


def has_gone_on(log: LogFile) -> bool:
    """Whether everybody has waited for the radio, and has heard somebody since."""
    held = held_ticks(log)
    return held != [] and is_heard(log, range(held[0] + 1, held[0] + 1_000_000))


@pytest.mark.campaign
@pytest.mark.parametrize("settings", [REAL_TIME, REAL_TIME[1:]])
def test_a_router_that_does_not_come_back_ends_the_mission(
    tmp_path: Path, settings: tuple[str, ...]
) -> None:
    """In real time and in lock-step."""
    keys, endpoint = made_keys(tmp_path / "keys", range(1, 7), "127.0.0.1"), tls_endpoint()
    options = ("--bus", endpoint, "--keys", str(keys), "--router", "external")
    with Router(keys, endpoint) as router:
        mission = Mission(tmp_path, *settings, "clock.limit_s=600", options=options)
        mission.await_ticks(UNDER_WAY_BYTES)
        router.kill()
        summary = mission.finish()
    assert summary["outcome"] == "aborted"
    assert summary["reason"].startswith("the router, or the world process, is gone")
    proven(mission.out / "mission.mcap")


@pytest.mark.campaign
def test_a_radio_that_does_not_come_back_ends_the_mission(tmp_path: Path) -> None:
    """It is on another host, from where nobody tells of its death."""
    keys, endpoint = made_keys(tmp_path / "keys", range(1, 7), "127.0.0.1"), tls_endpoint()
    bus = (endpoint, "--keys", str(keys))
    mission = Mission(
        tmp_path, *REAL_TIME, "clock.limit_s=600", options=("--bus", *bus, "--remote", "radio")
    )
    radio = subprocess.Popen([sys.executable, "-m", "radio_proxy", "--connect", *bus], text=True)
    with ended(radio):
        mission.await_ticks(UNDER_WAY_BYTES)
        radio.kill()
        summary = mission.finish()
    assert summary["outcome"] == "aborted"
    assert summary["reason"].startswith("the radio process is gone from the bus")
    proven(mission.out / "mission.mcap")
