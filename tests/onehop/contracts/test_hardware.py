"""What the driver of a base may say, and what comes through the wire."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.hardware import LARGEST, BaseBriefing, Drive, Measured, Taken, wrong_measurement
from onehop.contracts.sections import RobotSection
from onehop.wire.codec import decode, encode

places = st.floats(-LARGEST, LARGEST)
headings = st.floats(-math.pi, math.pi)
ranges = st.lists(st.floats(0, 2.0**20, width=32) | st.just(math.inf), min_size=2, max_size=400)


def measured(
    number: int, x: float, y: float, heading: float, v: float, w: float, scan: list[float]
) -> Measured:
    return Measured(number, Pose(x, y, heading), Twist(v, w), np.array(scan, dtype=np.float32))


sound = st.builds(measured, st.integers(1, 2**53), places, places, headings, places, places, ranges)


@given(sound, st.integers(0, 2**32 - 1))
def test_a_measurement_comes_back_as_it_was_and_is_logged_as_it_came(one: Measured, tick: int) -> None:
    back = decode(Measured, encode(one))
    assert (back.number, back.pose, back.twist) == (one.number, one.pose, one.twist)
    assert back.scan.tobytes() == one.scan.tobytes()
    taken = encode(Taken(tick, tick * 50_000_000, back))
    assert encode(decode(Taken, taken)) == taken
    assert encode(one) in taken


@given(sound)
def test_what_a_base_can_measure_is_taken(one: Measured) -> None:
    assert wrong_measurement(one, len(one.scan)) is None
    assert wrong_measurement(one, len(one.scan) + 1) is not None


@given(sound, st.sampled_from(("x", "y", "heading", "v", "w", "scan", "number")), st.data())
def test_what_it_cannot_is_named(one: Measured, which: str, data: st.DataObject) -> None:
    beyond = st.sampled_from((math.nan, math.inf, -math.inf, 1.1 * LARGEST, -1.1 * LARGEST))
    fields = {"x": one.pose.x, "y": one.pose.y, "heading": one.pose.heading, "v": one.twist.v,
              "w": one.twist.w, "scan": one.scan.tolist(), "number": one.number}  # fmt: skip
    if which == "number":
        fields[which] = data.draw(st.integers(-(2**40), 0))
    elif which == "scan":
        place = data.draw(st.integers(0, len(one.scan) - 1))
        fields["scan"][place] = data.draw(st.sampled_from((math.nan, -math.inf, -0.5)))
    else:
        fields[which] = data.draw(beyond)
    why = wrong_measurement(measured(**fields), len(one.scan))
    assert why is not None
    assert which in why
    assert "\n" not in why


@pytest.mark.parametrize("heading", [math.pi, -math.pi, float(np.float32(math.pi))])
def test_a_heading_may_be_of_single_precision(heading: float) -> None:
    assert wrong_measurement(measured(1, 0.0, 0.0, heading, 0.0, 0.0, [1.0, 2.0]), 2) is None
    assert wrong_measurement(measured(1, 0.0, 0.0, 1.001 * heading, 0.0, 0.0, [1.0, 2.0]), 2) is not None


def test_what_a_base_is_told_comes_back() -> None:
    drive = Drive(7, Twist(0.5, -1.0))
    assert decode(Drive, encode(drive)) == drive
    briefing = BaseBriefing(3, 50_000_000, 10.0, RobotSection())
    assert decode(BaseBriefing, encode(briefing)) == briefing
