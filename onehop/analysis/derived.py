"""Tables of a log that are computed from its truth and its radio together: energy and links."""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from onehop.analysis.connectivity import Connectivity
from onehop.analysis.energy import EnergyMeter
from onehop.analysis.tables import Row, Table
from onehop.contracts.briefings import radio_briefing
from onehop.contracts.messages import RadioRecord, Truth
from onehop.maps.map_file import load_map
from onehop.plugins import plugged_radio
from onehop.scenario.bundle import Bundle
from onehop.scenario.link_trace import link_trace

Watched = Iterator[tuple[Truth, RadioRecord]]
"""Ground truth of each tick and what the radio did in it."""


class DerivedSpec(NamedTuple):
    """row: what a row is, for people. columns: after tick and time_s. rows: of the ticks of a log."""

    row: str
    columns: tuple[tuple[str, type], ...]
    rows: Callable[[Bundle, Watched], Iterator[tuple[int, Row]]]


def _energy(bundle: Bundle, watched: Watched) -> Iterator[tuple[int, Row]]:
    scenario = bundle.scenario
    meter = EnergyMeter(scenario.radio, scenario.clock.period_ns / 1e9)
    for truth, record in watched:
        for robot, spent in meter.take(truth, record).items():
            yield truth.tick, (robot, *spent)


def _links(bundle: Bundle, watched: Watched) -> Iterator[tuple[int, Row]]:
    links = connectivity_of(bundle)
    for truth, _ in watched:
        if links.is_due(truth.tick):
            for pair in links.pairs(truth):
                yield truth.tick, pair


def connectivity_of(bundle: Bundle) -> Connectivity:
    """The links of a mission, in the radio and on the map of its scenario."""
    scenario = bundle.scenario
    walls = load_map(scenario.map, bundle.files).segments
    briefing = plugged_radio(radio_briefing(scenario, walls, link_trace(bundle)))
    return Connectivity(briefing, scenario.team.next_msdu_bytes)


DERIVED: dict[str, DerivedSpec] = {
    "energy": DerivedSpec(
        "what a robot spent in a tick, driving and in its card ([sweeps.md](sweeps.md#energy))",
        (("robot", int), ("drive_j", float), ("radio_j", float)),
        _energy,
    ),
    "links": DerivedSpec(
        "a pair of robots, every 0.5 s ([sweeps.md](sweeps.md#connected))",
        (("robot", int), ("other", int), ("snr_db", float), ("linked", bool)),
        _links,
    ),
}


def derive(name: str, bundle: Bundle, watched: Watched) -> Table:
    """One of these tables."""
    spec = DERIVED[name]
    ticks, rows = [], []
    for tick, row in spec.rows(bundle, watched):
        ticks.append(tick)
        rows.append(row)
    at = np.array(ticks, dtype=np.int64)
    table = Table({"tick": at, "time_s": at * (bundle.scenario.clock.period_ns / 1e9)})
    for place, (column, kind) in enumerate(spec.columns):
        values: list[Any] = [row[place] for row in rows]
        table[column] = np.array(values, dtype={int: np.int64, float: np.float64, bool: np.bool_}[kind])
    return table


def markdown() -> str:
    """These tables and their columns as docs/reading-logs.md shows them."""
    rows = [
        f"| `{name}` | {spec.row} | `{' '.join(column for column, _ in spec.columns)}` |"
        for name, spec in DERIVED.items()
    ]
    return "\n".join(["| table | a row is | columns |", "|---|---|---|", *rows])
