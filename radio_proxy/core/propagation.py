"""At which SNR each robot receives each other: a model of propagation, cuts and jams (thesis 3.7.1).

The mean SNR of every pair, with the shadowing between their places, is computed sender by sender when
one first transmits in a tick; fast fading comes on top for every emission.
"""

import math

from onehop.contracts import elementary
from onehop.contracts.messages import Cut, Jam, Presence
from radio_proxy.core.addresses import RobotId, StationIndex
from radio_proxy.core.airtime import delay_ns
from radio_proxy.core.fast_fading import FastFading
from radio_proxy.core.link_budget import LinkBudget
from radio_proxy.core.measured_links import MeasuredLinks
from radio_proxy.core.path_loss import OWN_DB, SILENT_DB, LogDistance, PropagationModel, Wall, held
from radio_proxy.core.shadowing import Shadowing


class Propagation:
    """Who is where in this tick, and at which mean SNR each receives each. robots: sorted ids.

    stations: theirs, all of them. noise_rise_db: noise at every station above the floor, by jams [dB].
    fast_fading, measured: None where there is none. model: by default the built-in one, with these walls
    and this shadowing.
    """

    def __init__(
        self,
        budget: LinkBudget,
        robots: tuple[RobotId, ...],
        walls: tuple[Wall, ...],
        shadowing: Shadowing | None = None,
        fast_fading: FastFading | None = None,
        measured: MeasuredLinks | None = None,
        model: PropagationModel | None = None,
    ) -> None:
        self.budget = budget
        self._model = LogDistance(budget, walls, shadowing) if model is None else model
        self._fast_fading = fast_fading
        self._measured = measured
        self.stations = tuple([StationIndex(i) for i in range(len(robots))])
        self._robots = robots
        self._index: dict[int, StationIndex] = dict(zip(robots, self.stations, strict=True))
        self._positions: dict[StationIndex, tuple[float, float]] = {}
        self._rows: dict[StationIndex, list[float]] = {}
        self._sensed_by_all: dict[StationIndex, bool] = {}
        self._delays: dict[tuple[StationIndex, StationIndex], int] = {}
        self._farthest: dict[StationIndex, float] = {}
        self._cuts: tuple[Cut, ...] = ()
        self.noise_rise_db: list[float] = [0.0] * len(robots)
        self._jams: tuple[Jam, ...] = ()
        self._present: tuple[Presence, ...] = ()
        self._before: tuple[Presence, ...] = ()
        self._tick = 0, 0
        self._stale = True

    def update(
        self,
        present: tuple[Presence, ...],
        cuts: tuple[Cut, ...],
        jams: tuple[Jam, ...],
        tick: tuple[int, int] = (0, 0),
    ) -> None:
        """Take over the poses and faults of a tick; nothing is computed until somebody transmits.

        What was computed holds while all of them stay, unless fast fading asks for the way of a tick, or
        measured links for its time.
        tick: when it begins and ends [ns]; robots are at these poses at its end.
        """
        changing = self._fast_fading is not None or self._measured is not None
        if changing or ((present, cuts, jams) != (self._present, self._cuts, self._jams)):
            self._stale = True
        self._before, self._present = self._present, present
        self._tick = tick
        self._cuts = cuts
        self._jams = jams

    def mean_snr_row(self, sender: StationIndex) -> list[float]:
        """Mean SNR at every station of what `sender` emits in this tick [dB]."""
        if self._stale:
            self._place_robots()
        row = self._rows.get(sender)
        if row is None:
            row = self._rows[sender] = self._compute_row(sender)
        return row

    def snr_row(self, sender: StationIndex, now: int) -> list[float]:
        """SNR at every station of what `sender` begins to emit now [dB]."""
        row = None if self._stale else self._rows.get(sender)
        if row is None:
            row = self.mean_snr_row(sender)
        if self._fast_fading is None:
            return row
        gains = self._fast_fading.row_db(sender, now)
        return [
            mean + gain if SILENT_DB < mean < OWN_DB else mean
            for mean, gain in zip(row, gains, strict=True)
        ]

    def noise_rise(self, station: StationIndex) -> float:
        """Noise at a station above the floor in this tick, though nobody has transmitted yet [dB]."""
        if self._stale:
            self._place_robots()
        return self.noise_rise_db[station]

    def delay_ns(self, a: StationIndex, b: StationIndex) -> int:
        """Propagation delay between two stations in this tick."""
        delay = None if self._stale else self._delays.get((a, b))
        if delay is None:
            delay = delay_ns(self.distance(a, b))
            self._delays[a, b] = self._delays[b, a] = delay
        return delay

    def distance(self, a: StationIndex, b: StationIndex) -> float:
        """Distance between two stations [m]; 0 when one of them is absent."""
        if self._stale:
            self._place_robots()
        here, there = self._positions.get(a), self._positions.get(b)
        if here is None or there is None:
            return 0.0
        return math.hypot(here[0] - there[0], here[1] - there[1])

    def is_sensed_by_all(self, sender: StationIndex) -> bool:
        """Whether every present robot is sure to sense what `sender` emits (not under fast fading)."""
        if self._stale:
            self._place_robots()
        sensed = self._sensed_by_all.get(sender)
        if sensed is None:
            sensed = False
            if self._fast_fading is None and sender in self._positions:
                row, least = self.mean_snr_row(sender), self.budget.carrier_sense_db
                sensed = min([row[i] for i in self._positions]) >= least
            self._sensed_by_all[sender] = sensed
        return sensed

    def farthest(self, sender: StationIndex) -> float:
        """Distance from `sender` to the farthest robot that it reaches [m]."""
        farthest = self._farthest.get(sender)
        if self._stale or farthest is None:
            row = self.mean_snr_row(sender)
            x, y = self._positions[sender]
            farthest = max(
                math.hypot(there_x - x, there_y - y)
                for i, (there_x, there_y) in self._positions.items()
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
        self._positions = {}
        for presence in self._present:
            self._positions[self._index[presence.robot]] = presence.pose.x, presence.pose.y
        self._model.place([self._positions.get(station) for station in self.stations])
        if self._fast_fading is not None:
            before = {self._index[p.robot]: (p.pose.x, p.pose.y) for p in self._before}
            self._fast_fading.move(self._places(before), self._places({}), *self._tick)
        if self._jams or any(self.noise_rise_db):
            self.noise_rise_db = [self._noise_rise(station) for station in self.stations]

    def _places(self, other: dict[StationIndex, tuple[float, float]]) -> list[tuple[float, float]]:
        """Where the stations are, or elsewhere; the origin for the absent."""
        found = {**self._positions, **other}
        return [found.get(station, (0.0, 0.0)) for station in self.stations]

    def _noise_rise(self, index: StationIndex) -> float:
        position = self._positions.get(index)
        if position is None:
            return 0.0
        total = 1.0
        for jam in self._jams:
            if math.hypot(position[0] - jam.x, position[1] - jam.y) <= jam.radius:
                total += elementary.power_of_ten((jam.noise_dbm - self.budget.noise_dbm) / 10.0)
        return 10.0 * elementary.log10(total)

    def _compute_row(self, sender: StationIndex) -> list[float]:
        """What everybody receives of a sender: as it was measured, or as the model says."""
        if self._measured is None:
            row = self._model.row_db(sender)
        elif self._measured.is_all:
            row = [SILENT_DB] * len(self.stations)
            for robot, snr_db in self._measured.snr_db(self._robots[sender], self._tick[1]).items():
                other = self._index[robot]
                if snr_db is not None and other in self._positions:
                    row[other] = held(snr_db)
        else:
            row = self._model.row_db(sender)
            for robot, loss_db in self._measured.loss_db(self._robots[sender], self._tick[1]).items():
                other = self._index[robot]
                if row[other] > SILENT_DB:
                    row[other] = SILENT_DB if loss_db is None else held(row[other] - loss_db)
        row[sender] = OWN_DB
        self._apply_cuts(sender, row)
        return row

    def _apply_cuts(self, sender: StationIndex, row: list[float]) -> None:
        for cut in self._cuts:
            for near, far in ((cut.side_a, cut.side_b), (cut.side_b, cut.side_a))[: 2 - cut.one_way]:
                if sender in (self._index.get(robot) for robot in near):
                    for robot in far:
                        index = self._index.get(robot, sender)
                        if index != sender:
                            row[index] = SILENT_DB
