"""A robot whose action breaks a limit is fenced by name; the others, and the log, are none the worse."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from onehop.contracts.briefings import Briefing
from onehop.drivers.replay import replay
from onehop.robot import BROADCAST, Action, Note, Percept, Transmission, Twist
from onehop.wire.log_reader import LogFile
from robot_agent.core.robot import Robot
from tests.onehop.scenes import field, log_of

LIAR = 3
FIRST_TICK = 20

NONE: tuple[dict[str, Any], str] = ({}, "")

LIES: dict[str, tuple[dict[str, Any], str]] = {
    "a twist that is no number": ({"twist": Twist(math.nan, 0.0)}, "twist.v is nan, not a number"),
    "a twist without end": ({"twist": Twist(0.0, math.inf)}, "twist.w is inf, not a number"),
    "a frame that holds the air for ever": (
        {"outbox": (Transmission(BROADCAST, b"", 2**40, 0),)},
        "a message of 1099511627776 bytes on the air",
    ),
    "a broadcast of 60 kB": (
        {"outbox": (Transmission(BROADCAST, bytes(60_000), 60_000, 0),)},
        "a message of 60000 bytes on the air",
    ),
    "100,000 messages": (
        {"outbox": (Transmission(1, b"", 10, 0),) * 1000},
        "1000 messages in a tick; 80 may be sent",
    ),
    "more bytes than all limits allow": (
        {"outbox": (Transmission(1, b"", 10, 0),) * 100_000},
        "put no action: ",
    ),
    "notes that nobody should see": (
        {"notes": (Note("\x1b[2J", {}),)},
        "a note whose kind is no word",
    ),
    "values without end": ({"values": {"level": math.inf}}, "values.level is inf, not a number"),
    "values with a name that is none": ({"values": {"<b>": 1.0}}, "a value whose name is no word"),
    "many values": ({"values": {f"v{n}": 1.0 for n in range(33)}}, "33 values in a tick; 32"),
}


@dataclass(frozen=True)
class Parameters:
    lie: str = "none"


class Liar(Robot):
    """A robot of the team that lies from one tick on."""

    Parameters = Parameters

    def __init__(self, briefing: Briefing) -> None:
        super().__init__(briefing)
        self._lie, _ = LIES.get(briefing.parameters.lie, NONE)

    def step(self, percept: Percept) -> Action:
        action = super().step(percept)
        return replace(action, **self._lie) if percept.tick >= FIRST_TICK else action


@pytest.mark.parametrize("name", LIES)
def test_a_robot_that_lies_is_fenced_and_nobody_else_is(name: str, tmp_path: Path) -> None:
    program = "tests.onehop.drivers.test_lies:Liar"
    liar = f'robots=[{{id={LIAR}, parameters={{lie="{name}"}}}}]'
    bundle = field(tmp_path, "clock.limit_s=4", f"team.program={program}", liar)
    log_of(bundle, tmp_path / "lies.mcap")
    log = LogFile(tmp_path / "lies.mcap")
    assert log.summary is not None
    lost = {one["robot"]: one["why"] for one in log.summary["lost"]}
    assert lost.pop(LIAR).startswith(LIES[name][1])
    assert set(lost.values()) == {"did not arrive"}
    assert log.summary["ticks"] == 80
    said = [tick.tick for tick in log.ticks() if tick.get(f"out/{LIAR}") is not None]
    assert said == list(range(FIRST_TICK))
    assert replay(log).divergences == 0
