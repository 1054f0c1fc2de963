"""Numbers for people."""

import pytest

from onehop.study.in_words import interval, number


@pytest.mark.parametrize(
    ("value", "word"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (0.12345, "0.123"),
        (12.345, "12.3"),
        (123456.0, "123456"),
        (-2.5, "-2.5"),
    ],
)
def test_three_digits_count(value: float, word: str) -> None:
    assert number(value) == word


def test_an_interval_is_in_the_unit_asked_for() -> None:
    assert interval(790e3, 787e3, 793e3, 1e3) == "790 [787, 793]"
    assert interval(5.0, None, None) == "5"
    assert interval(None, None, None) == "-"
