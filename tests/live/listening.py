"""What tests of the bus wait for: that sessions hear each other, and that a message has come."""

import itertools
import time
from collections.abc import Callable, Mapping

import pytest

from onehop.node import bus, gate, peer_limits
from onehop.node.bus import Bus
from tests.live.mission import PATIENCE_S

SILENCE_S = 0.2
"""How long nobody has to say anything, until what was not expected counts as not having come [s]."""

_TRY_S = 1.0


def be_patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """End no session that is opened from now on because the machine is busy.

    A peer has a minute to read and to say that it is there, in place of one second and of three.
    """
    minute_ms = 60_000
    monkeypatch.setattr(bus, "LEASE_MS", minute_ms)
    monkeypatch.setattr(gate, "UNREAD_MS", minute_ms)
    blocked = "transport/link/tx/queue/congestion_control/block/wait_before_close"
    assert blocked in peer_limits.SETTINGS
    monkeypatch.setitem(peer_limits.SETTINGS, blocked, 1000 * minute_ms)


def settle(world: Bus, clients: Mapping[str, Bus]) -> None:
    """Wait until the world and these clients hear each other.

    Declarations travel by themselves, and nothing announces that they have arrived.
    """
    for name, client in clients.items():
        _until_heard(world.publisher(f"to/{name}/hello"), client, "hello")
        _until_heard(client.publisher(f"from/{name}/hello"), world, f"{name}/hello")


def _until_heard(put: Callable[[bytes], None], ears: Bus, what: str) -> None:
    """Say numbers until one comes at once: those before it have come too, or never will."""
    gives_up = time.monotonic() + PATIENCE_S
    for number in itertools.count():
        assert time.monotonic() < gives_up
        put(b"%d" % number)
        deadline = time.monotonic() + _TRY_S
        while (received := ears.receive_by(deadline)) is not None:
            if received == (what, b"%d" % number):
                return


def heard(ears: Bus, count: int = 1) -> list[tuple[str, bytes]]:
    """All messages that have come, sorted: those that are waited for, and what comes right after."""
    messages: list[tuple[str, bytes]] = []
    gives_up = time.monotonic() + PATIENCE_S
    while True:
        is_enough = len(messages) >= count
        received = ears.receive_by(time.monotonic() + SILENCE_S if is_enough else gives_up)
        if received is None:
            return sorted(messages)
        messages.append(received)


def await_message(ears: Bus, wanted: tuple[str, bytes]) -> None:
    """Wait for one message, whatever comes before it."""
    gives_up = time.monotonic() + PATIENCE_S
    while (received := ears.receive_by(gives_up)) != wanted:
        assert received is not None, f"{wanted} has not come"
