"""The report: a page that opens alone and says what happened."""

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from onehop.analysis import Log, open_log
from onehop.analysis.report.election_rows import elections
from onehop.analysis.report.follower_chart import (
    BER_FLOOR,
    follower_chart,
    modulation_bit_errors,
    thesis_bit_errors,
)
from onehop.analysis.report.narrative import narrative, summary_sentence
from onehop.analysis.report.page import write_report
from onehop.analysis.report.report_data import gather
from robot_agent.core.team.team_messages import Command

from .conftest import HELD, KILLED_S, LEADER, SUCCESSOR
from .test_difference import altered, rewritten

VOID = {"meta", "img", "br"}


class Balance(HTMLParser):
    """Every element that is opened is closed, in order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:  # noqa: ARG002
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def folder(log: Log, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    write_report(log, folder)
    return folder


@pytest.mark.slow
def test_the_page_needs_nothing_but_itself(folder: Path) -> None:
    page = (folder / "report.html").read_text()
    sources = re.findall(r'(?:src|href)="([^"]{0,40})', page)
    assert sources
    assert all(source.startswith("data:image/png;base64,") for source in sources)
    assert "http://" not in page
    assert "https://" not in page
    assert "@import" not in page


@pytest.mark.slow
def test_the_page_is_well_formed(folder: Path) -> None:
    balance = Balance()
    balance.feed((folder / "report.html").read_text())
    balance.close()
    assert balance.open == []


@pytest.mark.slow
def test_the_dead_robot_is_struck_through_and_no_other(folder: Path) -> None:
    page = (folder / "report.html").read_text()
    assert re.findall(r"<s>([^<]*)</s>", page) == [f"robot {LEADER}"]


@pytest.mark.slow
@pytest.mark.parametrize("stem", ["timeline", "trajectory", "followers", "radio", "election-1"])
def test_every_figure_is_there_as_png_and_svg(folder: Path, stem: str) -> None:
    with Image.open(folder / f"{stem}.png") as figure:
        width, height = figure.size
    assert width > 900
    assert height > 150
    assert "<svg" in (folder / f"{stem}.svg").read_text()[:1000]


def test_the_narrative_has_death_election_and_fault_in_order(log: Log) -> None:
    events = narrative(gather(log))
    texts = [event.text for event in events]
    assert [event.at_s for event in events] == sorted(event.at_s for event in events)
    death = next(n for n, text in enumerate(texts) if f"Robot {LEADER}, the leader, leaves" in text)
    election = next(n for n, text in enumerate(texts) if f"robot {SUCCESSOR}, median of 1, 3, 4" in text)
    fault = next(n for n, text in enumerate(texts) if f"Fault: hold {HELD}" in text)
    assert fault < death < election
    assert events[death].at_s == pytest.approx(KILLED_S, abs=0.11)


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (
            {"robots": [1], "reason": "unanswered"},
            "Leader 3 gives up robot 1: its commands stayed unanswered.",
        ),
        (
            {"robots": [1, 4], "reason": "not in position at setup"},
            "Leader 3 gives up robots 1, 4: not in position when setup ended.",
        ),
        ({"robots": [1]}, "Leader 3 gives up robot 1."),
    ],
)
def test_the_narrative_has_a_sentence_for_each_cause_of_a_loss(
    log_path: Path, tmp_path: Path, data: dict[str, object], sentence: str
) -> None:
    def note(tick: int, key: str, content: bytes) -> bytes:
        lost = {"kind": "lost_follower", "data": data}
        if (tick, key) != (100, "out/3"):
            return content
        return altered(content, lambda fields: fields.update(notes=[lost]))

    noted = rewritten(log_path, tmp_path / "noted.mcap", note)
    assert [event.text for event in narrative(gather(noted)) if "gives up" in event.text] == [sentence]


def test_the_bit_error_rates_of_a_next_are_the_thesiss_and_the_modulations(log: Log) -> None:
    """Eq. 3.24, 3.25 with the 6400 bits of 800 B; the modulation makes no error above 20 dB."""
    report = gather(log)
    commands = [
        (trace.arrival_s, trace.snr_db)
        for trace in report.traces
        if trace.receiver == 4 and isinstance(trace.message, Command)
    ]
    snr_db = np.array([value for _, value in sorted(commands)])
    expected = np.maximum(0.5 * np.exp(-(10.0 ** (snr_db / 10.0)) / 6400.0), BER_FLOOR)
    thesis, own = thesis_bit_errors(report, 4)[1], modulation_bit_errors(report, 4)[1]
    assert thesis[np.isfinite(thesis)] == pytest.approx(expected, rel=1e-12)
    assert np.ptp(expected) > 0.0
    assert set(own[np.isfinite(own)].tolist()) == {BER_FLOOR}


def test_the_panel_of_bit_error_rates_says_which_decides_loss(log: Log) -> None:
    (panel,) = (axes for axes in follower_chart(gather(log)).axes if "BER" in axes.get_ylabel())
    legend = panel.get_legend()
    assert legend is not None
    thesis, own = (text.get_text() for text in legend.get_texts())
    assert "eq. 3.25" in thesis
    assert "only drawn" in thesis
    assert "decides loss" in own
    drawn = [line for line in panel.get_lines() if len(line.get_xdata()) > 2]
    assert any(np.nanmax(np.asarray(line.get_ydata(), dtype=float)) > 1e-3 for line in drawn)


def test_a_leader_that_hands_over_to_the_median_of_a_new_roster_is_named(log: Log) -> None:
    """Not for an election: that sentence names the new leader already."""
    report = gather(log)
    assert not [event for event in narrative(report) if "leads from now on" in event.text]
    notes = report.tables["notes"]
    quiet = {**report.tables, "notes": notes.where(notes["kind"] != "lost_leader")}
    texts = [event.text for event in narrative(replace(report, tables=quiet))]
    assert f"Robot {SUCCESSOR}, median of 1, 3, 4, leads from now on; shape: wedge." in texts


def test_one_sentence_says_the_outcome_and_who_led(log: Log) -> None:
    sentence = summary_sentence(gather(log))
    assert "reached the goal" in sentence
    assert f"robot {LEADER} was lost" in sentence
    assert f"from robot {LEADER} to {SUCCESSOR}" in sentence


def test_a_change_of_shape_is_no_election(log: Log) -> None:
    assert [(a.leader, b.leader) for a, b in elections(gather(log))] == [(LEADER, SUCCESSOR)]


def test_a_log_without_an_end_is_told_as_such(log_path: Path, tmp_path: Path) -> None:
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(log_path.read_bytes()[: log_path.stat().st_size // 2])
    assert "before the mission did" in summary_sentence(gather(open_log(torn)))
