"""The page of a campaign: what held, what was tried, every failure with its timeline, every mission."""

import html
from collections.abc import Iterable
from pathlib import Path

from onehop.chaos import account
from onehop.chaos.hunt import Found, Hunt
from onehop.chaos.sometimes import SOMETIMES
from onehop.chaos.timeline import timeline
from onehop.contracts.printable import ids_in_words, printable
from onehop.wire.output_folder import LOG, explained

_CSS = Path(__file__).with_name("page.css").read_text(encoding="utf-8")

_SHOWN_OPEN = 100
"""Missions that are listed without a click."""

_BLIND_SPOTS = (
    "A campaign finds what its missions happen to do. Nothing below was proved: a property that held "
    "was not broken in these missions. They are short, on small maps, with faults of the kinds listed "
    "here; what needs an hour, a hundred robots, a fault of the operating system or of the network "
    "between processes was not looked for, and a mistake that programs and checker share is not seen."
)


def write_page(hunt: Hunt, path: Path) -> Path:
    """Write the page; it needs no network. Raises InputError."""
    with explained(path, "a folder that can be written"):
        path.write_text(_page(hunt), encoding="utf-8")
    return path


def _page(hunt: Hunt) -> str:
    told = account.as_json(hunt)
    word = f"{told['violations']} broken" if hunt.found else "nothing broken"
    outcomes = ", ".join(f"{count} {name}" for name, count in sorted(told["outcomes"].items()))
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>chaos: {word}</title><style>{_CSS}</style></head><body>
<h1>Chaos <span class="outcome {"bad" if hunt.found else "good"}">{word}</span></h1>
<p class="lead">{told["runs"]} missions, {told["robot_hours"]} simulated robot-hours: {_text(outcomes)}.
{told["repeated"]["twice"]} were run twice and {told["repeated"]["processes"]} as processes, too.</p>
<p class="note">{_BLIND_SPOTS}</p>
<h2>What must hold</h2>{_properties(hunt)}
<h2>What was broken</h2>{"".join(map(_failure, hunt.found)) or "<p>Nothing.</p>"}
{_sometimes(hunt) if hunt.draws else ""}
<h2>Faults</h2>{_rows(("kind", "times"), told["faults"].items())}
<h2>Missions</h2>{_missions(hunt)}
</body></html>
"""


def _text(text: str) -> str:
    return html.escape(printable(text, 2000))


def _rows(head: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    def line(cells: Iterable[object], tag: str) -> str:
        parts = (
            f"<{tag}{'' if place else ' class=text'}>{_text(str(cell))}</{tag}>"
            for place, cell in enumerate(cells)
        )
        return f"<tr>{''.join(parts)}</tr>"

    return f"<table>{line(head, 'th')}{''.join(line(row, 'td') for row in rows)}</table>"


def _properties(hunt: Hunt) -> str:
    rows = []
    for line in account.property_lines(hunt):
        state = "bad" if line.broken else "good" if line.judged else "none"
        word = f"broken in {line.broken}" if line.broken else "held" if line.judged else "never judged"
        rows.append(
            f'<tr class="{state}"><td class="text name">{line.name}</td><td class="text">{word}</td>'
            f'<td>{line.judged}</td><td class="text">{_text(line.says)}</td></tr>'
        )
    head = '<tr><th class="text">property</th><th></th><th>judged in</th><th class="text">says</th></tr>'
    return f"<table>{head}{''.join(rows)}</table>"


def _failure(found: Found) -> str:
    failure, words = found.failure, f"{found.failure.property} in mission {found.name}"
    who = f", robots {ids_in_words(failure.robots)}" if failure.robots else ""
    parts = [f"<h3>{_text(words)}</h3><p>{_text(failure.what)} (tick {failure.tick}{who})</p>"]
    if found.scenario is not None and found.shrunk is not None:
        small = found.shrunk
        text = found.scenario.read_text(encoding="utf-8")
        log = found.scenario.with_name(LOG)
        at = small.failure.tick * small.bundle.scenario.clock.period_ms / 1000.0
        parts.append(f"<p>Made small in {small.runs} runs. Again: ")
        parts.append(f"<code>onehop chaos {_text(str(found.scenario))} --as-is</code>; its log: ")
        parts.append(f"<code>{_text(str(log))}</code>, at {at:.2f} s.</p>")
        if log.exists():
            parts.append(timeline(log, small.failure.tick))
        parts.append(f"<details><summary>scenario</summary><pre>{html.escape(text)}</pre></details>")
    return "".join(parts)


def _sometimes(hunt: Hunt) -> str:
    seen = hunt.total("seen")
    missions = {name: sum(name in row["seen"] for row in hunt.rows) for name in SOMETIMES}
    rows = (
        f'<tr class="{"good" if missions[name] else "bad"}"><td class="text">{_text(name)}</td>'
        f"<td>{missions[name] or 'never'}</td><td>{seen[name] or ''}</td></tr>"
        for name in sorted(SOMETIMES, key=lambda name: missions[name])
    )
    head = '<tr><th class="text">what</th><th>missions</th><th>times</th></tr>'
    title = "<h2>What should happen in some mission</h2>"
    note = "<p>Whatever never happened has not been tried.</p>"
    return f"{title}{note}<table>{head}{''.join(rows)}</table>"


def _missions(hunt: Hunt) -> str:
    """Missions as rows, properties as columns."""
    names = [line.name for line in account.property_lines(hunt)]
    head = "".join(f'<th class="up"><span>{name}</span></th>' for name in names)
    lines = [
        f'<table class="grid"><tr><th class="text">mission</th><th>robots</th><th class="text">map</th>'
        f'<th>faults</th><th>s</th><th class="text">outcome</th>{head}</tr>'
    ]
    for row in hunt.rows:
        broken = {failure["property"] for failure in row["failures"]}
        cells = []
        for name in names:
            state = "x" if name in broken else "h" if row["checked"].get(name, 0) else ""
            cells.append(f"<td class={state}>" if state else "<td>")
        lines.append(
            f"<tr><td class=text>{_text(row['name'])}<td>{row['robots']}"
            f"<td class=text>{_text(row['map'])}<td>{sum(row['faults'].values())}"
            f"<td>{row['sim_s']:.0f}<td class=text>{row['outcome']}{''.join(cells)}</tr>"
        )
    table = "\n".join([*lines, "</table>"])
    if len(hunt.rows) <= _SHOWN_OPEN:
        return table
    return f"<details><summary>all {len(hunt.rows)} missions</summary>{table}</details>"
