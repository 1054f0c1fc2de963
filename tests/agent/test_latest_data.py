"""A robot in real time: what it says again when its answers may be lost."""

from typing import Any

import numpy as np

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Observation
from onehop.contracts.realtime import Acted
from onehop.wire.codec import decode, encode
from robot_agent.latest_data import KEPT_ANSWERS, LatestData


class Mute:
    """A program that has nothing to say."""

    def step(self, _: object) -> bytes:
        return b""


def test_the_last_answers_are_said_again_as_they_were_and_in_their_order() -> None:
    said: list[bytes] = []
    program: Any = Mute()
    latest = LatestData(program, said.append)
    scan = np.zeros(3, dtype=np.float32)
    for tick in range(KEPT_ANSWERS + 2):
        seen = Observation(tick, tick, 0, Pose(0.0, 0.0, 0.0), Twist(0.0, 0.0), scan)
        latest.on_observation(encode(seen))
        latest.step()
    before = list(said)
    latest.say_again()
    assert said[len(before) :] == before[2:]
    assert [decode(Acted, one).number for one in before] == list(range(1, KEPT_ANSWERS + 3))
