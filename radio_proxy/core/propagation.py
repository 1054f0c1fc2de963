"""How strongly each robot hears each other: path loss, walls, cuts and jams (thesis 3.7.1).

Pr(d) = Pt Gt Gr lambda^2 / ((4 pi d0)^2 L) * (d0/d)^n * 10^(X/10), X ~ N(0, sigma) dB. What is kept is
the mean SNR above the noise floor, sender by sender, computed when a sender first speaks in a tick;
the fading X is drawn by the medium.
"""

import math
from dataclasses import dataclass, replace

from onehop.contracts import elementary
from onehop.contracts.messages import Cut, Jam, Presence
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.airtime import delay_ns

WAVE_SPEED = 3.0e8
"""Rounded as in the sums that the thesis's and ns-3's path losses come from [m/s]."""

SILENT_DB = -200.0
"""SNR of what cannot be heard at all: cut off, absent, or out of reach [dB]."""

OWN_DB = 200.0
"""A station's own emission drowns everything else in its receiver [dB]."""

REACH_DB = -10.0
"""Weaker than this, a signal neither is heard nor disturbs (0.4 dB of noise rise): it is left out."""

THERMAL_NOISE_DBM = -100.55
"""kTB of a 22 MHz channel at 290 K [dBm]."""


@dataclass(frozen=True, slots=True)
class LinkBudget:
    """Propagation in force. snr_reference_db: mean SNR at the reference distance d0 [m]."""

    snr_reference_db: float
    reference_distance: float
    exponent: float
    noise_dbm: float
    shadowing_db: float
    receive_threshold_db: float
    carrier_sense_db: float
    wall_loss_db: float

    def mean_snr_db(self, distance: float) -> float:
        """Mean SNR without walls at a distance [m]; nearer than d0 counts as d0."""
        ratio = max(distance / self.reference_distance, 1.0)
        return self.snr_reference_db - 10.0 * self.exponent * elementary.log10(ratio)

    def without_fading(self) -> "LinkBudget":
        """The same budget with every frame at its mean SNR."""
        return replace(self, shadowing_db=0.0)

    @property
    def reach(self) -> float:
        """Distance beyond which nothing is heard and nothing disturbed [m]."""
        margin = self.snr_reference_db - REACH_DB
        return self.reference_distance * elementary.power_of_ten(
            max(0.0, margin / (10.0 * self.exponent))
        )


def free_space_loss_db(distance: float, frequency_hz: float) -> float:
    """Friis loss at a distance [m] (40.046 dB at 1 m, 2.4 GHz)."""
    return 20.0 * elementary.log10(4.0 * math.pi * distance * frequency_hz / WAVE_SPEED)


_PRESETS: dict[str, dict[str, float]] = {
    # 0.2 W; the floor that gives the SNR of 60 dB at 1 m of the thesis's figures.
    "thesis": {
        "tx_power_dbm": 10.0 * elementary.log10(200.0),
        "path_loss_exponent": 2.0,
        "noise_dbm": 10.0 * elementary.log10(200.0) - free_space_loss_db(1.0, 2.4e9) - 60.0,
    },
    # 15 dBm and a noise figure of 7 dB: what a laptop card of 802.11b has.
    "physical": {
        "tx_power_dbm": 15.0,
        "path_loss_exponent": 2.6,
        "noise_dbm": THERMAL_NOISE_DBM + 7.0,
    },
}
_EITHER_PRESET = {"shadowing_db": 4.0, "receive_threshold_db": 32.0, "carrier_sense_db": 10.0}
"""Fading and threshold of the thesis's simulation; carrier sense as a DSSS receiver locks on."""


def link_budget(section: RadioSection) -> LinkBudget:
    """The propagation of a scenario: its preset, with whatever the scenario sets itself."""

    def value(key: str) -> float:
        given: float | None = getattr(section, key)
        return {**_PRESETS[section.preset], **_EITHER_PRESET}[key] if given is None else given

    received_dbm = (
        value("tx_power_dbm")
        + 2.0 * section.antenna_gain_dbi
        - section.system_loss_db
        - free_space_loss_db(section.reference_distance, section.frequency_hz)
    )
    return LinkBudget(
        snr_reference_db=received_dbm - value("noise_dbm"),
        reference_distance=section.reference_distance,
        exponent=value("path_loss_exponent"),
        noise_dbm=value("noise_dbm"),
        shadowing_db=value("shadowing_db"),
        receive_threshold_db=value("receive_threshold_db"),
        carrier_sense_db=value("carrier_sense_db"),
        wall_loss_db=section.wall_loss_db,
    )


Wall = tuple[float, float, float, float]


def walls_crossed(walls: tuple[Wall, ...], x0: float, y0: float, x1: float, y1: float) -> int:
    """How many wall segments the straight path between two points crosses, whichever way it is taken."""
    if (x0, y0) > (x1, y1):
        x0, y0, x1, y1 = x1, y1, x0, y0
    count = 0
    for ax, ay, bx, by in walls:
        side_a = (x1 - x0) * (ay - y0) - (y1 - y0) * (ax - x0)
        side_b = (x1 - x0) * (by - y0) - (y1 - y0) * (bx - x0)
        if (side_a > 0.0) == (side_b > 0.0):
            continue
        side_0 = (bx - ax) * (y0 - ay) - (by - ay) * (x0 - ax)
        side_1 = (bx - ax) * (y1 - ay) - (by - ay) * (x1 - ax)
        count += (side_0 > 0.0) != (side_1 > 0.0)
    return count


class Field:
    """Who is where in this tick, and what each hears of each. Robots by index in the sorted mission."""

    def __init__(self, budget: LinkBudget, robots: tuple[int, ...], walls: tuple[Wall, ...]) -> None:
        self.budget = budget
        self._index = {robot: i for i, robot in enumerate(robots)}
        self._count = len(robots)
        self._walls = walls if budget.wall_loss_db else ()
        self._place: dict[int, tuple[float, float]] = {}
        self._rows: dict[int, list[float]] = {}
        self._sensed_by_all: dict[int, bool] = {}
        self._delays: dict[tuple[int, int], int] = {}
        self._farthest: dict[int, float] = {}
        self._cells: dict[tuple[int, int], list[tuple[int, float, float]]] = {}
        self._cuts: tuple[Cut, ...] = ()
        self.noise_rise_db: list[float] = [0.0] * self._count
        self._jams: tuple[Jam, ...] = ()
        self._present: tuple[Presence, ...] = ()
        self._stale = True

    def update(
        self, present: tuple[Presence, ...], cuts: tuple[Cut, ...], jams: tuple[Jam, ...]
    ) -> None:
        """Take over the poses and faults of a tick; nothing is computed until somebody speaks."""
        self._present = present
        self._cuts = cuts
        self._jams = jams
        self._stale = True

    def row(self, sender: int) -> list[float]:
        """Mean SNR [dB] at every robot of what `sender` emits in this tick, cuts and walls included."""
        if self._stale:
            self._place_robots()
        row = self._rows.get(sender)
        if row is None:
            row = self._rows[sender] = self._hear(sender)
        return row

    def delay_ns(self, a: int, b: int) -> int:
        """Propagation delay between two robots in this tick."""
        delay = self._delays.get((a, b))
        if self._stale or delay is None:
            delay = self._delays[a, b] = delay_ns(self.distance(a, b))
        return delay

    def distance(self, a: int, b: int) -> float:
        """Distance between two robots [m]; 0 when one of them is absent."""
        if self._stale:
            self._place_robots()
        here, there = self._place.get(a), self._place.get(b)
        if here is None or there is None:
            return 0.0
        return math.hypot(here[0] - there[0], here[1] - there[1])

    def is_sensed_by_all(self, sender: int) -> bool:
        """Whether every present robot senses what `sender` emits."""
        if self._stale:
            self._place_robots()
        sensed = self._sensed_by_all.get(sender)
        if sensed is None:
            sensed = False
            if sender in self._place:
                row, least = self.row(sender), self.budget.carrier_sense_db
                sensed = all(row[i] >= least for i in self._place)
            self._sensed_by_all[sender] = sensed
        return sensed

    def farthest(self, sender: int) -> float:
        """Distance from `sender` to the farthest robot that hears it [m]."""
        farthest = self._farthest.get(sender)
        if self._stale or farthest is None:
            row = self.row(sender)
            x, y = self._place[sender]
            farthest = max(
                math.hypot(there_x - x, there_y - y)
                for i, (there_x, there_y) in self._place.items()
                if row[i] > SILENT_DB
            )
            self._farthest[sender] = farthest
        return farthest

    def _place_robots(self) -> None:
        self._stale = False
        self._rows = {}
        self._sensed_by_all = {}
        self._delays = {}
        self._farthest = {}
        self._cells = {}
        self._place = {}
        reach = self.budget.reach
        for presence in self._present:
            index = self._index[presence.robot]
            x, y = presence.pose.x, presence.pose.y
            self._place[index] = (x, y)
            cell = math.floor(x / reach), math.floor(y / reach)
            self._cells.setdefault(cell, []).append((index, x, y))
        if self._jams or any(self.noise_rise_db):
            self.noise_rise_db = [self._noise_rise(i) for i in range(self._count)]

    def _noise_rise(self, index: int) -> float:
        place = self._place.get(index)
        if place is None:
            return 0.0
        total = 1.0
        for jam in self._jams:
            if math.hypot(place[0] - jam.x, place[1] - jam.y) <= jam.radius:
                total += elementary.power_of_ten((jam.noise_dbm - self.budget.noise_dbm) / 10.0)
        return 10.0 * elementary.log10(total)

    def _hear(self, sender: int) -> list[float]:
        """The row of a sender; the path loss of mean_snr_db, by squared distances, for all in reach."""
        row = [SILENT_DB] * self._count
        budget = self.budget
        reach, nearest = budget.reach, budget.reference_distance * budget.reference_distance
        reference_db, slope_db = budget.snr_reference_db, 5.0 * budget.exponent
        x, y = self._place[sender]
        column, line = math.floor(x / reach), math.floor(y / reach)
        for near in ((column + dx, line + dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1)):
            for other, there_x, there_y in self._cells.get(near, ()):
                east, north = there_x - x, there_y - y
                square = east * east + north * north
                if square <= nearest:
                    row[other] = reference_db
                elif square <= reach * reach:
                    row[other] = reference_db - slope_db * elementary.log10(square / nearest)
                else:
                    continue
                if self._walls:
                    crossed = walls_crossed(self._walls, x, y, there_x, there_y)
                    row[other] -= crossed * budget.wall_loss_db
        row[sender] = OWN_DB
        self._apply_cuts(sender, row)
        return row

    def _apply_cuts(self, sender: int, row: list[float]) -> None:
        for cut in self._cuts:
            for near, far in ((cut.side_a, cut.side_b), (cut.side_b, cut.side_a)):
                if sender in (self._index.get(robot) for robot in near):
                    for robot in far:
                        index = self._index.get(robot, sender)
                        if index != sender:
                            row[index] = SILENT_DB
