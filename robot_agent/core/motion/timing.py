"""Durations in ticks. What a robot waits for is given in seconds, whatever its control period is."""


def in_ticks(seconds: float, period: float) -> int:
    """A duration as a whole number of ticks of `period` [s], at least one."""
    return max(1, round(seconds / period))
