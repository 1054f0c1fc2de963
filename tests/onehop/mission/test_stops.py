"""Being asked to end: an exception outside of missions, a note within them."""

import signal
from collections.abc import Iterator

import pytest

from onehop.mission.stops import ENDS, Stopped, StopRequest, raise_when_asked_to_end


@pytest.fixture(autouse=True)
def handlers() -> Iterator[None]:
    """Every signal begins as a shell leaves it, and gets its handler back."""
    before = {number: signal.signal(number, signal.SIG_DFL) for number in ENDS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", ENDS)
def test_each_signal_raises_with_its_number(number: signal.Signals) -> None:
    raise_when_asked_to_end()
    with pytest.raises(Stopped) as stopped:
        signal.raise_signal(number)
    assert stopped.value.number == number


def test_within_a_mission_the_first_one_is_noted_and_nothing_is_raised() -> None:
    raise_when_asked_to_end()
    with StopRequest() as stop:
        stop.obey()
        assert stop.number is None
        signal.raise_signal(signal.SIGHUP)
        signal.raise_signal(signal.SIGTERM)
        assert stop.number == signal.SIGHUP
        with pytest.raises(Stopped):
            stop.obey()
    with pytest.raises(Stopped):
        signal.raise_signal(signal.SIGTERM)


def test_what_was_to_be_ignored_stays_ignored() -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    raise_when_asked_to_end()
    with StopRequest() as stop:
        signal.raise_signal(signal.SIGHUP)
        assert stop.number is None
    signal.raise_signal(signal.SIGHUP)
