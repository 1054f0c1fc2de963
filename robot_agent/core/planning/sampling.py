"""Where a road map gets its points from: chance inside the fan, and the places where ways bend.

The fan is the sector of the field of view in which points are drawn, inside the visible region only,
since it is known; what the laser did not see is not free (thesis 3.4.1).
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from robot_agent.core.planning.view import NO_POINTS, View

R2: FloatArray = np.array((0.7548776662466927, 0.5698402909980532))
"""1/g and 1/g^2 with g^3 = g + 1."""

SHORT_OF_HIT = 0.98
"""Share of a beam's free range that points are drawn from: one at its very end is on the obstacle."""

END_SPACING = math.radians(1.0)
"""Between the beams at whose end a point is put where an outline ends [rad]: 0.17 m at 10 m; with more
of them a fine laser would only make the road map slower."""


def spread_draws(count: int, rng: np.random.Generator) -> FloatArray:
    """Draws for `sample_fan`, (count, 2): an additive recurrence of low discrepancy, shifted at random.

    Quasi-random points leave smaller holes than independent ones (Branicky, LaValle, Olson and Yang,
    "Quasi-randomized path planning", ICRA 2001); the multiples are those of Roberts's R2 sequence.
    """
    return np.asarray((rng.random(2) + np.arange(count)[:, None] * R2) % 1.0)


def sample_fan(view: View, draws: FloatArray, centre: float, half: float, margin: float) -> FloatArray:
    """Points of the visible region inside the fan, (n, 2) float64 [m], map frame.

    draws: (n, 2) uniform in [0, 1): direction, and radius as a share of the free range. centre, half:
    direction [rad, map frame] and half of the fan; it is cut to the field of view. margin: room
    to leave to the end of the laser's range, beyond which anything may stand [m].
    """
    angles = view.beams.angles
    offset = math.remainder(centre - view.pose.heading, 2.0 * math.pi)
    low = min(max(offset - half, float(angles[0])), float(angles[-1]))
    high = max(min(offset + half, float(angles[-1])), float(angles[0]))
    bearing = low + (high - low) * draws[:, 0]
    beam = np.rint((bearing - angles[0]) / view.beams.spacing).astype(np.intp)
    reach = np.minimum(view.sight[beam], view.beams.range - margin)
    radius = reach * np.sqrt(draws[:, 1]) * SHORT_OF_HIT
    heading = bearing + view.pose.heading
    directions = np.column_stack((elementary.cosines(heading), elementary.sines(heading)))
    return np.asarray(view.origin + directions * radius[:, None])


def outline_end_samples(view: View, margin: float) -> FloatArray:
    """Points where outlines leave the laser's range, (n, 2) [m]: chance may miss them.

    margin: room to leave to the end of the range [m].
    """
    far = np.flatnonzero(view.outline_ends)[:: view.beams.spanned(END_SPACING)]
    return view.origin + view.directions[far] * (view.beams.range - margin)


def goal_sample(view: View, goal: FloatArray, margin: float) -> FloatArray:
    """The furthest point in sight straight towards the goal, (1, 2) [m]; none if out of view."""
    bearing, distance = view.polar(goal[None])
    if abs(bearing[0]) >= view.beams.angles[-1]:
        return NO_POINTS
    beam = round(float((bearing[0] - view.beams.angles[0]) / view.beams.spacing))
    reach = view.sight[beam] - margin
    share = max(float(reach), 0.0) / max(float(distance[0]), 1e-9)
    return (view.origin + (goal - view.origin) * share)[None]


def corner_samples(view: View, gap: float, room: float) -> FloatArray:
    """Points beside what the robot sees pass before something farther off, (n, 2) [m].

    A shortest way bends there and nowhere else, and chance draws none of them right there. gap: jump of
    the range between two beams [m]; room: to leave to the near one's end [m].
    """
    jumps = np.diff(view.sight)
    beam = np.flatnonzero(np.abs(jumps) > gap)
    left = np.where(jumps[beam] > 0.0, 1.0, -1.0)
    near = np.where(jumps[beam] > 0.0, beam, beam + 1)
    ahead = view.directions[near]
    aside = np.column_stack((-left * ahead[:, 1], left * ahead[:, 0]))
    end = view.origin + ahead * view.sight[near, None]
    return np.concatenate((end + room * aside, end + room * (aside + ahead)))
