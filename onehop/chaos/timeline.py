"""The timeline of a failure as SVG: what each robot was doing, what was broken, and where it failed."""

import html
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from onehop.analysis.palette import BAD, FAINT, INK
from onehop.checking.snapshot import Snapshot, snapshot
from onehop.contracts.fault_section import FaultSection, fault_in_words
from onehop.contracts.team import Mode
from onehop.wire.log_reader import LogFile

WIDTH, LEFT, ROW, TOP = 900, 70, 22, 18
"""Of the picture, its labels' column, a robot's row, and the row of times [px]."""

_COLOURS = {
    Mode.SETUP: "#d8d4cc", Mode.LEADING: "#0072b2", Mode.ALONE: "#56b4e9", Mode.FOLLOWING: "#7fc8a9",
    Mode.NARROW: "#4d9f7a", Mode.BORDER: "#b8a800", Mode.GIVING_WAY: "#e6c200",
    Mode.LOST_LEADER: "#e69f00", Mode.JOINING: "#cc79a7", Mode.STOPPED: "#9a9a9a",
}  # fmt: skip


@dataclass(slots=True)
class _Band:
    """What a robot was doing from one tick to another."""

    mode: Mode
    first: int
    last: int


@dataclass(slots=True)
class _Tracks:
    """What happened, by robot. faults: with the tick at which each began."""

    bands: dict[int, list[_Band]] = field(default_factory=dict)
    faults: list[tuple[int, FaultSection]] = field(default_factory=list)
    ticks: int = 1

    def take(self, now: Snapshot) -> None:
        self.ticks = now.tick + 1
        if now.truth is not None:
            self.faults += [(now.tick, fault) for fault in now.truth.faults]
        for robot, action in now.actions.items():
            if action.status is None:
                continue
            bands = self.bands.setdefault(robot, [])
            if bands and bands[-1].mode is action.status.mode and bands[-1].last == now.tick - 1:
                bands[-1].last = now.tick
            else:
                bands.append(_Band(action.status.mode, now.tick, now.tick))


def timeline(log: Path, failed_at: int) -> str:
    """The SVG of a log, with a line at the tick of the failure (-1: none)."""
    opened = LogFile(log)
    scenario = opened.bundle.scenario
    robots, period_s = scenario.team.robots, scenario.clock.period_ms / 1000.0
    tracks, team = _Tracks(), frozenset(robots)
    for logged in opened.ticks():
        tracks.take(snapshot(logged, True, team))
    scale = (WIDTH - LEFT - 10) / tracks.ticks
    rows = {robot: TOP + ROW * place for place, robot in enumerate(robots)}
    bottom = TOP + ROW * len(robots)
    shapes = [
        *_times(tracks.ticks, period_s, scale, bottom),
        *_modes(tracks, rows, scale),
        *_faults(tracks, rows, scale, period_s),
    ]
    if failed_at >= 0:
        x = LEFT + failed_at * scale
        shapes.append(f'<path d="M{x:.1f} {TOP}V{bottom}" stroke="{BAD}" stroke-width="2"/>')
    legend = _legend(tracks, bottom + 16)
    labels = "".join(
        f'<text x="4" y="{y + 15}" fill="{INK}">robot {robot}</text>' for robot, y in rows.items()
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {bottom + 26}" '
        f'font-family="system-ui, sans-serif" font-size="11">{labels}{"".join(shapes)}{legend}</svg>'
    )


def _times(ticks: int, period_s: float, scale: float, bottom: int) -> Iterator[str]:
    end_s = ticks * period_s
    step_s = next((step for step in (1, 2, 5, 10, 20, 50, 100) if end_s / step <= 12), 200)
    for number in range(int(end_s / step_s) + 1):
        x = LEFT + number * step_s / period_s * scale
        yield f'<text x="{x:.1f}" y="11" fill="{FAINT}">{number * step_s} s</text>'
        yield f'<path d="M{x:.1f} {TOP}V{bottom}" stroke="#eeeeee"/>'


def _modes(tracks: _Tracks, rows: dict[int, int], scale: float) -> Iterator[str]:
    for robot, bands in tracks.bands.items():
        for band in bands:
            x, width = LEFT + band.first * scale, (band.last + 1 - band.first) * scale
            yield (
                f'<rect x="{x:.1f}" y="{rows[robot] + 7}" width="{width:.1f}" height="12" '
                f'fill="{_COLOURS[band.mode]}"><title>{band.mode.value}</title></rect>'
            )


def _faults(tracks: _Tracks, rows: dict[int, int], scale: float, period_s: float) -> Iterator[str]:
    """A line above the robots that a fault concerns, as long as it was to last."""
    for tick, fault in tracks.faults:
        x = LEFT + tick * scale
        ticks = fault.duration_s / period_s if fault.duration_s else 0.0
        width = max(3.0, min(ticks, tracks.ticks - tick) * scale)
        words = html.escape(f"{tick * period_s:g} s: {fault_in_words(fault)}")
        for robot in fault.robots or tuple(rows):
            yield (
                f'<rect x="{x:.1f}" y="{rows[robot] + 2}" width="{width:.1f}" height="4" '
                f'fill="{BAD}"><title>{words}</title></rect>'
            )


def _legend(tracks: _Tracks, y: int) -> str:
    shown = {band.mode for bands in tracks.bands.values() for band in bands}
    x, parts = LEFT, []
    for mode, colour in _COLOURS.items():
        if mode in shown:
            parts.append(f'<rect x="{x}" y="{y - 9}" width="10" height="10" fill="{colour}"/>')
            parts.append(f'<text x="{x + 14}" y="{y}" fill="{INK}">{mode.value}</text>')
            x += 28 + 6 * len(mode.value)
    parts.append(f'<rect x="{x}" y="{y - 6}" width="14" height="4" fill="{BAD}"/>')
    parts.append(f'<text x="{x + 18}" y="{y}" fill="{INK}">fault</text>')
    return "".join(parts)
