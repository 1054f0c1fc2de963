"""The live page in a browser: what somebody sees and does there."""

import json
import os
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, WebSocketRoute, expect, sync_playwright

from tests.live.mission import proven
from tests.live.page_client import Shown, shown_mission
from tests.onehop.analysis.conftest import scenario, write_log
from tests.onehop.scenes import field, log_of

CHROMIUM = os.environ.get("ONEHOP_CHROMIUM") or shutil.which("chromium")

pytestmark = [
    pytest.mark.live,
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium here (Debian: apt install chromium)"),
]

PATIENCE_MS = 60_000
MAPS = Path(__file__).parents[2] / "scenarios"
HOSTILE = "a<img src=x onerror='window.hacked=1'><script>window.hacked=1<script>"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        sandbox = [] if os.getuid() else ["--no-sandbox"]
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=sandbox)
        yield chromium
        chromium.close()


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """A page of the usual size, in which no script fails."""
    opened = browser.new_page(viewport={"width": 1280, "height": 720})
    opened.set_default_timeout(PATIENCE_MS)
    expect.set_options(timeout=PATIENCE_MS)
    said: list[str] = []
    opened.on("pageerror", lambda error: said.append(str(error)))
    opened.on("console", lambda line: said.append(line.text) if line.type == "error" else None)
    yield opened
    opened.close()
    assert [line for line in said if "ERR_CONNECTION_REFUSED" not in line] == []


def until(page: Page, done: Callable[[], bool]) -> None:
    """Wait until something is so; the page's policy forbids the browser to wait for an expression."""
    deadline = time.monotonic() + PATIENCE_MS / 1000
    while not done():
        assert time.monotonic() < deadline
        page.wait_for_timeout(50)


def clock_s(page: Page) -> float:
    """The time that is shown [s]."""
    return float((page.locator("#clock").text_content() or "").removesuffix(" s") or 0.0)


def draw_ms(page: Page) -> float:
    """What one picture costs, as the page has measured it in the last second [ms]; 0 before that."""
    return float(page.evaluate("document.documentElement.dataset.drawMs || 0"))


def places(page: Page) -> list[str | None]:
    """Where each robot's card says that it is."""
    return [card.get_attribute("aria-description") for card in page.locator(".card").all()]


def test_a_mission_is_watched_its_leader_killed_by_the_button_and_another_elected(
    tmp_path: Path, page: Page
) -> None:
    """By the wall clock: at full speed the mission could be over before anybody finds a button."""
    timed = ('clock.mode="realtime"', "clock.speed=4", "clock.limit_s=80")
    with shown_mission(tmp_path, MAPS / "map1.toml", *timed) as shown:
        page.goto(shown.url)
        expect(page.locator("#state")).to_have_text("running")
        expect(page.locator(".events")).to_contain_text("The formation stands")
        before, seen_s = places(page), clock_s(page)
        until(page, lambda: clock_s(page) > seen_s + 4.0)
        after = places(page)
        assert len(after) == 6
        assert all(here and there and here != there for here, there in zip(before, after, strict=True))
        leader = page.locator(".card").nth(2)
        expect(leader).to_contain_text("leader")
        leader.get_by_role("button", name="kill").click()
        expect(page.locator("#told")).to_contain_text("kill 3: took effect at")
        expect(page.locator(".events")).to_contain_text("Robot 3, the leader, leaves the mission")
        expect(page.locator(".events")).to_contain_text(
            "finds, without a vote, the same leader, robot 4, median of 1, 2, 4, 5, 6"
        )
        expect(leader).to_contain_text("gone: killed by a fault")
        expect(page.locator("#state")).to_have_text("failed")
        expect(page.locator("#banner")).to_contain_text("The mission has ended.")
        assert 'kind = "kill"' in page.locator(".again textarea").first.input_value()
        page.goto("about:blank")
        status, printed = shown.finish()
    assert (status, json.loads(printed)["outcome"]) == (1, "failed")
    proven(tmp_path / "out" / "mission.mcap")


def test_a_log_is_moved_through_by_slider_and_events_and_says_why(tmp_path: Path, page: Page) -> None:
    """Its scenario has a name that would be a script, were any text of a log taken for markup."""
    kill = 'faults=[{kind="kill", at_s=6, robots=[2]}]'
    team = ("team.next_period=0.5", "team.leader_timeout=1.2", "clock.limit_s=10", kill)
    log_of(field(tmp_path, *team, f'name="{HOSTILE}"'), tmp_path / "mission.mcap")
    with Shown("live", str(tmp_path / "mission.mcap")) as shown:
        page.goto(f"{shown.url}&at=1")
        expect(page.locator("#state")).to_have_text("failed")
        expect(page.locator("#title")).to_have_text(f"{HOSTILE} · seed 3")
        assert page.evaluate("document.querySelectorAll('img').length") == 0
        assert page.evaluate("window.hacked") is None
        expect(page.locator("#clock")).to_have_text("1.0 s")
        planning = page.get_by_role("button", name="Road map")
        expect(planning).to_have_attribute("aria-pressed", "true")
        page.keyboard.press("m")
        expect(planning).to_have_attribute("aria-pressed", "false")
        page.locator("#slider").fill("114")
        expect(page.locator("#clock")).to_have_text("5.7 s")
        expect(page.locator(".card").nth(1)).to_contain_text("leader")
        page.locator("#next").click()
        expect(page.locator("#clock")).to_have_text("6.0 s")
        expect(page.locator(".card").nth(1)).to_contain_text("gone")
        page.locator("#next").press(".")
        expect(page.locator("#clock")).to_have_text("6.1 s")
        page.get_by_role("button", name="without a vote").click()
        expect(page.locator("#why-lines")).to_contain_text("mode     leading since")
        page.locator("#why-close").click()
        expect(page.locator("#why")).to_be_hidden()
    expect(page.locator("#state")).to_have_text("connection lost")
    expect(page.locator("#banner")).to_contain_text("the page tries again")


def test_a_page_that_has_lost_its_line_says_so_and_comes_back(tmp_path: Path, page: Page) -> None:
    path = tmp_path / "mission.mcap"
    write_log(path, scenario())
    lines: list[WebSocketRoute] = []

    def connect(line: WebSocketRoute) -> None:
        lines.append(line)
        line.connect_to_server()

    page.route_web_socket("**/feed/*", connect)
    with Shown("live", str(path)) as shown:
        page.goto(f"{shown.url}&at=1")
        expect(page.locator("#state")).to_have_text("arrived")
        page.locator("#slider").fill("60")
        expect(page.locator("#clock")).to_have_text("3.0 s")
        lines[0].close()
        expect(page.locator("#state")).to_have_text("connection lost")
        expect(page.locator("#state")).to_have_text("arrived")
        expect(page.locator("#clock")).to_have_text("3.0 s")
        assert len(lines) == 2
        expect(page.locator(".events li").first).to_contain_text("gather around robot 2")


def test_a_torn_log_is_shown_as_far_as_it_is(tmp_path: Path, page: Page) -> None:
    path = tmp_path / "mission.mcap"
    write_log(path, scenario())
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
    with Shown("live", str(path)) as shown:
        page.goto(shown.url)
        expect(page.locator("#state")).to_have_text("torn log")
        expect(page.locator("#banner")).to_contain_text("its recorder was killed")
        until(page, lambda: clock_s(page) > 2.0)
        assert all((place or "").startswith("at ") for place in places(page))


def test_fifty_robots_cost_the_page_less_than_a_thirtieth_of_a_second(
    tmp_path: Path, page: Page
) -> None:
    """What a picture costs, in a second in which nothing else takes the processor."""
    size = (
        "team.size=50",
        "map.width=120",
        "map.height=120",
        "start.x=40",
        "start.y=40",
        "clock.limit_s=4",
    )
    log_of(field(tmp_path, *size), tmp_path / "mission.mcap")
    with Shown("live", str(tmp_path / "mission.mcap")) as shown:
        page.goto(shown.url)
        expect(page.locator(".card")).to_have_count(50)
        page.locator("#slider").fill("20")
        until(page, lambda: clock_s(page) > 3.0)
        until(page, lambda: 0 < draw_ms(page) < 1000 / 30)
