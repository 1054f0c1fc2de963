"""Serial number arithmetic, RFC 1982."""

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from onehop.contracts.serial_numbers import LIMIT, following, newer, newest, towards

numbers = st.integers(0, LIMIT - 1)


@pytest.mark.parametrize(
    ("a", "b"), [(1, 0), (44, 0), (0, LIMIT - 1), (100, LIMIT - 100), (2**31 - 1, 0), (2**31, 0)]
)
def test_what_comes_after_is_newer_across_the_end_too(a: int, b: int) -> None:
    """RFC 1982, 5."""
    assert newer(a, b)
    assert not newer(b, a)


@given(numbers, numbers)
def test_of_two_numbers_exactly_one_is_newer_unless_they_are_equal(a: int, b: int) -> None:
    assert newer(a, b) + newer(b, a) == (a != b)
    assert newest(a, b) == newest(b, a)


@given(numbers)
def test_there_is_always_a_next_one_and_it_is_newer(a: int) -> None:
    assert newer(following(a), a)
    assert 0 <= following(a) < LIMIT


@given(numbers, numbers)
@example(0, 2**31)
@example(2**31, 2**32 - 1)
def test_three_steps_lead_beyond_any_newer_number_each_newer_than_the_one_before(a: int, b: int) -> None:
    """A number that is older already may be half the circle away, and seem newer after a step."""
    assume(not newer(a, b))
    for _ in range(3):
        step = following(towards(a, b))
        assert newer(step, a)
        a = step
    assert newer(a, b)
