"""--clock and --speed of `onehop run`."""

import pytest

from onehop.commands.run import clock_settings
from onehop.contracts.errors import InputError

REAL_TIME = 'clock.mode="realtime"'


def test_a_clock_is_a_setting_of_the_scenario() -> None:
    assert clock_settings(None, None) == []
    assert clock_settings("lockstep", None) == ['clock.mode="lockstep"']
    assert clock_settings("realtime", None) == [REAL_TIME]


@pytest.mark.parametrize("clock", [None, "realtime"])
def test_a_speed_means_real_time(clock: str | None) -> None:
    assert clock_settings(clock, 2.0) == [REAL_TIME, "clock.speed=2.0"]


def test_lock_step_has_no_speed() -> None:
    with pytest.raises(InputError, match="--speed"):
        clock_settings("lockstep", 2.0)
