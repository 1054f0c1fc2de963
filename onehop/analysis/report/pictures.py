"""The figures of a report, each with a title and what to see in it; written as PNG and SVG."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from onehop.analysis.report.canvas import save, styled
from onehop.analysis.report.election_rows import elections
from onehop.analysis.report.follower_chart import follower_chart
from onehop.analysis.report.mode_chart import mode_chart
from onehop.analysis.report.radio_chart import radio_chart
from onehop.analysis.report.report_data import ReportData
from onehop.analysis.report.sequence_chart import MAX_CHARTS, sequence_chart
from onehop.analysis.report.values_chart import values_chart
from onehop.analysis.trajectory import figure_of


@dataclass(frozen=True, slots=True)
class Picture:
    """One figure. path: its PNG; the SVG has the same stem."""

    title: str
    note: str
    path: Path


def draw_pictures(report: ReportData, folder: Path) -> list[Picture]:
    """Write every figure into a folder, in the order of the page."""
    with styled():
        return list(_pictures(report, folder))


def _pictures(report: ReportData, folder: Path) -> Iterator[Picture]:
    yield Picture(
        "Who did what when",
        "The upper rows say who led, in which shape, and which faults were in force. Below, every "
        "robot in its own colour: the deeper, the more it had to do by itself.",
        save(mode_chart(report), folder, "timeline"),
    )
    yield Picture(
        "Where",
        "Paths from ground truth. Every 20 s the formation is drawn; a thin line joins each follower "
        "to the leader that it obeys.",
        save(figure_of(report.log, report.tables), folder, "trajectory"),
    )
    for number, (before, after) in enumerate(elections(report)[:MAX_CHARTS], start=1):
        yield Picture(
            f"How robot {after.leader} came to lead at {after.at_s:.1f} s",
            "Time runs downwards, one line a robot; an arrow is a message in its sender's colour, a "
            "broken red one a message that was lost. Nobody votes: the same list of ids gives everyone "
            "the same leader.",
            save(sequence_chart(report, before, after), folder, f"election-{number}"),
        )
    if len(report.tables["values"]):
        yield Picture(
            "What the programs show",
            "Numbers that robots say of themselves, by name, each robot in its own colour.",
            save(values_chart(report), folder, "values"),
        )
    if len(report.tables["status"]):
        yield _followers(report, folder)
    yield Picture(
        "The radio",
        "Left: messages that did not arrive, by receiver and delivery status. Right: what was handed to "
        "the radio, and what routing added.",
        save(radio_chart(report), folder, "radio"),
    )


def _followers(report: ReportData, folder: Path) -> Picture:
    return Picture(
        "Each follower",
        "A robot whose throughput falls below the threshold raises its gain k_rho and hurries, because "
        "it is about to lose its leader. Dashed lines mark robots that left, dotted ones a new leader. "
        "Two bit error rates: the modulation's own, dotted, decides which messages are lost; the "
        "thesis's (eq. 3.25), solid, is only drawn.",
        save(follower_chart(report), folder, "followers"),
    )
