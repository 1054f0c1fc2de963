"""`onehop live`, and `--live` of `onehop run`: the live page, on logs or on the mission that runs."""

import contextlib
import os
import sys
import time
import webbrowser
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from onehop.commands.output import say
from onehop.contracts.errors import InputError
from onehop.live.guard import parse_address
from onehop.live.hand import Hand
from onehop.live.server import LiveServer
from onehop.live.source import Source
from onehop.mission.launcher import Attendance
from onehop.mission.stops import Stopped
from onehop.wire.output_folder import LOG

GRACE_S = 3.0
"""How long after a mission's end a page may take to come back, after a reload say [s]."""

LOOK_S = 0.1
"""How often it is looked whether anybody still looks on [s]."""

MOST_LOGS = 2
"""Logs that have room side by side."""


def live(logs: Sequence[Path], address: str, browser: bool) -> int:
    """Show logs until Ctrl-C; returns the exit status."""
    if len(logs) > MOST_LOGS:
        raise InputError("LOG", f"{len(logs)} logs", f"at most {MOST_LOGS}, side by side")
    sources = [Source(log) for log in logs]
    for source in sources:
        source.open()
    with LiveServer(sources, parse_address(address)) as server:
        _tell(server.url, browser)
        with contextlib.suppress(Stopped, KeyboardInterrupt):
            while True:
                time.sleep(3600.0)
    return 0


@dataclass(slots=True)
class LivePage:
    """The page of the mission that this command runs. attend: for launcher.run."""

    server: LiveServer
    source: Source
    attend: Attendance

    def stay(self, summary: dict[str, Any]) -> None:
        """After the mission: as long as anybody looks on, or until Ctrl-C."""
        self.source.end(f"The mission ended: {summary['outcome']}, {summary['reason']}.")
        told, alone_s = False, 0.0
        with contextlib.suppress(Stopped, KeyboardInterrupt):
            while alone_s < GRACE_S:
                if self.server.viewers and not told:
                    told = True
                    say(f"{self.server.url} stays until it is closed; Ctrl-C ends it")
                alone_s = 0.0 if self.server.viewers else alone_s + LOOK_S
                time.sleep(LOOK_S)


@contextlib.contextmanager
def live_page(
    address: str, browser: bool, folder: Path, words: Sequence[str], is_paced: bool = True
) -> Iterator[LivePage]:
    """The page of a mission that is about to start.

    words: of its command, to run it again. is_paced: whether it goes as fast as it is told, as one in
    lock-step does.
    """
    log = folder / LOG
    hand = Hand(words, is_paced)
    source = Source(log, is_ours=True, older_ns=log.stat().st_mtime_ns if log.exists() else None)
    with LiveServer([source], parse_address(address), hand) as server:
        _tell(server.url, browser)
        yield LivePage(server, source, hand.attend)


def _tell(url: str, browser: bool) -> None:
    """Print the address, and open it where there is a screen."""
    say(f"live page: {url}")
    has_screen = (
        sys.platform == "darwin" or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )
    if browser and has_screen:
        webbrowser.open(url)


def words_of(
    scenario: Path, settings: Sequence[str], seed: int, places: Sequence[tuple[str, Any]]
) -> tuple[str, ...]:
    """What follows `onehop run` to run the same mission again. places: options that may be None."""
    words = [str(scenario), "--seed", str(seed)]
    for option, value in places:
        if value is not None:
            words.append(f"{option}={value}")
    for setting in settings:
        words += ["--set", setting]
    return tuple(words)
