"""Bodies that touch, or are where they cannot have come to: each is found by its name."""

from typing import Any

import pytest

from tests.onehop.checking.conftest import LEADER, RETURNED
from tests.onehop.forgery import Fields, Forgery


def moved(x: float = 0.0, y: float = 0.0, heading: float = 0.0) -> Any:
    def change(one: Fields) -> None:
        pose = one["pose"]
        pose["x"], pose["y"], pose["heading"] = pose["x"] + x, pose["y"] + y, pose["heading"] + heading

    return change


def jump_and_return(log: Forgery) -> None:
    log.present(range(50, 51), 3, moved(x=0.4))


def drive_faster_than_commanded(log: Forgery) -> None:
    for late, tick in enumerate(range(50, 60)):
        log.present(range(tick, tick + 1), 3, moved(y=0.02 * late))
    log.present(range(60, 120), 3, moved(y=0.2))


def spin(log: Forgery) -> None:
    log.present(range(50, 51), 3, moved(heading=0.5))


def move_while_held(log: Forgery) -> None:
    log.present(range(175, 280), 4, moved(x=0.01))


def come_back_elsewhere(log: Forgery) -> None:
    log.present(range(RETURNED, 280), LEADER, moved(y=0.3))


@pytest.mark.parametrize(
    ("alter", "log"),
    [(jump_and_return, "quiet"), (drive_faster_than_commanded, "quiet"), (spin, "quiet"),
     (move_while_held, "troubled"), (come_back_elsewhere, "troubled")],
)  # fmt: skip
def test_a_robot_that_moves_farther_than_it_can_is_found(broken: Any, alter: Any, log: str) -> None:
    assert set(broken(alter, log).broken) == {"motion"}


def touch_a_wall(log: Forgery) -> None:
    contact = {"robot": 3, "other": 0, "x": 1.0, "y": 1.0}
    log.change(50, "truth", lambda truth: truth["contacts"].append(contact))
    log.summary["collisions"] = 1


def touch_each_other(log: Forgery) -> None:
    contact = {"robot": 3, "other": 4, "x": 1.0, "y": 1.0}
    log.change(50, "truth", lambda truth: truth["contacts"].append(contact))
    log.summary["collisions"] = 1


def count_a_contact_that_is_not_shown(log: Forgery) -> None:
    log.summary["collisions"] = 1


@pytest.mark.parametrize("alter", [touch_a_wall, touch_each_other, count_a_contact_that_is_not_shown])
def test_a_contact_is_found(broken: Any, alter: Any) -> None:
    assert set(broken(alter).broken) == {"no-collision"}


def stand_in_each_other(log: Forgery) -> None:
    place = next(one["pose"] for one in log.get(50, "truth")["present"] if one["robot"] == 4)
    log.present(range(50, 51), 3, lambda one: one.update(pose=dict(place)))


def stand_in_a_wall(log: Forgery) -> None:
    log.present(range(50, 51), 3, lambda one: one["pose"].update(x=18.1, y=26.0))


@pytest.mark.parametrize("alter", [stand_in_each_other, stand_in_a_wall])
def test_bodies_that_overlap_are_found_without_a_contact(broken: Any, alter: Any) -> None:
    assert set(broken(alter).broken) == {"no-collision", "motion"}
