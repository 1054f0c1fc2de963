"""Messages of any length in parts that a robot's link carries, and back."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.node.parts import PART_BYTES, Parts, last_part, leading_parts

FITS = PART_BYTES


@pytest.mark.parametrize("size", [0, 1, FITS, FITS + 1, 2 * FITS, 2 * FITS + 1, 10 * FITS - 1])
def test_every_part_fits_and_together_they_are_the_message(size: int) -> None:
    data = bytes(number % 251 for number in range(size))
    leading = list(leading_parts(data))
    assert all(len(part) == PART_BYTES for part in leading)
    assert len(last_part(data)) <= PART_BYTES
    parts = Parts(size)
    assert [parts.joined("part", part) for part in leading] == [None] * len(leading)
    assert parts.joined("percept", last_part(data)) == data
    assert parts.joined("percept", b"next") == b"next"


@given(st.lists(st.tuples(st.sampled_from(("robot-1", "robot-2")), st.binary(max_size=5)), max_size=20))
def test_parts_of_several_senders_do_not_mix(said: list[tuple[str, bytes]]) -> None:
    parts = Parts(1000)
    for sender, data in said:
        assert parts.joined(f"{sender}/part", data) is None
    for name in ("robot-1", "robot-2"):
        own = b"".join(data for sender, data in said if sender == name)
        assert parts.joined(f"{name}/out", b"!") == own + b"!"


def test_parts_without_end_are_a_message_that_nobody_reads() -> None:
    parts = Parts(10)
    assert parts.joined("robot-1/part", bytes(10)) is None
    assert parts.joined("robot-1/part", b"x") == bytes(10) + b"x"
    assert parts.joined("robot-1/out", b"y") == b"y"
