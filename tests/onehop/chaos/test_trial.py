"""What is held against a mission, and what excuses it."""

import dataclasses
from pathlib import Path

import pytest

from onehop.chaos.arrival import why_it_should_have
from onehop.chaos.disturbance import Disturbance
from onehop.chaos.trial import tried
from onehop.checking import judge
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Presence
from onehop.scenario.bundle import Bundle
from onehop.wire.log_reader import LogFile
from tests.onehop.scenes import field

BEHIND_THE_BLOCK = ("start.x=21", "start.y=15", "goal.x=21", "goal.y=38", "team.size=1")


def test_who_is_blind_may_touch_a_wall_and_who_sees_may_not(tmp_path: Path) -> None:
    blind = "faults=[{kind='blind', at_s=0, robots=[1], duration_s=40}]"
    bundle = field(tmp_path, *BEHIND_THE_BLOCK, blind, "clock.limit_s=25")
    log = tmp_path / "mission.mcap"
    trial = tried(bundle, log=log)
    assert "no-collision" in judge(LogFile(log)).broken
    assert "no-collision" not in trial.broken()
    end = Disturbance()
    judge(LogFile(log), watchers=[end])
    assert not end.knew_its_way(1, 499, 60)
    assert end.knew_its_way(1, 499 + 61, 60)


@pytest.fixture
def lone(tmp_path: Path) -> Bundle:
    """One robot at (8, 8), 23 m from the goal."""
    return field(tmp_path, "team.size=1", "clock.limit_s=2000")


def ended(whole: bool = True, quiet_since: int = 0, arrived_at: int = -1) -> Disturbance:
    """A mission that has ended with the robot where it began."""
    end = Disturbance()
    end.present = (Presence(1, 0, Pose(8.0, 8.0, 0.0), Twist(0.0, 0.0), False),)
    end.whole = {1} if whole else set()
    end.quiet_since, end.arrived_at = quiet_since, arrived_at
    return end


def summary(outcome: str = "failed", sim_s: float = 2000.0) -> dict[str, object]:
    return {"outcome": outcome, "sim_s": sim_s, "reason": "time limit of 2000 s"}


def test_a_mission_that_had_a_way_and_the_time_should_have_arrived(lone: Bundle) -> None:
    why = why_it_should_have(lone, summary(), ended())
    assert why is not None
    assert "robots 1 are whole and have had 2000 s of quiet, and the goal is 23 m away" in why


def test_one_that_gives_up_early_is_not_excused_by_the_clock(lone: Bundle) -> None:
    assert why_it_should_have(lone, summary(sim_s=30.0), ended()) is not None


@pytest.mark.parametrize(
    ("said", "end"),
    [
        (summary("arrived"), ended()),
        (summary(), ended(whole=False)),
        (summary(), ended(quiet_since=39_000)),
        (summary(), ended(quiet_since=100, arrived_at=200)),
    ],
    ids=["arrived", "nobody whole", "too little time", "a leader was there"],
)
def test_what_excuses_a_mission(lone: Bundle, said: dict[str, object], end: Disturbance) -> None:
    assert why_it_should_have(lone, said, end) is None


def test_a_goal_that_was_reached_before_the_last_fault_is_no_excuse(lone: Bundle) -> None:
    assert why_it_should_have(lone, summary(), ended(quiet_since=300, arrived_at=200)) is not None


def test_bodies_that_close_the_way_excuse_it(lone: Bundle) -> None:
    """A wall with a door of 2 m, in which a dead robot stands."""
    halves = (
        ((0.0, 10.0), (14.0, 10.0), (14.0, 11.0), (0.0, 11.0)),
        ((16.0, 10.0), (40.0, 10.0), (40.0, 11.0), (16.0, 11.0)),
    )
    ground = dataclasses.replace(lone.scenario.map, obstacles=halves)
    walled = Bundle(dataclasses.replace(lone.scenario, map=ground), {})
    end = ended()
    assert why_it_should_have(walled, summary(), end) is not None
    end.graves[2] = (15.0, 10.5)
    assert why_it_should_have(walled, summary(), end) is None
