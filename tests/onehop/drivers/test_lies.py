"""A robot whose action breaks a limit is fenced by name; the others, and the log, are none the worse."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest

from onehop.contracts.geometry import Twist
from onehop.contracts.messages import BROADCAST, Action, Note, Percept, Transmission
from onehop.drivers import inline
from onehop.drivers.replay import replay
from onehop.wire.log_reader import LogFile
from robot_agent.core.robot import Robot
from tests.onehop.scenes import field, log_of

LIAR = 3
FIRST_TICK = 20

Lie = Callable[[Action], Action]


def changed(**fields: Any) -> Lie:
    return lambda action: msgspec.structs.replace(action, **fields)


LIES: dict[str, tuple[Lie, str]] = {
    "a twist that is no number": (changed(twist=Twist(math.nan, 0.0)), "twist.v is nan, not a number"),
    "a twist without end": (changed(twist=Twist(0.0, math.inf)), "twist.w is inf, not a number"),
    "a frame that holds the air for ever": (
        changed(outbox=(Transmission(BROADCAST, b"", 2**40, 0),)),
        "a message of 1099511627776 bytes on the air",
    ),
    "a broadcast of 60 kB": (
        changed(outbox=(Transmission(BROADCAST, bytes(60_000), 60_000, 0),)),
        "a message of 60000 bytes on the air",
    ),
    "100,000 messages": (
        changed(outbox=(Transmission(1, b"", 10, 0),) * 100_000),
        "100000 messages in a tick; 80 may be sent",
    ),
    "notes that nobody should see": (
        changed(notes=(Note("\x1b[2J", {}),)),
        "a note whose kind is no word",
    ),
    "another tick": (changed(tick=5), "answered for tick 5 as incarnation 0 when asked for tick 20"),
    "another incarnation": (
        changed(incarnation=1),
        "answered for tick 20 as incarnation 1 when asked for",
    ),
}


def liar(lie: Lie) -> type[Robot]:
    """A robot that lies from one tick on if it is the liar."""

    class Liar(Robot):
        def step(self, percept: Percept) -> Action:
            action = super().step(percept)
            is_lie = self._briefing.robot == LIAR and percept.tick >= FIRST_TICK
            return lie(action) if is_lie else action

    return Liar


@pytest.mark.parametrize("name", LIES)
def test_a_robot_that_lies_is_fenced_and_nobody_else_is(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lie, why = LIES[name]
    monkeypatch.setattr(inline, "Robot", liar(lie))
    log_of(field(tmp_path, "clock.limit_s=4"), tmp_path / "lies.mcap")
    log = LogFile(tmp_path / "lies.mcap")
    assert log.summary is not None
    lost = {one["robot"]: one["why"] for one in log.summary["lost"]}
    assert lost.pop(LIAR).startswith(why)
    assert set(lost.values()) == {"did not arrive"}
    assert log.summary["ticks"] == 80
    said = [tick.tick for tick in log.ticks() if tick.get(f"out/{LIAR}") is not None]
    assert said == list(range(FIRST_TICK))
    monkeypatch.undo()
    assert replay(log).divergences == 0
