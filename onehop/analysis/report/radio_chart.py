"""What became of the messages, and what the radio spent on routing."""

from collections import Counter

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from onehop.analysis.palette import FAINT, INK, OKABE_ITO
from onehop.analysis.report.report_data import ReportData
from onehop.contracts.messages import DeliveryStatus

COLOURS = {
    DeliveryStatus.CORRUPTED: "#F0A0C8",
    DeliveryStatus.BELOW_THRESHOLD: "#D55E00",
    DeliveryStatus.BIT_ERRORS: "#E69F00",
    DeliveryStatus.COLLISION: "#CC79A7",
    DeliveryStatus.RECEIVER_BUSY: "#009E73",
    DeliveryStatus.NO_ROUTE: "#56B4E9",
    DeliveryStatus.QUEUE_FULL: "#B8A800",
    DeliveryStatus.EXPIRED: "#8B5E3C",
    DeliveryStatus.RECEIVER_GONE: "#5B5B5B",
    DeliveryStatus.RELAY_GONE: "#0072B2",
    DeliveryStatus.SENDER_GONE: "#A5A5A5",
}
"""Colour of each reason for which a message is lost."""


def radio_chart(report: ReportData) -> Figure:
    """Two panels: losses by delivery status and receiver; bytes offered over time by kind."""
    figure = Figure(figsize=(10.0, 3.1))
    left, right = figure.subplots(1, 2)
    figure.subplots_adjust(left=0.07, right=0.98, top=0.86, bottom=0.15, wspace=0.22)
    _draw_losses(left, report)
    _draw_bytes(right, report)
    return figure


def losses(report: ReportData) -> dict[int, Counter[str]]:
    """Lost messages by receiver and delivery status."""
    found: dict[int, Counter[str]] = {robot: Counter() for robot in report.robots}
    for trace in report.traces:
        if not trace.delivered and trace.receiver in found:
            found[trace.receiver][trace.status] += 1
    return found


def _draw_losses(axes: Axes, report: ReportData) -> None:
    found = losses(report)
    names = [str(robot) for robot in report.robots]
    base = np.zeros(len(names))
    for status, colour in COLOURS.items():
        counts = np.array([found[robot][status] for robot in report.robots])
        if counts.any():
            axes.bar(names, counts, bottom=base, color=colour, width=0.6, label=status.value)
            base += counts
    received = Counter(trace.receiver for trace in report.traces)
    for place, robot in enumerate(report.robots):
        total = received[robot]
        axes.annotate(
            f"{base[place]:.0f} of {total}", (place, base[place]), ha="center", xytext=(0, 2),
            textcoords="offset points", fontsize=8, color=INK,
        )  # fmt: skip
    axes.set_ylim(0, max(1.0, 1.18 * base.max()))
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("receiver")
    axes.set_ylabel("messages lost")
    axes.grid(axis="x", visible=False)
    if base.any():
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(-0.03, 1.0),
            ncols=5,
            frameon=False,
            fontsize=8,
            columnspacing=1.0,
            handlelength=1.2,
        )
    else:
        axes.set_title("no message was lost", loc="left", fontsize=9)


def _draw_bytes(axes: Axes, report: ReportData) -> None:
    """Cumulative bytes: the team's own messages, and each kind of routing message."""
    verdicts, control = report.tables["verdicts"], report.tables["control"]
    first = _first_of_each(verdicts["source"], verdicts["message"])
    order = np.sort(first)
    times = np.append(verdicts["time_s"][order], report.end_s)
    total = np.cumsum(verdicts["msdu_bytes"][order]) / 1e3
    axes.step(
        times,
        np.append(total, total[-1:] if len(total) else 0.0),
        where="post",
        color=INK,
        label="team's messages",
    )
    for number, kind in enumerate(np.unique(control["kind"]).tolist()):
        own = control.where(control["kind"] == kind)
        axes.plot(
            own["time_s"], own["bytes"] / 1e3, color=OKABE_ITO[number % len(OKABE_ITO)],
            label=f"routing: {kind}",
        )  # fmt: skip
    routing = report.log.scenario.radio.routing
    if not len(control):
        axes.annotate(
            f"routing {routing!r} sends nothing of its own", (0.5, 0.05), xycoords="axes fraction",
            ha="center", fontsize=8, color=FAINT,
        )  # fmt: skip
    axes.set_xlim(0.0, max(report.end_s, report.period_s))
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("offered since the start [kB]")
    axes.legend(
        loc="lower left",
        bbox_to_anchor=(-0.03, 1.0),
        ncols=5,
        frameon=False,
        fontsize=8,
        columnspacing=1.0,
        handlelength=1.2,
    )


def _first_of_each(source: np.ndarray, message: np.ndarray) -> np.ndarray:
    """Rows of the first verdict of each message; a broadcast has one verdict for each receiver."""
    _, rows = np.unique(np.column_stack((source, message)), axis=0, return_index=True)
    return np.asarray(rows)
