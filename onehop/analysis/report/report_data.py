"""Everything that the report draws from."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from onehop.analysis.log import Log
from onehop.analysis.message_traces import MessageTrace, join
from onehop.analysis.palette import robot_colours
from onehop.analysis.tables import Table
from onehop.analysis.timeline import (
    LastSeen,
    Span,
    begun_faults,
    departures,
    fault_spans,
    leadership,
)
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.messages import LeadershipTerm
from onehop.contracts.scenario import Scenario
from onehop.wire.audit import audit

_TABLES = (
    "poses", "status", "values", "notes", "verdicts", "transmit_requests", "control", "contacts",
    "departures", "cuts", "jams", "corruptions", "impaired", "faults",
)  # fmt: skip


@dataclass(frozen=True)
class ReportData:
    """One mission, taken apart.

    gone: everyone who left. terms: every leadership term. main_terms: of those, who led most of the
    team. faults: those that lasted. begun: all faults, as they began. end_s: time of the last tick in
    the log [s]. flaws: why the log is not all that was said.
    """

    log: Log
    tables: dict[str, Table]
    colours: dict[int, str]
    gone: list[LastSeen]
    terms: list[LeadershipTerm]
    main_terms: list[LeadershipTerm]
    faults: list[Span]
    begun: list[FaultSection]
    traces: list[MessageTrace]
    period_s: float
    end_s: float
    flaws: list[str]

    @property
    def robots(self) -> tuple[int, ...]:
        return self.log.robots

    @property
    def scenario(self) -> Scenario:
        return self.log.scenario

    @property
    def summary(self) -> dict[str, Any] | None:
        return self.log.summary

    @property
    def noted(self) -> Iterator[tuple[Any, ...]]:
        """Time [s], robot, kind and data of each note."""
        return self.tables["notes"].rows("time_s", "robot", "kind", "data")

    @property
    def touched(self) -> Iterator[tuple[Any, ...]]:
        """Time [s], robot, and the other robot or 0, of each contact."""
        return self.tables["contacts"].rows("time_s", "robot", "other")

    @property
    def dead(self) -> dict[int, LastSeen]:
        """Those who left and never came back."""
        poses = self.tables["poses"]
        last = poses["robot"][poses["time_s"] > self.end_s - 1.5 * self.period_s]
        present = set(last.tolist())
        return {one.robot: one for one in self.gone if one.robot not in present}


def gather(log: Log) -> ReportData:
    """Read a log, once for its tables and once to hold it against its digest.

    Raises LogError when it is damaged.
    """
    tables = log.tables(*_TABLES)
    period_s = log.period_ns / 1e9
    poses = tables["poses"]
    led = leadership(tables["status"], tables["departures"], log.period_ns)
    return ReportData(
        log=log,
        tables=tables,
        colours=robot_colours(log.robots),
        gone=departures(poses, tables["departures"]),
        terms=led.terms,
        main_terms=led.main,
        faults=fault_spans(tables, period_s),
        begun=begun_faults(tables["faults"]),
        traces=list(join(tables["verdicts"], tables["transmit_requests"], log.period_ns)),
        period_s=period_s,
        end_s=float(poses["time_s"][-1]) if len(poses) else 0.0,
        flaws=audit(log.file),
    )
