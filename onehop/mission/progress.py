"""The progress of a mission on a terminal: time, speed, leader, shape, throughput of each link.

On a terminal a table is drawn over itself; elsewhere a plain line comes every few seconds.
"""

import sys
import time
from typing import Self

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from onehop.contracts.operation import Progress
from onehop.contracts.scenario import Scenario

PLAIN_S = 5.0
"""Wall-clock time between two plain lines."""


class Display:
    """Shows progress while it is entered; `show` takes each report of the world."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._console = Console(stderr=True, highlight=False)
        self._live: Live | None = None
        self._started: tuple[float, int] | None = None
        self._next_plain = 0.0

    def __enter__(self) -> Self:
        if sys.stderr.isatty():
            self._live = Live(Text("starting …"), console=self._console, transient=True)
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    def show(self, progress: Progress) -> None:
        """Take in one report."""
        now = time.monotonic()
        if self._started is None:
            self._started = now, progress.tick
        if self._live is not None:
            self._live.update(Group(self._headline(progress, now), self._links(progress)))
        elif now >= self._next_plain:
            self._next_plain = now + PLAIN_S
            print(self._headline(progress, now).plain, file=sys.stderr, flush=True)

    def tell(self, line: str) -> None:
        """Show a line that stays."""
        self._console.print(f"onehop run: {line}", markup=False, soft_wrap=True)

    def _headline(self, progress: Progress, now: float) -> Text:
        sim_s = progress.time_ns / 1e9
        first_s, first_tick = self._started or (now, progress.tick)
        rate = (progress.tick - first_tick) / (now - first_s) if now > first_s else 0.0
        factor = rate * self._scenario.clock.period_ms / 1000.0
        leaders = [
            (line, line.status)
            for line in progress.robots
            if line.status is not None and line.status.leader == line.robot
        ]
        words = [f"{self._scenario.name}  {sim_s:7.1f} s  {rate:6.0f} ticks/s  {factor:5.1f}x real time"]
        for line, status in leaders:
            words.append(
                f"leader {line.robot} ({status.shape.value}, {len(status.members)} robots, "
                f"{status.error:.0f} m to go, {line.speed:.1f} m/s)"
            )
        if progress.punctuality is not None:
            words.append(progress.punctuality.in_words())
        return Text("  ".join(words))

    def _links(self, progress: Progress) -> Table:
        links = Table(box=None)
        for column in ("robot", "mode", "speed m/s", "to slot m", "throughput Mb/s", "k_rho"):
            links.add_column(column, justify="left" if column == "mode" else "right")
        for line in progress.robots:
            status, speed = line.status, f"{line.speed:.2f}"
            if status is None:
                links.add_row(str(line.robot), "", speed, "", "", "")
                continue
            leads = status.leader == line.robot
            throughput = "" if leads else f"{max(0.0, status.throughput_bps) / 1e6:.3f}"
            weak = not leads and status.throughput_bps < status.threshold_bps
            links.add_row(
                str(line.robot),
                status.mode.value,
                speed,
                "" if leads else f"{status.error:.1f}",
                Text(throughput, style="bold red" if weak else ""),
                "" if leads else f"{status.k_rho:.1f}",
            )
        return links
