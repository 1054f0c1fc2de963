"""What the world says to the radio, and says again when it may have been lost."""

from collections.abc import Callable
from typing import Any

import pytest

from onehop.contracts import topics
from onehop.contracts.messages import Truth
from onehop.contracts.realtime import Placed
from onehop.wire.batch import pack_tick
from onehop.wire.codec import decode
from world_server.mailbox import MissionBrokenError
from world_server.realtime.radio import RealTimeRadio
from world_server.realtime.schedule import Schedule

SILENCE_S = 10.0


class Air:
    """Everyone that the world's side of the radio deals with. placed: ticks of truths that were put."""

    def __init__(self) -> None:
        self.placed: list[int] = []
        self.readers: dict[str, Callable[[bytes], None]] = {}
        self.come_back: Callable[[], None] = lambda: None
        self.present = {topics.RADIO}
        self.taken: list[int] = []
        world: Any = self
        schedule = Schedule(0.05, 1.0)
        self.radio = RealTimeRadio(
            world, world, world, schedule, lambda said: self.taken.append(said[0]), SILENCE_S
        )

    def publisher(self, _: str) -> Callable[[bytes], None]:
        return lambda data: self.placed.append(decode(Placed, data).truth.tick)

    def read(self, name: str, what: str, reader: Callable[[bytes], None]) -> None:
        self.readers[topics.by(name, what)] = reader

    def when_present(self, _: str, act: Callable[[], None]) -> None:
        self.come_back = act

    def account(self, tick: int) -> None:
        self.readers["from/radio/carried"](pack_tick(tick, []))


def truth(tick: int) -> Truth:
    return Truth(tick, tick * 50_000_000, (), (), (), (), (), ())


def test_a_radio_that_comes_back_gets_the_truths_again_of_which_it_has_given_no_account() -> None:
    air = Air()
    for tick in range(4):
        air.radio.place(truth(tick))
    air.account(0)
    air.account(1)
    air.placed.clear()
    air.come_back()
    assert air.placed == [2, 3]


def test_time_in_which_nobody_could_be_heard_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = [100.0]
    monkeypatch.setattr("world_server.realtime.radio.time.monotonic", lambda: now_s[0])
    air = Air()
    air.radio.place(truth(0))
    now_s[0] += 15.0
    air.radio.excuse()
    air.radio.place(truth(1))
    now_s[0] += 15.0
    with pytest.raises(MissionBrokenError, match="the radio is silent for 10 s"):
        air.radio.place(truth(2))
