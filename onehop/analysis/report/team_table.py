"""The team in a table: what became of each robot, and its means over the mission."""

import html

import numpy as np

from onehop.analysis.report.radio_chart import losses
from onehop.analysis.report.report_data import ReportData
from onehop.contracts.printable import printable


def team_table(report: ReportData) -> str:
    rows = "".join(_team_row(report, robot) for robot in report.robots)
    heads = "".join(
        f'<th class="{kind}">{name}</th>'
        for kind, name in (
            ("text", "robot"), ("text", "outcome"), ("", "led for"), ("", "drove"), ("", "mean error"),
            ("", "mean throughput"), ("", "below threshold"), ("", "messages to it lost"),
        )
    )  # fmt: skip
    return f"<table><tr>{heads}</tr>{rows}</table>"


def _team_row(report: ReportData, robot: int) -> str:
    own = report.tables["status"].of(robot)
    poses = report.tables["poses"].of(robot)
    dead = robot in report.dead
    following = own.where((own["leader"] != robot) & (own["throughput_bps"] >= 0))
    led_s = np.count_nonzero(own["leader"] == robot) * report.period_s
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
    cells.append(str(sum(losses(report)[robot].values())))
    numbers = "".join(f"<td>{cell}</td>" for cell in cells)
    chip = f'<span class="chip" style="background:{report.colours[robot]}"></span>'
    label = f"<s>robot {name}</s>" if dead else f"robot {name}"
    outcome = html.escape(printable(_outcome(report, robot)))
    return (
        f'<tr class="{"dead" if dead else ""}"><td class="text name">{chip}{label}</td>'
        f'<td class="text">{outcome}</td>{numbers}</tr>'
    )


def _outcome(report: ReportData, robot: int) -> str:
    summary = report.log.summary
    if summary is not None:
        if robot in summary["arrived"]:
            return "arrived"
        for one in summary["lost"]:
            if one["robot"] == robot:
                at = "" if one["why"] == "did not arrive" else f" at {one['at_s']:.0f} s"
                return f"{one['why']}{at}"
    dead = report.dead.get(robot)
    return f"{dead.why} at {dead.at_s:.0f} s" if dead else "on its way when the log ends"
