"""`planner.kind = "path"`: the leader keeps to the path that it is given, from wherever it starts."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from onehop.contracts.sections import MapSection, PlannerSection, Point, StartSection
from onehop.drivers.trial import Trial, TrialOutcome, run_trial
from onehop.maps.walls import segment_distances
from tests.agent.planning.fields import alone, box, field
from tests.agent.planning.test_pathfinders import assert_arrived

OPEN = field(size=60.0)
ZIGZAG: tuple[Point, ...] = ((5.0, 5.0), (30.0, 5.0), (30.0, 40.0), (12.0, 38.0), (50.0, 50.0))


def drive(
    ground: MapSection,
    path: tuple[Point, ...],
    start: tuple[float, float, float],
    limit_s: float = 400.0,
) -> Trial:
    """One leader along a path to its last point."""
    scenario, walls = alone(ground, start, path[-1], limit_s=limit_s)
    return run_trial(replace(scenario, planner=PlannerSection(kind="path", path=path)), walls)


def strayed(trial: Trial, path: tuple[Point, ...], first: float = 0.0) -> float:
    """The farthest that a leader was from a path, beyond its first metres [m]."""
    legs = np.array([(*here, *there) for here, there in pairwise(path)])
    track = trial.path[np.hypot(*(trial.path[:, :2] - trial.path[0, :2]).T) >= first, :2]
    return float(segment_distances(track, legs).min(axis=1).max())


def test_a_leader_drives_along_its_path_at_constant_speed_around_sharp_corners() -> None:
    trial = drive(OPEN, ZIGZAG, (5.0, 5.0, 0.0))
    assert_arrived(trial)
    assert strayed(trial, ZIGZAG) < 0.4
    whole = sum(math.dist(here, there) for here, there in pairwise(ZIGZAG))
    assert trial.length == pytest.approx(whole, rel=0.02)
    assert len(trial.path) * 0.05 < whole + 12.0


def test_a_leader_that_starts_beside_its_path_and_looks_away_joins_it() -> None:
    trial = drive(OPEN, ZIGZAG, (5.0, 8.0, 180.0))
    assert_arrived(trial)
    assert strayed(trial, ZIGZAG, first=11.0) < 0.4


def test_a_leader_elected_in_the_middle_goes_on_from_there() -> None:
    trial = drive(OPEN, ZIGZAG, (33.0, 25.0, -90.0))
    assert_arrived(trial)
    assert strayed(trial, ZIGZAG, first=4.0) < 0.4
    assert trial.length < 90.0


def test_out_of_sight_of_its_path_a_leader_finds_a_way_to_it() -> None:
    """A wall 12 m long between them; thesis 3.3.5: a new leader plans from where it stands."""
    path = ((5.0, 5.0), (50.0, 5.0))
    trial = drive(field(box(20, 8, 32, 10), size=60.0), path, (26.0, 13.0, 90.0))
    assert_arrived(trial)


def test_a_leader_gets_around_what_stands_on_its_path() -> None:
    """A lost robot on the way, that the scenario does not know of."""
    path = ((5.0, 20.0), (35.0, 20.0))
    scenario, _ = alone(field(size=40.0), (5.0, 20.0, 0.0), path[-1], limit_s=60.0)
    scenario = replace(scenario, planner=PlannerSection(kind="path", path=path))
    post = alone(field(box(19.8, 19.8, 20.2, 20.2), size=40.0), (5.0, 20.0, 0.0), path[-1])[1]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("onehop.drivers.trial.start_poses", lambda *_: np.array([[5.0, 20.0, 0.0]]))
        trial = run_trial(scenario, post)
    assert trial.outcome is TrialOutcome.ARRIVED
    assert trial.min_clearance > 0.47
    assert trial.length < 33.0


def test_the_same_seed_drives_the_same_way() -> None:
    first, again = (drive(OPEN, ZIGZAG, (5.0, 8.0, 90.0)).path.tobytes() for _ in range(2))
    assert first == again


def test_a_start_disc_is_near_enough_to_a_path_that_begins_in_it() -> None:
    scenario, walls = alone(OPEN, (5.0, 5.0, 0.0), ZIGZAG[-1], limit_s=200.0)
    disc = replace(
        scenario, start=StartSection(7.0, 7.0), planner=PlannerSection(kind="path", path=ZIGZAG)
    )
    assert not list(disc.problems())
    assert_arrived(run_trial(disc, walls))
