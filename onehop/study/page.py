"""The page of a study: tables, claims and figures in one file that needs no network."""

import base64
import html
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from onehop.contracts.printable import printable
from onehop.study.claims import Expects, Judgement, Verdict
from onehop.study.in_words import interval
from onehop.wire.output_folder import explained

_CSS = Path(__file__).with_name("page.css").read_text(encoding="utf-8")

_LONGEST = 4000
"""Letters of one text on the page."""


class Picture(NamedTuple):
    """One figure. path: its PNG; the SVG has the same stem."""

    title: str
    note: str
    path: Path


class Cell(NamedTuple):
    """One cell of a table. apart: its interval excludes 0, so it is set in bold. long: may be broken."""

    words: str
    is_text: bool = False
    apart: bool = False
    long: bool = False


def write_page(path: Path, title: str, lead: str, body: Iterable[str]) -> None:
    """Write a page. lead: text. body: HTML of the functions below. Raises InputError."""
    page = f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{text(title)}</title><style>{_CSS}</style></head><body>
<h1>{text(title)}</h1><p class="lead">{text(lead)}</p>
{"".join(body)}
</body></html>
"""
    with explained(path, "a folder that can be written"):
        path.write_text(page, encoding="utf-8")


def text(words: str) -> str:
    """Text as HTML shows it, whoever said it."""
    return html.escape(printable(words, _LONGEST))


def heading(words: str) -> str:
    """The title of a section."""
    return f"<h2>{text(words)}</h2>"


def paragraph(words: str) -> str:
    """A paragraph beside a table or figure."""
    return f'<p class="note">{text(words)}</p>'


def definitions(entries: Iterable[tuple[str, str]]) -> str:
    """Each with what it means, or why it is so."""
    return f"<dl>{''.join(f'<dt>{text(word)}</dt><dd>{text(why)}</dd>' for word, why in entries)}</dl>"


def rows(head: Sequence[Cell], lines: Iterable[tuple[str, Sequence[Cell]]]) -> str:
    """A table. lines: the class of a row, "" for none, and its cells."""
    made = [f"<tr>{''.join(_cell(one, 'th') for one in head)}</tr>"]
    for kind, cells in lines:
        name = f' class="{kind}"' if kind else ""
        made.append(f"<tr{name}>{''.join(_cell(one, 'td') for one in cells)}</tr>")
    return f'<div class="scroll"><table>{"".join(made)}</table></div>'


def _cell(one: Cell, tag: str) -> str:
    names = ["text" if one.is_text else "number"]
    names += [name for name, holds in (("line", not one.long), ("apart", one.apart)) if holds]
    return f'<{tag} class="{" ".join(names)}">{text(one.words)}</{tag}>'


def picture(one: Picture) -> str:
    """A figure with what to see in it, held in the page itself."""
    data = base64.b64encode(one.path.read_bytes()).decode()
    title = text(one.title)
    return f'<h3>{title}</h3>{paragraph(one.note)}<img alt="{title}" src="data:image/png;base64,{data}">'


_EXPECTS = {
    Expects.LESS: "below 0",
    Expects.MORE: "above 0",
    Expects.SAME: "within the margin",
    Expects.NONE: "0",
}
"""Where a claim wants the interval."""


def claims(judgements: Iterable[Judgement]) -> str:
    """Each claim, where it is made, what was measured, and the verdict."""
    head = ("claim", "thesis", "measured", "claimed", "seeds", "verdict")
    lines = [f"<tr>{''.join(f'<th class=text>{word}</th>' for word in head)}</tr>"]
    for one in judgements:
        claim, verdict = one.claim, one.verdict
        margin = f" of {claim.margin / claim.scale:g}" if claim.expects is Expects.SAME else ""
        lines.append(
            f'<tr><td class="text">{text(claim.says)}</td><td class="text">{text(claim.source)}</td>'
            f'<td class="number">{text(measured(one))}</td>'
            f'<td class="text">{_EXPECTS[claim.expects]}{margin}</td><td>{one.seeds}</td>'
            f'<td class="text"><span class="chip {verdict.replace(" ", "-")}">{verdict}</span></td></tr>'
        )
    return f'<div class="scroll"><table>{"".join(lines)}</table></div>'


def measured(one: Judgement) -> str:
    """The estimate of a claim, in its unit."""
    return f"{interval(*one.estimate, one.claim.scale)} {one.claim.unit}".rstrip()


def verdicts(judgements: Iterable[Judgement]) -> str:
    """How many claims came to which verdict, in words."""
    found = [one.verdict for one in judgements]
    counted = {verdict: found.count(verdict) for verdict in Verdict}
    return ", ".join(f"{count} {verdict}" for verdict, count in counted.items() if count)
