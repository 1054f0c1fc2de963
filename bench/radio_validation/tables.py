"""The results as Markdown tables: each figure of ns-3 and of Onehop, and the ratio that is asked for."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import fmean

from .measures import Ratio, paired_ratio, ratio

TOLERANCE = 0.03
Figures = dict[str, float | None]


@dataclass(frozen=True)
class Row:
    """A case and the figures of its runs on both sides, seed by seed; none where a run ended ns-3."""

    name: str
    theirs: tuple[Figures, ...]
    ours: tuple[Figures, ...]

    @property
    def group(self) -> str:
        return self.name.partition("/")[0]

    @property
    def what(self) -> str:
        return self.name.partition("/")[2]

    def samples(self, figure: str) -> tuple[list[float], list[float]]:
        """One figure of every run that has it: ns-3's, ours."""
        theirs, ours = (
            [value for run in side if (value := run.get(figure)) is not None]
            for side in (self.theirs, self.ours)
        )
        return theirs, ours

    @property
    def died(self) -> int:
        return sum(not run for run in self.theirs)

    def ratio(self, figure: str) -> Ratio | None:
        """Ours by theirs; topology by topology where the seed is the topology."""
        theirs, ours = self.samples(figure)
        if self.group != "random":
            return ratio(ours, theirs)
        both = zip(
            (run.get(figure) for run in self.ours), (run.get(figure) for run in self.theirs), strict=True
        )
        return paired_ratio([(a, b) for a, b in both if a is not None and b is not None])


@dataclass(frozen=True)
class Column:
    """A figure of both sides. spread: shown with its least and greatest value."""

    title: str
    figure: str
    digits: int
    spread: bool = False

    def cell(self, row: Row) -> str:
        return " / ".join(self._side(values) for values in row.samples(self.figure))

    def _side(self, values: list[float]) -> str:
        if not values:
            return "–"
        mean, least, most = (f"{v:.{self.digits}f}" for v in (fmean(values), min(values), max(values)))
        return f"{mean} ({least}…{most})" if self.spread and least != most else mean


DELAYS = (
    Column("p50 ms", "p50_ms", 1),
    Column("p95 ms", "p95_ms", 1),
    Column("p99 ms", "p99_ms", 1),
)
THROUGHPUT = Column("Mb/s", "mbps", 3)
ROUTED = (Column("delivered", "delivered", 3), *DELAYS)
BYTES = (
    Column("routing bytes", "routing_bytes", 0),
    Column("source routes, B", "source_route_bytes", 0),
)


@dataclass(frozen=True)
class Section:
    """A table: the cases of a group, its columns, and of which figure the ratio is shown."""

    group: str
    title: str
    asked: str
    columns: tuple[Column, ...]


RATIO_OF = {"mbps": "Mb/s", "p50_ms": "p50", "delivered": "delivered"}


def _spread(columns: Sequence[Column]) -> tuple[Column, ...]:
    return tuple(Column(c.title, c.figure, c.digits, spread=True) for c in columns)


SECTIONS = (
    Section("link", "One link", "mbps", (THROUGHPUT, *DELAYS)),
    Section("cell", "Saturated cells", "mbps", (THROUGHPUT, *DELAYS)),
    Section("hidden", "Hidden stations", "mbps", (THROUGHPUT, *DELAYS)),
    Section("exposed", "Exposed stations", "mbps", (THROUGHPUT, *DELAYS)),
    Section(
        "chain",
        "Chains (Mb/s: every hop counted)",
        "mbps",
        (THROUGHPUT, Column("end to end Mb/s", "end_to_end_mbps", 3), *DELAYS),
    ),
    Section("reuse", "Spatial reuse", "mbps", (THROUGHPUT, *DELAYS)),
    Section(
        "route",
        "Routing over a chain",
        "p50_ms",
        (*ROUTED, Column("first message, ms", "first_ms", 1), *BYTES),
    ),
    Section(
        "repair",
        "Repair after a relay has left",
        "delivered",
        (*ROUTED, Column("repair, ms", "repair_ms", 0), *BYTES),
    ),
    Section("random", "Ten random topologies", "delivered", _spread((*ROUTED, *BYTES))),
)


def verdict(row: Row, asked: str) -> tuple[str, str]:
    """The ratio with its interval, and what that says about TOLERANCE."""
    theirs, ours = row.samples(asked)
    found = row.ratio(asked)
    if found is None:
        both_nothing = theirs and ours and not any(theirs) and not any(ours)
        return "–", "both 0" if both_nothing else "–"
    text = f"{found.value:.3f} ({found.low:.3f}…{found.high:.3f})"
    if found.within(TOLERANCE):
        return text, "yes"
    apart = found.high < 1.0 - TOLERANCE or found.low > 1.0 + TOLERANCE
    return text, "no" if apart else "not sure"


def markdown(rows: Sequence[Row]) -> Iterator[str]:
    """Lines of all tables that have rows."""
    for section in SECTIONS:
        own = [row for row in rows if row.group == section.group]
        if not own:
            continue
        titles = [column.title for column in section.columns]
        yield from (f"### {section.title}", "", "Each column: ns-3 / Onehop.", "")
        heads = ["case", *titles, f"ratio of {RATIO_OF[section.asked]} (95 %)", "within 3 %"]
        yield f"| {' | '.join(heads)} |"
        yield f"|{'---|' * len(heads)}"
        for row in own:
            cells = [column.cell(row) for column in section.columns]
            died = f" ({row.died} of {len(row.theirs)} runs ended ns-3)" if row.died else ""
            yield f"| {' | '.join([row.what + died, *cells, *verdict(row, section.asked)])} |"
        yield ""
