"""The one wait of the world: it ends with what it waits for, at its limit, or with the mission."""

import time
from collections.abc import Iterator

import pytest

from onehop.mission.processes import free_endpoint
from onehop.node.bus import Bus, open_router
from world_server.mailbox import Mailbox, MissionBrokenError

pytestmark = pytest.mark.live

LONG_S = 60.0
"""A limit that no test here waits for."""


@pytest.fixture
def bus() -> Iterator[Bus]:
    with open_router("m", free_endpoint()) as router:
        yield router


def _waited_s(mail: Mailbox, limit_s: float) -> float:
    started = time.monotonic()
    assert not mail.wait(lambda: False, limit_s)
    return time.monotonic() - started


def test_messages_reach_their_readers_until_it_is_done(bus: Bus) -> None:
    mail = Mailbox(bus)
    heard: list[bytes] = []
    mail.read("world", "word", heard.append)
    for word in (b"one", b"two", b"three"):
        bus.tell_self("unheard", word)
        bus.tell_self("word", word)
    assert mail.wait(lambda: len(heard) == 2, LONG_S)
    assert heard == [b"one", b"two"]
    assert mail.wait(lambda: len(heard) == 3, LONG_S)


def test_a_wait_for_nothing_ends_at_its_limit(bus: Bus) -> None:
    assert 0.2 <= _waited_s(Mailbox(bus), 0.2) < LONG_S


def test_a_mission_that_is_broken_off_ends_a_wait_even_when_messages_keep_coming(bus: Bus) -> None:
    mail = Mailbox(bus)
    mail.read("world", "word", lambda _: bus.tell_self("word"))
    bus.tell_self("word")
    mail.break_off("the radio is lost", after_s=0.2)
    with pytest.raises(MissionBrokenError, match="the radio is lost"):
        mail.wait(lambda: False, LONG_S)


@pytest.mark.parametrize("account_first", [False, True])
def test_an_account_that_comes_in_time_is_the_reason(bus: Bus, account_first: bool) -> None:
    mail = Mailbox(bus)
    said = [("its token is gone", LONG_S), ("it died (SIGKILL)", 0.0)]
    for reason, after_s in reversed(said) if account_first else said:
        mail.break_off(reason, after_s)
    with pytest.raises(MissionBrokenError, match="SIGKILL"):
        mail.wait(lambda: False, LONG_S)


def test_nothing_breaks_off_a_mission_that_is_over(bus: Bus) -> None:
    mail = Mailbox(bus)
    mail.break_off("early", after_s=LONG_S)
    mail.close_mission()
    mail.break_off("late")
    assert _waited_s(mail, 0.1) < LONG_S


def test_whoever_says_what_nobody_reads_is_known(bus: Bus) -> None:
    mail = Mailbox(bus)
    strays: list[str] = []
    mail.read("world", "word", lambda _: None)
    mail.read_stray(strays.append)
    for word in ("word", "song"):
        bus.tell_self(word)
    assert mail.wait(lambda: bool(strays), LONG_S)
    assert strays == ["world"]
