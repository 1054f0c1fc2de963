"""The report: figures as PNG and SVG, and one page with all of it that opens without a network."""

import base64
import html
import json
from pathlib import Path
from typing import NamedTuple

import numpy as np

from onehop.analysis.log import Log
from onehop.analysis.palette import BAD, GOOD
from onehop.analysis.report.narrative import NarrativeEvent, narrative, summary_sentence
from onehop.analysis.report.pictures import Picture, draw_pictures
from onehop.analysis.report.report_data import ReportData, gather
from onehop.analysis.report.team_table import team_table
from onehop.contracts.printable import printable
from onehop.wire.codec import as_map
from onehop.wire.summary import punctuality_of

_CSS = Path(__file__).with_name("page.css").read_text(encoding="utf-8")

_GLOSSARY = {
    "Next": "The leader's command to each follower, every few seconds: where it is, who belongs to the "
    "team, which shape. A follower computes its slot from it and measures the link's throughput on it.",
    "Ack": "A follower's answer. A leader that misses several gives the follower up (Lost_Follower).",
    "Beacon, Join": "A leader's broadcast to everyone in range, and a robot's request to be taken in.",
    "slot": "A robot's place in the formation, relative to the leader.",
    "k_rho": "How strongly a follower drives towards its slot. Below the threshold of throughput it is "
    "high: the robot hurries before it loses its leader.",
    "BER": "Bit error rate, of each Next that arrived. That of the modulation decides which messages "
    "are lost to bit errors. That of the thesis (eq. 3.25 read literally: SNR shared by the bits of a "
    "packet) is much higher and decides nothing; it is drawn to compare with the thesis's figures.",
    "epoch": "Number of a roster. The higher one is obeyed when two differ.",
    "border following": "A robot goes around an obstacle that lies between it and its slot.",
}


_LONGEST = 2000
"""Letters of one text on the page."""


class Written(NamedTuple):
    """Files of a report: the page, and each figure as PNG; its SVG has the same stem.

    flaws: why the log is not all that was said in the mission (audit.py).
    """

    page: Path
    figures: tuple[Path, ...]
    flaws: list[str]


def _text(text: str) -> str:
    """Text as HTML shows it, whoever said it."""
    return html.escape(printable(text, _LONGEST))


def write_report(log: Log, folder: Path) -> Written:
    """Write report.html and the figures into a folder. Raises LogError."""
    folder.mkdir(parents=True, exist_ok=True)
    report = gather(log)
    page = folder / "report.html"
    with np.errstate(over="ignore", invalid="ignore"):  # a robot may have said numbers beyond all sums
        pictures = draw_pictures(report, folder)
        page.write_text(_page(report, pictures), encoding="utf-8")
    return Written(page, tuple(picture.path for picture in pictures), report.flaws)


def _page(report: ReportData, pictures: list[Picture]) -> str:
    scenario, summary = report.log.scenario, report.log.summary
    outcome = summary["outcome"] if summary else "unfinished"
    colour = GOOD if outcome == "arrived" else BAD
    sections = "\n".join(_section(picture) for picture in pictures)
    return f"""<!doctype html>
<html lang="en">
<head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{_text(scenario.name)}: {outcome}</title><style>{_CSS}</style></head>
<body>
<h1>{_text(scenario.name)}
<span class="outcome" style="background:{colour}">{outcome}</span></h1>
<p class="lead">{_text(summary_sentence(report))}</p>
{_flaws(report)}
<h2>What happened</h2>
{_narrative_table(narrative(report))}
<h2>The team</h2>
{team_table(report)}
{sections}
<h2>Glossary</h2>
{_glossary()}
<h2>The run</h2>
{_run_table(report)}
<details><summary>The whole scenario</summary>
<pre>{html.escape(json.dumps(as_map(scenario), indent=1))}</pre></details>
</body></html>
"""


def _flaws(report: ReportData) -> str:
    if not report.flaws:
        return ""
    return f'<p class="lead">The log is not all that was recorded: {_text("; ".join(report.flaws))}.</p>'


def _glossary() -> str:
    entries = "".join(f"<dt>{word}</dt><dd>{_text(meaning)}</dd>" for word, meaning in _GLOSSARY.items())
    return f"<dl>{entries}</dl>"


def _section(picture: Picture) -> str:
    data = base64.b64encode(picture.path.read_bytes()).decode()
    title = _text(picture.title)
    return (
        f'<h2>{title}</h2><p class="note">{_text(picture.note)}</p>'
        f'<img alt="{title}" src="data:image/png;base64,{data}">'
    )


def _narrative_table(events: list[NarrativeEvent]) -> str:
    rows = "".join(
        f'<tr class="{"turn" if event.weight > 1 else ""}"><td class="time">{event.at_s:.1f} s</td>'
        f'<td class="text">{_text(event.text)}</td></tr>'
        for event in events
    )
    return f"<table>{rows}</table>"


def _run_table(report: ReportData) -> str:
    log, summary = report.log, report.log.summary or {}
    punctuality = punctuality_of(summary)
    rows = {
        "scenario": f"{log.scenario.name}, seed {log.scenario.seed}",
        "driver": log.metadata.get("driver", ""),
        "simulated": f"{report.end_s:.1f} s in ticks of {report.period_s * 1e3:.0f} ms",
        **({} if punctuality is None else {"real time": punctuality.in_words()}),
        "collisions": summary.get("collisions", ""),
        "digest": summary.get("digest", ""),
        "log": f"{log.path.name}{' (torn: its recorder was killed)' if log.torn else ''}",
        "made by": f"onehop {log.metadata.get('onehop', '?')}, numpy {log.metadata.get('numpy', '?')}",
    }
    return "<table>" + "".join(
        f'<tr><th class="text">{name}</th><td class="text">{_text(str(value))}</td></tr>'
        for name, value in rows.items()
    ) + "</table>"  # fmt: skip
