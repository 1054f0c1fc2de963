"""Conversions between SI units and what clocks count."""

NANOSECONDS = 1_000_000_000
"""Nanoseconds in a second."""


def nanoseconds(seconds: float) -> int:
    """A time in seconds, on the nanosecond clock of the mission."""
    return round(seconds * NANOSECONDS)
