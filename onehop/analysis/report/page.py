"""The report: figures as PNG and SVG, and one page with all of it that opens without a network."""

import base64
import html
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from onehop.analysis.log import Log
from onehop.analysis.palette import BAD, GOOD
from onehop.analysis.report.canvas import save, styled
from onehop.analysis.report.follower_chart import follower_chart
from onehop.analysis.report.mode_chart import mode_chart
from onehop.analysis.report.narrative import NarrativeEvent, narrative, summary_sentence
from onehop.analysis.report.radio_chart import losses, radio_chart
from onehop.analysis.report.report_data import ReportData, gather
from onehop.analysis.report.sequence_chart import MAX_CHARTS, elections, sequence_chart
from onehop.analysis.trajectory import figure_of
from onehop.wire.codec import as_map

_CSS = Path(__file__).with_name("page.css").read_text(encoding="utf-8")

_WORDS = {
    "Next": "The leader's command to each follower, every few seconds: where it is, who belongs to the "
    "team, which shape. A follower computes its slot from it and measures the link's throughput on it.",
    "Ack": "A follower's answer. A leader that misses several gives the follower up (Lost_Follower).",
    "Beacon, Join": "A leader's word to everyone in range, and a robot's request to be taken in.",
    "slot": "A robot's place in the formation, relative to the leader.",
    "k_rho": "How strongly a follower drives towards its slot. Below the threshold of throughput it is "
    "high: the robot hurries before it loses its leader.",
    "epoch": "Number of a roster. The higher one is obeyed when two differ.",
    "border following": "A robot goes around an obstacle that lies between it and its slot.",
}


@dataclass(frozen=True, slots=True)
class _Picture:
    title: str
    note: str
    path: Path


class Written(NamedTuple):
    """Files of a report: the page, and each figure as PNG; its SVG has the same stem."""

    page: Path
    figures: tuple[Path, ...]


def write_report(log: Log, folder: Path) -> Written:
    """Write report.html and the figures into a folder. Raises LogError."""
    folder.mkdir(parents=True, exist_ok=True)
    material = gather(log)
    with styled():
        pictures = list(_pictures(material, folder))
    page = folder / "report.html"
    page.write_text(_page(material, pictures), encoding="utf-8")
    return Written(page, tuple(picture.path for picture in pictures))


def _pictures(material: ReportData, folder: Path) -> Iterator[_Picture]:
    yield _Picture(
        "Who did what when",
        "The upper rows say who led, in which shape, and which faults were in force. Below, every "
        "robot in its own colour: the deeper, the more it had to do by itself.",
        save(mode_chart(material), folder, "timeline"),
    )
    yield _Picture(
        "Where",
        "Paths from ground truth. Every 20 s the formation is drawn; a thin line joins each follower "
        "to the leader that it obeys.",
        save(figure_of(material.log, material.tables), folder, "trajectory"),
    )
    for number, (before, after) in enumerate(elections(material)[:MAX_CHARTS], start=1):
        yield _Picture(
            f"How robot {after.leader} came to lead at {after.at_s:.1f} s",
            "Time runs downwards, one line a robot; an arrow is a message in its sender's colour, a "
            "broken red one a message that was lost. Nobody votes: the same list of ids gives everyone "
            "the same leader.",
            save(sequence_chart(material, before, after), folder, f"election-{number}"),
        )
    yield _Picture(
        "Each follower",
        "A robot whose throughput falls below the threshold raises its gain k_rho and hurries, because "
        "it is about to lose its leader. Dashed lines mark robots that went, dotted ones a new leader.",
        save(follower_chart(material), folder, "followers"),
    )
    yield _Picture(
        "The radio",
        "Left: messages that did not arrive, by receiver and reason. Right: what was handed to the "
        "radio, and what routing added.",
        save(radio_chart(material), folder, "radio"),
    )


def _page(material: ReportData, pictures: list[_Picture]) -> str:
    scenario, summary = material.log.scenario, material.log.summary
    outcome = summary["outcome"] if summary else "unfinished"
    colour = GOOD if outcome == "arrived" else BAD
    sections = "\n".join(_section(picture) for picture in pictures)
    return f"""<!doctype html>
<html lang="en">
<head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{html.escape(scenario.name)}: {outcome}</title><style>{_CSS}</style></head>
<body>
<h1>{html.escape(scenario.name)}
<span class="outcome" style="background:{colour}">{outcome}</span></h1>
<p class="lead">{html.escape(summary_sentence(material))}</p>
<h2>What happened</h2>
{_story_table(narrative(material))}
<h2>The team</h2>
{_team_table(material)}
{sections}
<h2>Words</h2>
{_glossary()}
<h2>The run</h2>
{_run_table(material)}
<details><summary>The whole scenario</summary>
<pre>{html.escape(json.dumps(as_map(scenario), indent=1))}</pre></details>
</body></html>
"""


def _glossary() -> str:
    entries = "".join(
        f"<dt>{word}</dt><dd>{html.escape(meaning)}</dd>" for word, meaning in _WORDS.items()
    )
    return f"<dl>{entries}</dl>"


def _section(picture: _Picture) -> str:
    data = base64.b64encode(picture.path.read_bytes()).decode()
    title = html.escape(picture.title)
    return (
        f'<h2>{title}</h2><p class="note">{html.escape(picture.note)}</p>'
        f'<img alt="{title}" src="data:image/png;base64,{data}">'
    )


def _story_table(events: list[NarrativeEvent]) -> str:
    rows = "".join(
        f'<tr class="{"turn" if event.weight > 1 else ""}"><td class="time">{event.at_s:.1f} s</td>'
        f'<td class="text">{html.escape(event.text)}</td></tr>'
        for event in events
    )
    return f"<table>{rows}</table>"


def _team_table(material: ReportData) -> str:
    rows = "".join(_team_row(material, robot) for robot in material.robots)
    heads = "".join(
        f'<th class="{kind}">{name}</th>'
        for kind, name in (
            ("text", "robot"), ("text", "fate"), ("", "led for"), ("", "drove"), ("", "mean error"),
            ("", "mean throughput"), ("", "below threshold"), ("", "messages to it lost"),
        )
    )  # fmt: skip
    return f"<table><tr>{heads}</tr>{rows}</table>"


def _team_row(material: ReportData, robot: int) -> str:
    own = material.tables["status"].of(robot)
    poses = material.tables["poses"].of(robot)
    dead = robot in material.dead
    following = own.where((own["leader"] != robot) & (own["throughput_bps"] >= 0))
    led_s = np.count_nonzero(own["leader"] == robot) * material.period_s
    drove = np.hypot(np.diff(poses["x"]), np.diff(poses["y"])).sum()
    name = f"{robot}"
    cells = [f"{led_s:.0f} s" if led_s else "", f"{drove:.0f} m"]
    if len(following):
        below = np.mean(following["throughput_bps"] < following["threshold_bps"])
        cells += [
            f"{following['error'].mean():.1f} m",
            f"{following['throughput_bps'].mean() / 1e3:.0f} kb/s",
            f"{100 * below:.0f} %",
        ]
    else:
        cells += [""] * 3
    cells.append(str(sum(losses(material)[robot].values())))
    numbers = "".join(f"<td>{cell}</td>" for cell in cells)
    chip = f'<span class="chip" style="background:{material.colours[robot]}"></span>'
    label = f"<s>robot {name}</s>" if dead else f"robot {name}"
    fate = html.escape(_fate(material, robot))
    return (
        f'<tr class="{"dead" if dead else ""}"><td class="text name">{chip}{label}</td>'
        f'<td class="text">{fate}</td>{numbers}</tr>'
    )


def _fate(material: ReportData, robot: int) -> str:
    summary = material.log.summary
    if summary is not None:
        if robot in summary["arrived"]:
            return "arrived"
        for one in summary["lost"]:
            if one["robot"] == robot:
                at = "" if one["why"] == "did not arrive" else f" at {one['at_s']:.0f} s"
                return f"{one['why']}{at}"
    dead = material.dead.get(robot)
    return f"{dead.why} at {dead.at_s:.0f} s" if dead else "on its way when the log ends"


def _run_table(material: ReportData) -> str:
    log, summary = material.log, material.log.summary or {}
    rows = {
        "scenario": f"{log.scenario.name}, seed {log.scenario.seed}",
        "driver": log.metadata.get("driver", ""),
        "simulated": f"{material.end_s:.1f} s in ticks of {material.period_s * 1e3:.0f} ms",
        "collisions": summary.get("collisions", ""),
        "digest": summary.get("digest", ""),
        "log": f"{log.path.name}{' (torn: its recorder was killed)' if log.torn else ''}",
        "made by": f"onehop {log.metadata.get('onehop', '?')}, numpy {log.metadata.get('numpy', '?')}",
    }
    return "<table>" + "".join(
        f'<tr><th class="text">{name}</th><td class="text">{html.escape(str(value))}</td></tr>'
        for name, value in rows.items()
    ) + "</table>"  # fmt: skip
