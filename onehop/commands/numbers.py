"""The numbers of the command line: each finite and within a range that the programs can carry."""

from collections.abc import Callable

from typer import CallbackParam

from onehop.contracts.errors import InputError
from onehop.contracts.ranges import Range, shown

SEED = Range(0, 2**63 - 1)
ROBOT = Range(1, 2**31 - 1)
MISSION_TIME = Range(0.0, 1e6)
"""Simulated time [s], as in a scenario."""

SPEED = Range(0.01, 100.0)
"""Simulated seconds in one of the wall clock."""

CELL = Range(1e-3, 1e3)
"""Metres a cell of a MovingAI grid, as in a scenario."""

SPACING = Range(0.1, 1e3)
"""Distance between neighbours in a formation [m]."""

DISTANCE = Range(1e-3, 1e6)
"""Length of a link [m]: from the near field to where nothing is received."""

MEASURED = Range(0.01, 3600.0)
"""Simulated time of a measurement of the radio [s]; an hour takes minutes."""

MSDU = Range(1, 2304)
"""Payload of a frame [B]; the most is that of 802.11."""

STATIONS = Range(1, 200)

RUNS = Range(0, 10_000_000)
"""Missions of a campaign."""

SEEDS = Range(1, 10_000_000)
"""Missions of a cell."""

JOBS = Range(1, 1000)
"""Worker processes."""

SHARE = Range(0.0, 1.0)

ROBOTS = Range(1, 300)
"""Robots of a team, as in a scenario."""

DAYS = Range(1, 3650)
"""How long a certificate is good [days]."""

ROS_DOMAIN = Range(0, 232)
"""ROS_DOMAIN_ID."""

WAIT = Range(1.0, 86_400.0)
"""How long a mission waits for processes on other hosts [s]."""


def within(limits: Range) -> Callable[[CallbackParam, float | None], float | None]:
    """A check for an option's value. Raises InputError."""

    def checked(option: CallbackParam, value: float | None) -> float | None:
        if value is not None:
            require_within(limits, option.opts[0], value)
        return value

    return checked


def require_within(limits: Range, option: str, value: float) -> None:
    """Raise InputError unless a number is within its range; NaN is in none."""
    if not limits.least <= value <= limits.most:
        raise InputError(f"{option} {shown(value)}", "out of range", f"{limits}")
