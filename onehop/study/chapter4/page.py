"""The page of chapter 4: what is claimed, what comes of it, and the figures."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from onehop.campaign.lines import Row
from onehop.study import page
from onehop.study.chapter4 import failing, missions, ways
from onehop.study.chapter4.claims import ROUTING_WORD, ideal_claim, policy_claims, routing_claims
from onehop.study.chapter4.figures import NAMES
from onehop.study.chapter4.found import Found
from onehop.study.chapter4.reported import REPORTED
from onehop.study.claims import LEAST_SEEDS
from onehop.study.comparison import chosen
from onehop.study.in_words import number, told
from onehop.study.page import Cell, Picture
from onehop.study.statistics import estimate

COLUMNS = (
    ("lost robots", "lost_mean", 1.0), ("missions that lose any [%]", "lost_any", 0.01),
    ("throughput [kb/s]", "throughput_mean_bps", 1e3), ("below threshold [s]", "below_threshold_s", 1.0),
    ("formation error [m]", "error_m", 1.0), ("BER (3.25)", "ber_mean", 1.0),
    ("routing [kB]", "overhead_bytes", 1e3), ("delay [ms]", "delay_ms", 1.0),
)  # fmt: skip
"""Columns of the tables of cells: heading, name in `--json`, and its scale."""

_WORDS = {**ROUTING_WORD, **{policy: name.partition(" ")[0] for policy, name in NAMES.items()}}
"""Routings and policies for people."""

_CHANGES = {"policy": "variable − constant", "routing": "MRSR − MRDV"}

_CONCLUDE = (
    (
        "A verdict",
        "is about the mean over missions with other starts and other noise, at the settings below, on "
        "these three grounds. It says nothing of the one run that the thesis shows in each cell, which "
        "may well have happened: look at how many missions lose nobody.",
    ),
    (
        "Undecided",
        "is not “no difference”: it is a difference that is not larger than the interval says.",
    ),
    (
        "One in twenty",
        "such intervals misses by chance. Believe a finding that its neighbours share.",
    ),
    (
        "Lost followers stop counting",
        "in throughput, time below the threshold, error and bit error rate. A policy that loses its "
        "stragglers looks better there: read these columns beside the lost robots.",
    ),
    (
        "Bounds",
        "show what there is to gain: a perfect link, over which every message arrives at once, and no "
        "link, with which everybody goes alone.",
    ),
)


def write(
    found: Found, summary: dict[str, Any], pictures: Sequence[Picture], seeds: range, path: Path
) -> None:
    """Write the page. pictures: of 4.1, then of 4.2. Raises InputError."""
    lead = (
        f"{summary['missions']} missions of 4.2, {len(seeds)} a cell (seeds {seeds[0]} to {seeds[-1]}): "
        f"three maps, two routings, constant and variable k_rho. Of {len(found.judgements())} claims: "
        f"{page.verdicts(found.judgements())}."
    )
    page.write_page(path, "Chapter 4 again, with statistics", lead, _body(found, summary, pictures))


def _body(found: Found, summary: dict[str, Any], pictures: Sequence[Picture]) -> Iterator[str]:
    yield page.heading("What chapter 4 claims, and what missions say")
    yield page.paragraph(
        "Mean of the paired difference and its 95 % interval: variable less constant k_rho, MRSR less "
        "MRDV, modified less original planner. A claim is confirmed or refuted if the whole interval is "
        f"on one side of what it says, over at least {LEAST_SEEDS} seeds."
    )
    yield page.claims(policy_claims(found.delayed))
    yield page.claims([*routing_claims(found.delayed), ideal_claim(found.undelayed)])
    yield page.claims([ways.way_claim(found.ways), *failing.failing_claims(found.failing)])
    yield page.heading("4.2: every cell, beside the thesis's own run")
    yield page.paragraph("Means over all seeds and their 95 % intervals; in grey the bounds.")
    yield _cells(found, summary)
    yield page.paragraph(_apart(found.delayed))
    yield page.heading("4.2: what changes, seed by seed")
    yield page.paragraph("In bold: the interval excludes 0.")
    yield _differences(summary["differences"])
    yield page.heading("What the thesis leaves open, and what was chosen")
    yield page.definitions(missions.CHOICES)
    yield page.heading("4.3: robots that fail")
    yield _failing(found.failing)
    yield page.heading("4.1: a leader alone on map 1")
    yield _ways(found.ways)
    of_ways = [one for one in pictures if one.path.stem.startswith("ways")]
    yield from map(page.picture, of_ways)
    yield page.heading("4.2: missions, links and bit errors")
    yield page.paragraph(
        "Of each map and routing the first seed that loses as many robots, under both policies, as most "
        "seeds do. One mission proves nothing; the tables above are what to believe."
    )
    yield from map(page.picture, [one for one in pictures if one not in of_ways])
    yield page.heading("What a reader may conclude, and what not")
    yield page.definitions(_CONCLUDE)


def _head(*names: str) -> list[Cell]:
    return [Cell(name, is_text=True) for name in names] + [Cell(name) for name, _, _ in COLUMNS]


def _measures(cell: dict[str, Any], bold: bool = False) -> list[Cell]:
    return [
        Cell(told(cell, name, scale), apart=bold and _excludes_zero(cell, name))
        for _, name, scale in COLUMNS
    ]


def _excludes_zero(cell: dict[str, Any], name: str) -> bool:
    low, high = cell[f"{name.removesuffix('_mean')}_ci95"]
    return low is not None and (low > 0.0 or high < 0.0)


def _cells(found: Found, summary: dict[str, Any]) -> str:
    lines: list[tuple[str, list[Cell]]] = []
    for ground in dict.fromkeys(cell["map"] for cell in summary["cells"]):
        for number_, cell in enumerate(one for one in summary["cells"] if one["map"] == ground):
            reported = REPORTED[cell["map"], cell["routing"], cell["policy"]]
            where = {key: cell[key] for key in ("map", "routing", "policy")}
            names = (ground, _WORDS[cell["routing"]], _WORDS[cell["policy"]])
            beside = f"{reported.words} ({reported.figure.partition(',')[0]})"
            words = [Cell(word, is_text=True) for word in names]
            words.append(Cell(beside, is_text=True, long=True))
            words.append(Cell(_shapes(chosen(found.delayed, where)), is_text=True, long=True))
            lines.append(("" if number_ else "group", [*words, *_measures(cell)]))
        for cell in (one for one in summary["bounds"] if one["map"] == ground):
            words = [
                Cell(word, is_text=True)
                for word in (ground, "", missions.LINK_WORDS[cell["link"]], "", "")
            ]
            lines.append(("bound", [*words, *_measures(cell)]))
    head = _head("map", "routing", "k_rho", "thesis: lost; shape", "last shape [%]")
    return page.rows(head, lines)


def _shapes(rows: Iterable[Row]) -> str:
    """The shapes at the end of missions and how often each comes, in percent."""
    counted = Counter(row["shape"] or "none" for row in rows)
    total = counted.total()
    return ", ".join(f"{shape} {100 * count / total:.0f}" for shape, count in counted.most_common())


def _apart(rows: Sequence[Row]) -> str:
    """In how many missions of each cell it comes out as in the thesis's run."""
    said = []
    for (ground, routing, policy), reported in REPORTED.items():
        own = chosen(rows, {"map": ground, "routing": routing, "policy": policy})
        if reported.lost is None or not own:
            continue
        same = sum(row["lost"] == reported.lost for row in own)
        name = f"{ground} {ROUTING_WORD[routing]} {NAMES[policy].partition(' ')[0]}"
        said.append(f"{name} {100 * same / len(own):.0f} %")
    return "Missions that lose exactly as many robots as the thesis's one run: " + ", ".join(said) + "."


def _differences(differences: Sequence[dict[str, Any]]) -> str:
    lines = []
    for key in dict.fromkeys(one["key"] for one in differences):
        for place, one in enumerate(row for row in differences if row["key"] == key):
            names = (one.get("map", ""), one.get("routing", ""), one.get("policy", ""))
            where = [_WORDS.get(name, str(name)) for name in names]
            where[1 if key == "routing" else 2] = _CHANGES[key]
            words = [Cell(word, is_text=True) for word in where]
            lines.append(("" if place else "group", [*words, *_measures(one, bold=True)]))
    return page.rows(_head("map", "routing", "k_rho"), lines)


def _failing(rows: Sequence[Row]) -> str:
    lines = []
    for name, expected in failing.EXPECTED.items():
        own = [row for row in rows if row["values"]["scenario"] == name]
        ends = Counter(
            f"robot {row['leader']} leads a {row['shape']} of {', '.join(map(str, row['members']))}"
            for row in own
        )
        thesis = (
            f"robot {expected.leader} leads a {expected.shape} of "
            f"{', '.join(map(str, expected.members))} ({expected.source})"
        )
        came = "; ".join(f"{words}: {count} of {len(own)}" for words, count in ends.most_common(3))
        lines.append(
            ("", [Cell(word, is_text=True, long=True) for word in (expected.what, thesis, came)])
        )
    head = [Cell(word, is_text=True) for word in ("what fails", "thesis", "here")]
    return page.rows(head, lines)


def _ways(rows: Sequence[Row]) -> str:
    lines = []
    for planner in ways.PLANNERS:
        own = chosen(rows, {"planner": planner})
        there = [row for row in own if row["arrived"]]
        length, time_s = (estimate([row[name] for row in there]).mean for name in ("length_m", "sim_s"))
        cells = [Cell(planner, is_text=True), Cell(f"{len(there)} of {len(own)}")]
        cells += [Cell("-" if value is None else number(value)) for value in (length, time_s)]
        cells.append(Cell(number(float(sum(row["steps_back"] for row in own)) / max(len(own), 1))))
        lines.append(("", cells))
    names = ("arrived", "their way [m]", "their time [s]", "steps back, of all")
    head = [Cell("planner", is_text=True), *(Cell(name) for name in names)]
    return page.rows(head, lines)
