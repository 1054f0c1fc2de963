"""Who could hear whom, from poses, cuts, jams and what became of messages: path loss worked out anew.

Two running robots, neither of them slow, are **linked** while each receives the other, on the mean, with
its jams and at the worst of places, at least MARGIN_DB above the receive threshold, no cut lies between
them, and no message between them is lost or late. They are **apart** when no fading and no place could
carry a frame between them.

Mean SNR at distance d (thesis 3.7.1): Pt + 2G - L - FSPL(d0) - 10 n log10(d / d0) - noise, and a jam
raises the noise. Walls that weaken signals (wall_loss_db) are not looked at: what crosses one may be
lost, and a message that is lost ends a link here.
"""

import math
from typing import NamedTuple

import numpy as np

from onehop.checking.measured import Measured
from onehop.checking.snapshot import Snapshot
from onehop.contracts.arrays import BoolArray, FloatArray
from onehop.contracts.link_trace import LinkTrace
from onehop.contracts.messages import DeliveryStatus, Truth, Verdict
from onehop.contracts.radio_section import RadioSection

MARGIN_DB = 4.0
"""What a link has above the receive threshold: a standard deviation of the thesis's fading [dB]."""

FARTHEST_FADE_DB = 24.0
"""No fading carries a frame over more: six standard deviations of the thesis's [dB]."""

PLACE_SIGMAS = 3.0
"""Shadowing between places is held within so many standard deviations (docs/links.md)."""

FAST_FADE_DB = 12.0
"""What many paths add at most to the mean [dB]: more than that has a probability of 1e-7."""

MODEL = "log-distance"
"""The propagation that is worked out anew."""
BOUND_DB = 1e4
"""SNR at any distance of a perfect link, which no jam drowns; and, negative, of none [dB]."""

_LIGHT_SPEED = 3.0e8


class _Preset(NamedTuple):
    """Power and noise [dBm], exponent, threshold, fading of frames and of places [dB]."""

    power: float
    exponent: float
    noise: float
    threshold: float = 32.0
    shadowing: float = 4.0
    spatial: float = 0.0


_PRESET = {
    "thesis": _Preset(23.0103, 2.0, -77.0357),
    "physical": _Preset(15.0, 2.6, -93.55),
    "indoor": _Preset(15.0, 2.4, -93.55, threshold=0.0, shadowing=0.6, spatial=9.0),
}
"""0.2 W with 60 dB at 1 m, and kTB + 7 dB (thesis 3.7; docs/links.md)."""


def _given(value: float | None, default: float) -> float:
    return default if value is None else value


def is_known(radio: RadioSection) -> bool:
    """Whether propagation is worked out anew here: not that of a plugin, unless a trace replaces it."""
    return radio.propagation == MODEL or (radio.links != "" and radio.links_use == "instead")


class Budget:
    """Mean SNR under one radio section. shadowing_db: standard deviation of the fading of frames.

    worst_place_db, best_db: what places take away at most, and what places and many paths add at most;
    links that were measured instead are as they are at their places. unweakened_db: of a signal that
    loses nothing on its way. is_known: whether mean SNR can be worked out at all.
    """

    def __init__(self, radio: RadioSection) -> None:
        preset = _PRESET[radio.preset]
        self.noise_dbm = _given(radio.noise_dbm, preset.noise)
        self.exponent = _given(radio.path_loss_exponent, preset.exponent)
        self.threshold_db = _given(radio.receive_threshold_db, preset.threshold)
        self.shadowing_db = _given(radio.shadowing_db, preset.shadowing)
        is_measured = radio.links != "" and radio.links_use == "instead"
        spatial_db = 0.0 if is_measured else _given(radio.spatial_shadowing_db, preset.spatial)
        self.worst_place_db = PLACE_SIGMAS * spatial_db
        self.best_db = self.worst_place_db + (0.0 if radio.fast_fading == "none" else FAST_FADE_DB)
        self.is_known = is_known(radio)
        self.nearest = radio.reference_distance
        loss = 20.0 * math.log10(4.0 * math.pi * self.nearest * radio.frequency_hz / _LIGHT_SPEED)
        gain = 2.0 * radio.antenna_gain_dbi - radio.system_loss_db
        self.unweakened_db = _given(radio.tx_power_dbm, preset.power) + gain - self.noise_dbm
        self.reference_db = self.unweakened_db - loss
        if radio.link != "modelled":
            self.exponent = 0.0
            self.reference_db = BOUND_DB if radio.link == "perfect" else -BOUND_DB

    def mean_snr_db(self, distances: FloatArray) -> FloatArray:
        """Without walls, at distances [m] of any shape."""
        ratio = np.maximum(distances / self.nearest, 1.0)
        snr: FloatArray = self.reference_db - 10.0 * self.exponent * np.log10(ratio)
        return snr

    def mean_snr_at(self, distance: float) -> float:
        """The same at one distance [m]."""
        return float(self.mean_snr_db(np.array(distance)))

    def jam_rise_db(self, truth: Truth, x: float, y: float) -> float:
        """What the jams of a tick add to the noise at a place [dB]."""
        total = 1.0
        for jam in truth.jams:
            if math.hypot(x - jam.x, y - jam.y) <= jam.radius:
                total += 10.0 ** ((jam.noise_dbm - self.noise_dbm) / 10.0)
        return 10.0 * math.log10(total)


def measured(trace: LinkTrace | None, radio: RadioSection, budget: Budget) -> Measured | None:
    """What was measured of the links of a mission, if anything."""
    return None if trace is None else Measured(trace, radio, budget.unweakened_db, budget.noise_dbm)


class Links:
    """Links of a team, tick by tick. robots: its ids. trace: of links that were measured.

    since: (n, n) first tick from which two robots have been linked without a break, on the diagonal from
    which a robot has run as the same process and not slow; the tick after this one where they are not.
    apart: (n, n) pairs that cannot hear each other now.
    """

    def __init__(
        self, robots: tuple[int, ...], radio: RadioSection, late_ns: int, trace: LinkTrace | None = None
    ) -> None:
        self.row = {robot: row for row, robot in enumerate(robots)}
        self.robots = robots
        self._budget = Budget(radio)
        self._measured = measured(trace, radio, self._budget)
        self._late_ns = late_ns
        count = len(robots)
        self.since = np.zeros((count, count), dtype=np.int64)
        self.apart: BoolArray = np.ones((count, count), dtype=np.bool_)
        self._incarnation = np.full(count, -1)

    def take(self, now: Snapshot, truth: Truth) -> None:
        """One more tick, with its truth."""
        count = len(self.robots)
        place = np.full((count, 2), np.nan)
        incarnation = np.full(count, -1)
        rise = np.zeros(count)
        for one in now.running():
            row = self.row.get(one.robot)
            if row is not None:
                place[row] = one.pose.x, one.pose.y
                incarnation[row] = one.incarnation
                if truth.jams:
                    rise[row] = self._budget.jam_rise_db(truth, one.pose.x, one.pose.y)
        apart = place[:, None, :] - place[None, :, :]
        distances = np.hypot(apart[..., 0], apart[..., 1])
        snr = self._budget.mean_snr_db(distances)
        if self._measured is not None:
            snr = self._measured.matrix_db(self.robots, truth.time_ns, snr)
        snr[np.isnan(distances)] = -np.inf
        snr -= rise[None, :]
        np.fill_diagonal(snr, np.where(np.isnan(place[:, 0]), -np.inf, np.inf))
        for cut in truth.cuts:
            side_a, side_b = self._rows(cut.side_a), self._rows(cut.side_b)
            snr[np.ix_(side_a, side_b)] = -np.inf
            if not cut.one_way:
                snr[np.ix_(side_b, side_a)] = -np.inf
        weakest = np.minimum(snr, snr.T)
        budget = self._budget
        linked = weakest - budget.worst_place_db >= budget.threshold_db + MARGIN_DB
        strongest = np.maximum(snr, snr.T) + budget.best_db
        self.apart = strongest < budget.threshold_db - FARTHEST_FADE_DB
        if not budget.is_known:
            linked[:], self.apart[:] = False, False
        changed = incarnation != self._incarnation
        self._incarnation = incarnation
        if not now.follows:
            changed[:] = True
        for slow in truth.slow:
            changed[self._rows((slow.robot,))] = True
        later = now.tick + 1
        self.since[~linked] = later
        fresh = changed[:, None] | changed[None, :]
        self.since[fresh & linked] = now.tick
        if now.record is not None:
            for verdict in now.record.verdicts:
                if self._breaks(verdict):
                    a, b = self.row.get(verdict.source), self.row.get(verdict.receiver)
                    if a is not None and b is not None:
                        self.since[a, b] = self.since[b, a] = later

    def _rows(self, robots: tuple[int, ...]) -> list[int]:
        return [self.row[robot] for robot in robots if robot in self.row]

    def _breaks(self, verdict: Verdict) -> bool:
        """Whether a message came too late to mean anything, or not at all."""
        if verdict.status is not DeliveryStatus.DELIVERED:
            return True
        return verdict.arrival_ns - verdict.offered_ns > self._late_ns

    def are_linked_since(self, robots: list[int], tick: int) -> bool:
        """Whether all of these have run and been linked with each other from a tick on."""
        rows = self._rows(tuple(robots))
        block = self.since[np.ix_(rows, rows)] <= tick
        return len(rows) == len(robots) and bool(block.all())

    def groups(self, robots: list[int]) -> list[list[int]]:
        """Robots in groups, each out of the reach of all others."""
        left, groups = self._rows(tuple(robots)), []
        near_each_other = ~self.apart
        if near_each_other[np.ix_(left, left)].all():
            return [sorted(robots)] if left else []
        while left:
            group, edge = [], [left.pop(0)]
            while edge:
                row = edge.pop()
                group.append(self.robots[row])
                near = [other for other in left if near_each_other[row, other]]
                left = [other for other in left if other not in near]
                edge += near
            groups.append(sorted(group))
        return groups
