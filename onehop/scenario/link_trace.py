"""A trace of measured links, from its CSV file: checked line by line (docs/link-traces.md)."""

import math
from collections.abc import Iterable, Iterator

from onehop.contracts.errors import ScenarioError
from onehop.contracts.link_trace import QUANTITIES, LinkSeries, LinkTrace
from onehop.contracts.printable import printable
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.ranges import Range
from onehop.contracts.units import nanoseconds
from onehop.scenario.bundle import Bundle

HEADER = ("time_s", "from", "to")
"""The first columns; the fourth names what was measured."""

LEVEL = Range(-150.0, 150.0)
"""SNR, RSSI or loss [dB, dBm]: above what a radio is deaf to, below its own emission in its receiver."""

TIME = Range(0.0, 1e6)
"""Simulated time [s]."""

MOST_ROWS = 500_000
"""Rows of a trace: 15 links both ways, ten times a second for 27 minutes."""


def link_trace(bundle: Bundle, origin: str = "scenario") -> LinkTrace | None:
    """The trace of a mission, if it has one. origin: what to call the scenario. Raises ScenarioError."""
    radio = bundle.scenario.radio
    if not radio.links:
        return None
    where = f"{origin}: radio.links: {radio.links}"
    if radio.links not in bundle.files:
        raise ScenarioError(where, "the file is not there", "the trace as it was when the mission ran")
    return parse(bundle.files[radio.links], where, bundle.scenario.team.robots, radio)


def parse(data: bytes, where: str, robots: Iterable[int], radio: RadioSection) -> LinkTrace:
    """The trace in a file. where: what to call it. robots: of the mission. Raises ScenarioError."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise ScenarioError(f"{where}:{line}", "no UTF-8 text", "a CSV file") from None
    rows = _rows(text)
    quantity = _quantity(next(rows, (1, [])), where)
    if radio.links_use == "on top" and quantity != "loss_db":
        raise ScenarioError(
            where, f'{quantity} cannot come on top of the model, as links_use = "on top" says',
            'column loss_db, or links_use = "instead"',
        )  # fmt: skip
    team = frozenset(robots)
    series: dict[tuple[int, int], tuple[list[int], list[float | None]]] = {}
    for count, (number, cells) in enumerate(rows):
        at = f"{where}:{number}"
        if count == MOST_ROWS:
            raise ScenarioError(at, f"more than {MOST_ROWS} rows", "a shorter or a coarser trace")
        if len(cells) != len(HEADER) + 1:
            remedy = f"{len(HEADER) + 1}, as in 12.5,1,2,23.0"
            raise ScenarioError(at, f"{len(cells)} values in a row", remedy)
        time_ns = nanoseconds(_number(cells[0], "time_s", TIME, at))
        pair = _robot(cells[1], "from", team, at), _robot(cells[2], "to", team, at)
        if pair[0] == pair[1]:
            raise ScenarioError(at, f"a link of robot {pair[0]} to itself", "two robots")
        times, values = series.setdefault(pair, ([], []))
        if times and time_ns <= times[-1]:
            what = f"{cells[0]} s is not after the row before of robots {pair[0]} to {pair[1]}"
            raise ScenarioError(at, what, "the rows of each link in the order of their time")
        times.append(time_ns)
        values.append(_number(cells[3], quantity, LEVEL, at) if cells[3] else None)
    if not series:
        raise ScenarioError(where, "no row below the header", "at least one, as in 12.5,1,2,23.0")
    return LinkTrace(
        quantity,
        tuple(
            LinkSeries(*pair, tuple(times), tuple(values))
            for pair, (times, values) in sorted(series.items())
        ),
    )


def _rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """Number and values of each line; without those that are empty, and without comments."""
    for number, line in enumerate(text.split("\n"), start=1):
        content = line.strip()
        if content and not content.startswith("#"):
            yield number, [cell.strip() for cell in content.split(",")]


def _quantity(header: tuple[int, list[str]], where: str) -> str:
    """What the header says was measured."""
    number, names = header
    *first, last = names or [""]
    if tuple(first) != HEADER or last not in QUANTITIES:
        remedy = " or ".join(",".join((*HEADER, quantity)) for quantity in QUANTITIES)
        shown = printable(",".join(names), 60)
        raise ScenarioError(f"{where}:{number}", f"{shown!r} is no header", remedy)
    return last


def _number(text: str, name: str, limits: Range, at: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not limits.least <= value <= limits.most:
        raise ScenarioError(at, f"{name} {printable(text, 40)!r}", f"a number from {limits}")
    return value


def _robot(text: str, name: str, team: frozenset[int], at: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 12 and int(text) in team):
        ids = ", ".join(map(str, sorted(team)))
        raise ScenarioError(
            at, f"{name} {printable(text, 40)!r} is no robot of the team", f"one of {ids}"
        )
    return int(text)
