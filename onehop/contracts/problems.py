"""How a section of a scenario says what is wrong with it."""

from typing import NamedTuple


class Problem(NamedTuple):
    """A value that cannot be: its key below the section, what is wrong, what would be right."""

    key: str
    what: str
    remedy: str
