"""How a section of a scenario says what is wrong with it."""

from collections.abc import Iterator
from typing import NamedTuple


class Problem(NamedTuple):
    """A value that cannot be: its key below the section, what is wrong, what would be right."""

    key: str
    what: str
    remedy: str


def positive(section: object, *keys: str) -> Iterator[Problem]:
    for key in keys:
        value = getattr(section, key)
        if not value > 0:
            yield Problem(key, f"{value} is not positive", "give a number above 0")
