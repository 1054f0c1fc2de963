"""A process is told what it may know, as often as it can be in need of it."""

from pathlib import Path

import numpy as np

from tests.onehop.scenes import field
from world_server.briefings import ANSWERS, Briefings


class Roll:
    """Who has been started again how often."""

    def __init__(self) -> None:
        self.restarts = 0

    def incarnation(self, _: str) -> int:
        return self.restarts


def test_who_asks_on_and_on_is_answered_no_more_until_it_is_started_again(tmp_path: Path) -> None:
    roll = Roll()
    briefings = Briefings(field(tmp_path), np.empty((0, 4)), "processes", roll.incarnation)
    for key in ("config/robot-1", "config/radio"):
        answers = [briefings.answer(key) for _ in range(2 * ANSWERS)]
        assert None not in answers[:ANSWERS]
        assert set(answers[ANSWERS:]) == {None}
    assert briefings.answer("config/robot-2") is not None
    roll.restarts = 1
    assert briefings.answer("config/robot-1") is not None


def test_nobody_else_is_answered(tmp_path: Path) -> None:
    briefings = Briefings(field(tmp_path), np.empty((0, 4)), "processes", Roll().incarnation)
    assert briefings.answer("config/robot-9") is None
    assert briefings.answer("config/operator") is None
