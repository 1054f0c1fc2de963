"""A page without a browser: what the scripts of the live page say and hear, over the same WebSocket."""

import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any, Self
from urllib.parse import parse_qs, urlsplit

from websockets.sync.client import connect

PATIENCE_S = 60.0

STANDS_S = 2.0
"""How long a mission that stands shows no other tick [s]."""


class PageClient:
    """One page. news: the last of each kind that it was sent; answers: of orders and questions."""

    def __init__(self, url: str, number: int = 0) -> None:
        parts = urlsplit(url)
        token = parse_qs(parts.query)["token"][0]
        self._connecting = connect(
            f"ws://{parts.netloc}/feed/{number}?token={token}",
            origin=f"http://{parts.netloc}",  # type: ignore[arg-type]
        )
        self.news: dict[str, Any] = {}
        self.answers: list[dict[str, Any]] = []
        self.events: list[list[Any]] = []
        self.frames = 0
        self._asked = False

    def __enter__(self) -> Self:
        self._line = self._connecting.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._connecting.__exit__(kind, value, trace)

    def say(self, kind: str, **words: Any) -> None:
        self._line.send(json.dumps({"kind": kind, **words}))

    def look(self, tick: int = -1, robot: int = 0) -> None:
        """Ask for a frame if none is on its way, and take in whatever comes."""
        since = self.tick
        if not self._asked:
            self.say("want", tick=tick, since=since, robot=robot)
            self._asked = True
        try:
            message = json.loads(self._line.recv(timeout=0.5))
        except TimeoutError:
            return
        if message["kind"] == "hello":
            return
        if message["kind"] != "news":
            self.answers.append(message)
            return
        self._asked = False
        self.frames += "frame" in message
        if "events" in message:
            self.events[message["events"]["from"] :] = message["events"]["events"]
        self.news.update(message)

    def until(self, done: Callable[["PageClient"], Any], tick: int = -1) -> None:
        """Look on until something is so."""
        deadline = time.monotonic() + PATIENCE_S
        while not done(self):
            assert time.monotonic() < deadline, (self.tick, self.news.get("state"), self.answers)
            self.look(tick)

    @property
    def tick(self) -> int:
        return int(self.news["frame"]["tick"]) if "frame" in self.news else -1

    def pause(self) -> int:
        """Pause the mission, as soon as it can be; the tick at which it stands, when no more comes."""

        def paused(_: "PageClient") -> bool:
            self.say("pace", ticks_per_s=0, paused=True, steps=0)
            return bool(self.news.get("hand", {}).get("paused"))

        self.until(paused)
        self.until(lambda page: page.tick >= 0)
        stands, since = self.tick, time.monotonic()
        while time.monotonic() < since + STANDS_S:
            self.look()
            if self.tick != stands:
                stands, since = self.tick, time.monotonic()
        return stands

    def order(self, **fault: Any) -> dict[str, Any]:
        """The answer to a fault."""
        before = len(self.answers)
        self.say("order", number=before, fault=fault)
        self.until(lambda page: len(page.answers) > before)
        return self.answers[-1]


class Shown:
    """`onehop run ... --live`, or `onehop live ...`, as a child; url: of its page."""

    def __init__(self, *arguments: str) -> None:
        command = [sys.executable, "-m", "onehop", *arguments, "--no-browser"]
        self.child = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
        )
        assert self.child.stderr is not None
        self.url = self.child.stderr.readline().removeprefix("live page: ").strip()
        if not self.url.startswith("http://"):
            self.child.terminate()
            raise AssertionError(self.url + self.child.communicate()[1])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.child.poll() is None:
            self.child.terminate()
        self.child.communicate(timeout=PATIENCE_S)

    def finish(self) -> tuple[int, str]:
        """Exit status and stdout of a command that ends by itself."""
        printed, _ = self.child.communicate(timeout=2 * PATIENCE_S)
        return self.child.returncode, printed


def shown_mission(folder: Path, scenario: Path, *settings: str) -> Shown:
    """A mission with its page; its output in folder / "out"."""
    changed = [word for setting in settings for word in ("--set", setting)]
    return Shown(
        "run", str(scenario), "--live", "--json", "--no-view", "--no-figure",
        "--out", str(folder / "out"), *changed,
    )  # fmt: skip
