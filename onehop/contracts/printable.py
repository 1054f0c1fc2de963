"""What others said, as text that a terminal, a page or a figure can show without harm."""

import math
from collections.abc import Iterable
from typing import Any

LONGEST = 400
"""Letters of one text that are shown; nobody reads more, and a peer can send megabytes."""

MOST_IDS = 40
"""Robots of one list that are shown."""


def printable(text: str, longest: int = LONGEST) -> str:
    """The text in one line: escapes for what does not print, "..." for what is too long."""
    shown = text if len(text) <= longest else text[:longest] + "..."
    if shown.isprintable():
        return shown
    return "".join(each if each.isprintable() else ascii(each)[1:-1] for each in shown)


def ids_in_words(robots: Iterable[int], separator: str = " ") -> str:
    """Ids of robots, as many as anybody reads."""
    listed = list(robots)
    more = f"{separator}and {len(listed) - MOST_IDS} more" if len(listed) > MOST_IDS else ""
    return separator.join(map(str, listed[:MOST_IDS])) + more


def in_words(value: Any) -> str:
    """What a note says under a key: a number, a text or ids of robots."""
    if isinstance(value, list | tuple):
        return ids_in_words(value, ", ")
    return f"{value:z.2f}" if isinstance(value, float) else printable(str(value))


def json_value(value: Any) -> Any:
    """A value as JSON can say it: bytes in hexadecimal, numbers that are not finite as text."""
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, dict):
        return {str(key): json_value(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [json_value(inner) for inner in value]
    return value if isinstance(value, int | float | str | None) else str(value)
