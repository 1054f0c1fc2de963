"""What programs show of themselves: one panel a name, one line a robot."""

import numpy as np
from matplotlib.figure import Figure

from onehop.analysis.report.canvas import mark_turns
from onehop.analysis.report.report_data import ReportData
from onehop.contracts.printable import printable

MOST_PANELS = 12
"""Names that have a panel, in the order of the alphabet."""

_STEPS = 2000
"""Points of a line at most: more are not seen."""


def values_chart(report: ReportData) -> Figure:
    """One panel for each name; there is at least one."""
    values = report.tables["values"]
    names = np.unique(values["name"]).tolist()[:MOST_PANELS]
    figure = Figure(figsize=(10.0, 0.8 + 1.6 * len(names)))
    all_axes = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    figure.subplots_adjust(left=0.085, right=0.98, top=1.0 - 0.35 / figure.get_figheight())
    for number, (axes, name) in enumerate(zip(all_axes, names, strict=True)):
        axes.set_ylabel(printable(name, 32))
        mark_turns(axes, report, named=number == 0)
        said = values.where(values["name"] == name)
        for robot in report.robots:
            own = said.of(robot)
            own = own.where(np.arange(0, len(own), 1 + len(own) // _STEPS))
            axes.plot(
                own["time_s"], own["value"], color=report.colours[robot], linewidth=1.2,
                label=f"robot {robot}",
            )  # fmt: skip
    all_axes[-1].set_xlabel("time [s]")
    all_axes[-1].set_xlim(0.0, max(report.end_s, report.period_s))
    return figure
