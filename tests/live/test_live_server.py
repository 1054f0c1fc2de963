"""The live page's server without a browser: who is let in, what is done by hand, how a mission ends."""

import http.client
import json
import os
import shlex
import signal
import socket
import threading
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from onehop.live.guard import Address
from onehop.live.hand import Hand
from onehop.live.server import LiveServer
from onehop.live.source import Source
from onehop.wire.log_reader import LogFile, digest
from tests.live.mission import CREEPING, proven
from tests.live.page_client import PATIENCE_S, PageClient, Shown, shown_mission
from tests.onehop.scenes import FIELD, field, log_of

pytestmark = pytest.mark.live


@pytest.fixture(scope="module")
def log_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("log")
    log_of(field(folder, "clock.limit_s=6"), folder / "mission.mcap")
    return folder / "mission.mcap"


@pytest.fixture
def server(log_path: Path) -> Iterator[LiveServer]:
    source = Source(log_path)
    source.open()
    with LiveServer([source], Address()) as serving:
        yield serving


@pytest.mark.skipif(not hasattr(os, "SCHED_IDLE"), reason="Linux has it")
@pytest.mark.parametrize("hand", [None, Hand((), is_paced=False), Hand((), is_paced=True)])
def test_a_page_gives_way_to_a_mission_in_lock_step_alone(log_path: Path, hand: Hand | None) -> None:
    source = Source(log_path)
    source.open()
    gives_way = hand is not None and hand.is_paced
    with LiveServer([source], Address(), hand):
        threads = {one.name: one.native_id for one in threading.enumerate()}
        policies = {os.sched_getscheduler(threads[name] or 0) for name in ("live page", "reader")}
        assert policies == {os.SCHED_IDLE if gives_way else os.SCHED_OTHER}


def get(url: str, path: str, host: str | None = None) -> tuple[int, dict[str, str], bytes]:
    parts = urlsplit(url)
    line = http.client.HTTPConnection(parts.hostname or "", parts.port or 0, timeout=PATIENCE_S)
    try:
        line.request("GET", path, headers={"Host": host or parts.netloc})
        answer = line.getresponse()
        headers = {name.lower(): value for name, value in answer.getheaders()}
        return answer.status, headers, answer.read()
    finally:
        line.close()


def test_the_page_needs_its_token_and_its_own_name(server: LiveServer) -> None:
    own = urlsplit(server.url)
    status, headers, page = get(server.url, f"/?{own.query}")
    assert (status, headers["content-type"]) == (200, "text/html; charset=utf-8")
    assert b'<script type="module" src="static/main.js">' in page
    assert headers["referrer-policy"] == "no-referrer"
    assert "script-src 'self'" in headers["content-security-policy"]
    assert get(server.url, "/")[0] == 403
    assert get(server.url, "/?token=wrong")[0] == 403
    for path in (f"/?{own.query}", "/static/main.js"):
        assert get(server.url, path, f"evil.example:{own.port}")[0] == 421
    assert get(server.url, "/static/main.js")[0] == 200
    for stranger in ("/static/..%2fserver.py", "/static/%2e%2e/guard.py", "/nothing"):
        assert get(server.url, stranger)[0] == 404


@pytest.mark.parametrize("wrong", ["origin", "no origin", "host", "token", "log"])
def test_a_websocket_that_is_not_the_pages_own_is_refused(wrong: str, server: LiveServer) -> None:
    own = urlsplit(server.url)
    query = "token=wrong" if wrong == "token" else own.query
    number = 7 if wrong == "log" else 0
    name = f"evil.example:{own.port}" if wrong == "host" else own.netloc
    origin = {"origin": "http://evil.example", "no origin": None}.get(wrong, f"http://{name}")
    uri = f"ws://{name}/feed/{number}?{query}"
    with (
        socket.create_connection((own.hostname, own.port)) as line,
        pytest.raises(InvalidStatus, match="403"),
    ):
        connect(uri, sock=line, origin=origin)  # type: ignore[arg-type]


def test_a_page_that_says_nonsense_is_told_so_and_goes_on(server: LiveServer) -> None:
    with PageClient(server.url) as page:
        page.say("shutdown")
        page.until(lambda one: one.answers)
        assert page.answers[0]["kind"] == "refused"
        page.until(lambda one: one.tick >= 0, 10)
        refused = page.order(kind="kill", robots=[1])
        assert refused["words"] == "this is a log: what happened has happened"
        page.say("explain", robot=1, at_s=3.0)
        page.until(lambda one: one.answers[-1]["kind"] == "explained", 10)
        assert page.answers[-1]["lines"][0].startswith("Robot 1 at 3.00 s")
        page.say("road map", robot=1, tick=119)
        page.until(lambda one: one.answers[-1]["kind"] == "road map", 10)
        assert page.answers[-1] == {"kind": "road map", "robot": 1}


def test_a_page_is_sent_nothing_that_it_has_not_asked_for(server: LiveServer) -> None:
    """A slow browser has one message on its way, and holds up nobody."""
    own = urlsplit(server.url)
    with connect(f"ws://{own.netloc}/feed/0?{own.query}", origin=f"http://{own.netloc}") as line:  # type: ignore[arg-type]
        assert json.loads(line.recv(timeout=PATIENCE_S))["kind"] == "hello"
        with PageClient(server.url) as other:
            other.until(lambda one: one.frames > 0, 20)
            other.until(lambda one: one.frames > 1, 40)
        with pytest.raises(TimeoutError):
            line.recv(timeout=0.2)


def test_what_is_done_by_hand_is_repeated_by_the_command_that_the_page_shows(tmp_path: Path) -> None:
    """Paused, killed, stepped, slowed, and then at full speed: the digest is that of the command."""
    scenario = tmp_path / "field.toml"
    scenario.write_text(FIELD)
    settings = ("clock.limit_s=15", "team.next_period=0.5", "team.leader_timeout=1.2")
    with shown_mission(tmp_path, scenario, *settings) as shown:
        with PageClient(shown.url) as page, PageClient(shown.url) as guest:
            held = page.pause()
            page.say("pace", ticks_per_s=0, paused=True, steps=2)
            page.until(lambda one: one.tick == held + 2)
            guest.until(lambda one: one.tick == held + 2)
            assert guest.order(kind="kill", robots=[3])["words"].startswith("somebody else has the")
            killed = page.order(kind="kill", robots=[2])
            assert (killed["done"], killed["kind"]) == (True, "answer")
            page.until(lambda one: one.tick == held + 3)
            assert [one["id"] for one in page.news["frame"]["gone"]] == [2]
            assert not page.order(kind="kill", robots=[2])["done"]
            guest.say("take over")
            guest.until(lambda one: one.news["hand"]["yours"])
            guest.say("pace", ticks_per_s=200, paused=False, steps=0)
            assert guest.order(kind="hold", robots=[4], duration_s=1)["done"]
            guest.say("pace", ticks_per_s=0, paused=False, steps=0)
            guest.until(lambda one: one.news["state"]["state"] == "ended")
            assert any("without a vote" in event[2] for event in guest.events)
            typed = shlex.split(guest.news["again"]["command"])
        status, printed = shown.finish()
    summary = json.loads(printed)
    assert status == 1
    assert summary["ticks"] == 300
    log = proven(tmp_path / "out" / "mission.mcap")
    assert typed[:2] == ["onehop", "run"]
    again = typed[typed.index("--set") :]
    changes = [one for one in again if one != "--set"]
    assert len(changes) == len(settings) + 1
    assert log_of(field(tmp_path, *changes), tmp_path / "again.mcap") == summary["digest"] == digest(log)


def test_a_mission_that_is_paused_can_be_ended(tmp_path: Path) -> None:
    scenario = tmp_path / "field.toml"
    scenario.write_text(FIELD)
    with shown_mission(tmp_path, scenario, *CREEPING) as shown, PageClient(shown.url) as page:
        page.pause()
        os.kill(shown.child.pid, signal.SIGINT)
        assert shown.finish()[0] == 130
    summary = proven(tmp_path / "out" / "mission.mcap").summary
    assert summary is not None
    assert summary["reason"] == "stopped by the operator"


def test_a_mission_by_the_wall_clock_heeds_faults_and_no_pace(tmp_path: Path) -> None:
    scenario = tmp_path / "field.toml"
    scenario.write_text(FIELD)
    timed = ('clock.mode="realtime"', "clock.speed=4", *CREEPING)
    with shown_mission(tmp_path, scenario, *timed) as shown:
        with PageClient(shown.url) as page:
            page.until(lambda one: one.tick >= 3)
            assert not page.news["hand"]["is_paced"]
            page.say("pace", ticks_per_s=0, paused=True, steps=0)
            assert page.order(kind="hold", robots=[2], duration_s=1)["done"]
            seen = page.tick
            page.until(lambda one: one.tick > seen + 20)
            os.kill(shown.child.pid, signal.SIGINT)
        assert shown.finish()[0] == 130
    assert LogFile(tmp_path / "out" / "mission.mcap").summary is not None


def test_a_mission_that_nobody_watches_ends_as_without_a_page(tmp_path: Path) -> None:
    scenario = tmp_path / "field.toml"
    scenario.write_text(FIELD)
    with shown_mission(tmp_path, scenario, "clock.limit_s=2") as shown:
        status, printed = shown.finish()
    assert (status, json.loads(printed)["ticks"]) == (1, 40)
    assert LogFile(tmp_path / "out" / "mission.mcap").summary is not None


def test_ctrl_c_ends_the_page_of_a_log_in_order(log_path: Path) -> None:
    with Shown("live", str(log_path)) as shown:
        with PageClient(shown.url) as page:
            page.until(lambda one: one.tick == 100, 100)
            assert page.news["state"]["state"] == "ended"
        os.kill(shown.child.pid, signal.SIGINT)
        assert shown.finish()[0] == 0


def test_two_logs_are_compared(tmp_path: Path, log_path: Path) -> None:
    hold = 'faults=[{kind="hold", at_s=3, robots=[1]}]'
    log_of(field(tmp_path, "clock.limit_s=6", hold), tmp_path / "held.mcap")
    with Shown("live", str(log_path), str(tmp_path / "held.mcap")) as shown:
        for number in (0, 1):
            with PageClient(shown.url, number) as page:
                page.until(lambda one: "difference" in one.news, 60)
                assert page.news["difference"]["at"] == 3.0
                assert "Their scenarios differ in faults" in page.news["difference"]["words"]
