"""The page of the phase diagram: where a policy matters, for which measure, and by how much."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from onehop.campaign.lines import Row
from onehop.study import page
from onehop.study.chapter4.missions import HELD, HOLD_AT_S, LINK_WORDS, SETUP_TIMEOUT_S
from onehop.study.in_words import told
from onehop.study.page import Cell, Picture
from onehop.study.phase.frontier import Effect, Place, effects
from onehop.study.phase.grid import Grid
from onehop.study.phase.heat_maps import SHOWN, Shown

WHAT_TO_SEE = (
    "A row a measure. First its mean under each policy; then what each other policy changes, seed by "
    "seed: violet is better, orange worse. The heavy line is the frontier: inside it the 95 % interval "
    "of the change excludes 0 (bold), outside the policy makes no difference that these missions show. "
    "The lower the gain k_rho_min, the farther a follower trails its slot; the longer it is held, the "
    "farther its leader is gone."
)

_COLUMNS = (
    ("lost robots", "lost_mean", 1.0), ("throughput [kb/s]", "throughput_mean_bps", 1e3),
    ("below threshold [s]", "below_threshold_s", 1.0), ("formation error [m]", "error_m", 1.0),
    ("connected [%]", "connected_share", 0.01), ("BER (3.25)", "ber_mean", 1.0),
    ("routing [kB]", "overhead_bytes", 1e3), ("delay [ms]", "delay_ms", 1.0),
    ("driving [kJ]", "drive_j", 1e3), ("card [J]", "radio_j", 1.0),
)  # fmt: skip

_WHY = (
    ("Low gain: the policy works along the whole way",
     "A follower at the leader's speed trails its slot by that speed / k_rho. If that takes it to where "
     "fades push the throughput below the threshold, it is pulled in all the time, delay or no delay."),
    ("High gain: the speed limit hides it",
     "Speed is k_rho times the distance, and at most the limit. Whoever is far enough from its slot to "
     "be below the threshold drives at the limit already; a higher gain adds nothing."),
    ("Long delay: no gain can help",
     "A robot that is held does not move. Once its leader is out of range, whether it is heard again is "
     "up to relays and chance."),
)  # fmt: skip
"""The mechanism, for any numbers."""

_CONCLUDE = (
    ("A place inside the frontier",
     "there the policy changes the mean of this measure on this ground, over other starts and noise."),
    ("A lone place",
     "one in twenty intervals misses by chance: of a grid believe places whose neighbours agree."),
    ("Lost followers stop counting",
     "in throughput, time below the threshold and error: read these beside the lost robots."),
    ("Outside the frontier",
     "the policies do not do the same; they differ by less than the intervals in the table say."),
)  # fmt: skip


def write(
    grid: Grid,
    rows: Sequence[Row],
    summary: dict[str, Any],
    picture: Picture,
    seeds: range,
    path: Path,
) -> None:
    """Write the page. Raises InputError."""
    lead = (
        f"{summary['missions']} missions of {grid.scenario}: {len(grid.places)} places, {len(seeds)} "
        f"seeds each ({seeds[0]} to {seeds[-1]}), under {', '.join(grid.policies)}. Robots "
        f"{', '.join(map(str, HELD))} are held from second {HOLD_AT_S:g} on; setup may take "
        f"{SETUP_TIMEOUT_S:g} s."
    )
    body = _body(grid, rows, summary, picture)
    page.write_page(path, "Where a gain policy matters", lead, body)


def _body(grid: Grid, rows: Sequence[Row], summary: dict[str, Any], picture: Picture) -> Iterator[str]:
    yield page.heading("Where it matters")
    for policy in grid.policies[1:]:
        yield page.paragraph(f"{policy} against {grid.policies[0]}: " + in_short(grid, rows, policy))
    yield page.picture(picture)
    yield page.heading("What to expect, and why")
    yield page.definitions(_WHY)
    yield page.heading("Every place")
    yield page.paragraph("Means and their 95 % intervals; in grey the bounds.")
    yield _cells(summary)
    yield page.heading("What changes, seed by seed")
    yield page.paragraph("In bold: the interval excludes 0.")
    yield _differences(summary["differences"])
    yield page.heading("What a reader may conclude, and what not")
    yield page.definitions(_CONCLUDE)


def in_short(grid: Grid, rows: Sequence[Row], policy: str) -> str:
    """At how many places a policy is better, and at how many worse, than the first, by measure."""
    said = []
    for shown in SHOWN:
        change = (grid.policies[0], policy)
        found = effects(rows, grid.places, shown.measure, change)
        said.append(f"{shown.heading}: {_counted(found, shown)}")
    return "; ".join(said) + "."


def _counted(found: dict[Place, Effect], shown: Shown) -> str:
    better = [one.estimate for one in found.values() if one.better]
    worse = [one.estimate for one in found.values() if one.worse]
    means = [one.mean / shown.scale for one in (*better, *worse) if one.mean is not None]
    by = f" (by {min(means):.3g} to {max(means):.3g})" if means else ""
    return f"better at {len(better)}, worse at {len(worse)} of {len(found)} places{by}"


def _measures(row: dict[str, Any], bold: bool) -> list[Cell]:
    cells = []
    for _, name, scale in _COLUMNS:
        low, high = row[f"{name.removesuffix('_mean')}_ci95"]
        apart = bold and low is not None and (low > 0.0 or high < 0.0)
        cells.append(Cell(told(row, name, scale), apart=apart))
    return cells


def _cells(summary: dict[str, Any]) -> str:
    lines = []
    keys = ("k_rho_min", "hold_s")
    for place in dict.fromkeys(tuple(one[key] for key in keys) for one in summary["cells"]):
        for kind, rows, name in (("", summary["cells"], "policy"), ("bound", summary["bounds"], "link")):
            for row in rows:
                if tuple(row[key] for key in keys) == place:
                    word = row[name] if not kind else LINK_WORDS[row[name]]
                    lines.append(
                        (kind, [*_place(row), Cell(word, is_text=True), *_measures(row, False)])
                    )
    return page.rows(_head("policy"), lines)


def _differences(differences: Sequence[dict[str, Any]]) -> str:
    lines = []
    for row in differences:
        change = Cell(f"{row['policy']} less {row['against']}", is_text=True)
        lines.append(("", [*_place(row), change, *_measures(row, True)]))
    return page.rows(_head("change"), lines)


def _place(row: dict[str, Any]) -> list[Cell]:
    return [Cell(f"{row['k_rho_min']:g}"), Cell(f"{row['hold_s']:g}")]


def _head(what: str) -> list[Cell]:
    names = [Cell(name) for name, _, _ in _COLUMNS]
    return [Cell("k_rho_min [1/s]"), Cell("held [s]"), Cell(what, is_text=True), *names]
