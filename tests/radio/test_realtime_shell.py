"""The radio's shell in real time: how far ahead of the world it goes, and what comes to it twice."""

from collections.abc import Callable, Sequence
from typing import Any

import pytest

from onehop.contracts import topics
from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.messages import BROADCAST, RadioRecord, TransmitRequest
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.realtime import Handed, Placed
from onehop.node.bus import ALIVE, GONE
from onehop.node.startup import REUNION_S, WORLD_IS_GONE
from onehop.wire.batch import unpack_tick
from onehop.wire.codec import decode, encode
from radio_proxy.core.bounds import make_radio
from radio_proxy.realtime import AHEAD_TICKS, RealTimeRadio
from tests.radio.missions import PERIOD, Mission, line, message

Said = tuple[float, str, bytes]
"""When something comes to the radio [s], and what."""

WORLD = topics.alive(topics.WORLD)


class Bus:
    """Gives what is said when it is due, by a clock of its own. accounts: of which ticks, in order."""

    def __init__(self, said: Sequence[Said], monkeypatch: pytest.MonkeyPatch) -> None:
        self._said = list(said)
        self._now_s = 100.0
        self._begun_s = self._now_s
        self.accounts: list[tuple[int, RadioRecord]] = []
        monkeypatch.setattr("radio_proxy.realtime.time.monotonic", lambda: self._now_s)

    def publisher(self, key: str, **_: Any) -> Callable[[bytes], None]:
        return self._on_carried if key.endswith(topics.CARRIED) else lambda _: None

    def _on_carried(self, data: bytes) -> None:
        tick, messages = unpack_tick(data)
        self.accounts.append((tick, decode(RadioRecord, dict(messages)[topics.RADIO_RECORD])))

    def receive_by(self, deadline_s: float) -> tuple[str, bytes] | None:
        if self._said and self._begun_s + self._said[0][0] <= deadline_s:
            at_s, what, data = self._said.pop(0)
            self._now_s = max(self._now_s, self._begun_s + at_s)
            return what, data
        self._now_s = deadline_s
        return None


def serve(bus: Any) -> int:
    radio = make_radio(RadioBriefing(7, PERIOD, (1, 2, 3), RadioSection(), ()))
    return RealTimeRadio(bus, radio, (1, 2, 3), 1.0, PERIOD).serve()


def placed(tick: int, at_s: float, anchor: int = 0) -> Said:
    truths = Mission(line(3, 20.0), RadioSection())
    truths.tick = tick
    return at_s, topics.PLACED, encode(Placed(tick * PERIOD, anchor, truths.truth({})))


def handed(at_s: float) -> Said:
    request = TransmitRequest(1, 1.0, 5.0, (message(BROADCAST, 100),))
    return at_s, topics.HANDED, encode(Handed(round(1e9 * at_s), request))


END: Said = (9.0, topics.END, b"")


def test_while_the_world_is_late_the_radio_stays_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else the air would stand still until the world, which has set its clock back, were as far."""
    bus = Bus([placed(0, 0.0), handed(5.0), placed(1, 5.1, 1), placed(2, 5.15, 1), END], monkeypatch)
    assert serve(bus) == 0
    (_, first), (_, second) = bus.accounts
    assert first.intake is not None
    assert second.intake is not None
    assert [one.at_ns for one in first.intake.handed] == [AHEAD_TICKS * PERIOD]
    assert first.intake.until_ns == AHEAD_TICKS * PERIOD
    assert second.intake.until_ns == AHEAD_TICKS * PERIOD


def test_a_truth_that_comes_again_brings_the_account_before_it_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    said = [placed(0, 0.0), placed(1, 0.05), placed(0, 1.0), placed(1, 1.0), placed(2, 1.0), END]
    bus = Bus(said, monkeypatch)
    assert serve(bus) == 0
    assert [tick for tick, _ in bus.accounts] == [0, 0, 1]
    assert bus.accounts[0] == bus.accounts[1]


def test_the_world_may_be_away_for_a_while(monkeypatch: pytest.MonkeyPatch) -> None:
    back = [(1.0, WORLD, GONE), (0.9 * REUNION_S, WORLD, ALIVE), (3.0 * REUNION_S, topics.END, b"")]
    assert serve(Bus([placed(0, 0.0), *back], monkeypatch)) == 0
    gone = [(1.0, WORLD, GONE), (1.1 + REUNION_S, WORLD, ALIVE)]
    assert serve(Bus([placed(0, 0.0), *gone], monkeypatch)) == WORLD_IS_GONE
