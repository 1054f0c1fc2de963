"""How the record of real time is put together, and what it costs when the recorder is slow."""

from collections.abc import Callable

import pytest

from onehop.contracts import topics
from onehop.contracts.geometry import Twist
from onehop.contracts.messages import Action, Heard, Inbox, Lateness, Reception
from onehop.wire.batch import unpack_ticks
from onehop.wire.codec import decode, encode
from world_server.realtime import recording
from world_server.realtime.recording import RealTimeRecording
from world_server.realtime.robots import Answers, Given

PERIOD = 50_000_000


class Wire:
    """What stands for bus and mailbox: keeps what is put, and passes on what is said to the world."""

    def __init__(self) -> None:
        self.put: list[bytes] = []
        self.readers: dict[str, Callable[[bytes], None]] = {}

    def publisher(self, *_: object, **__: object) -> Callable[[bytes], None]:
        return self.put.append

    def read(self, name: str, what: str, reader: Callable[[bytes], None]) -> None:
        self.readers[topics.by(name, what)] = reader

    def ticks(self) -> dict[int, dict[str, bytes]]:
        """Everything that was recorded."""
        return {tick: dict(messages) for data in self.put for tick, messages in unpack_ticks(data)}

    def acknowledge(self, tick: int) -> None:
        self.readers["from/recorder/recorded"](tick.to_bytes(8, "little"))


class World:
    """The world's side, with a robot 1 that answers."""

    def __init__(self) -> None:
        self.wire, self.lies = Wire(), []  # type: tuple[Wire, list[int]]
        self.recording = RealTimeRecording(self.wire, self.wire, PERIOD, self.lies.append)  # type: ignore[arg-type]

    def tick(self, tick: int, answers: int | None, heard: tuple[int, ...] = ()) -> None:
        """A tick begins and ends; robot 1 answers the observation of another."""
        self.recording.begin(tick, [("truth", b"truth %d" % tick)])
        given = {}
        if answers is not None:
            action = Action(answers, 0, Twist(0.0, 0.0), (), 0.0, 0.0, None, ())
            given[1] = Given(1, action, encode(action), heard)
        self.recording.end(tick, Answers(given))

    def account(self, tick: int, *numbers: int) -> None:
        """What the radio says of a tick: it has told robot 1 these."""
        told = [("rx/1", encode(Heard(number, _reception(number)))) for number in numbers]
        self.recording.take((tick, [("radio", b"record %d" % tick), *told]))


def _reception(number: int) -> Reception:
    return Reception(2, b"%d" % number, 0, number, 1, 1, 20.0, 0.0, 100)


def inbox(world: World, tick: int) -> Inbox:
    return decode(Inbox, world.wire.ticks()[tick]["rx/1"])


def test_an_inbox_has_what_went_into_the_action_beside_it_whenever_it_came() -> None:
    world = World()
    world.tick(0, 0, (1,))
    world.account(0, 1, 2, 3)
    world.tick(1, None)
    world.account(1, 4)
    world.tick(2, 1, (2, 3, 4))
    assert world.wire.put == []  # of tick 2 the radio has not told yet
    world.account(2, 5)
    world.recording.hand_over()
    ticks = world.wire.ticks()
    assert sorted(ticks) == [0, 1, 2]
    assert ticks[1].keys() == {"truth", "radio"}
    assert (inbox(world, 0).heard, inbox(world, 2).heard) == ((1,), (2, 3, 4))
    assert [one.payload for one in inbox(world, 2).receptions] == [b"2", b"3", b"4"]
    assert (inbox(world, 2).tick, inbox(world, 2).time_ns) == (1, PERIOD)
    assert world.lies == []


@pytest.mark.parametrize("heard", [(7,), (2, 1), (1, 1), (-3,)])
def test_a_robot_that_names_what_it_was_not_given_is_told_of(heard: tuple[int, ...]) -> None:
    world = World()
    world.tick(0, 0, heard)
    world.account(0, 1, 2)
    assert world.lies == [1]


def test_a_late_tick_has_its_lateness_beside_its_truth() -> None:
    world = World()
    world.recording.begin(0, [("truth", b"")])
    world.recording.note_late(0, 0.031)
    world.recording.end(0, Answers())
    world.account(0)
    world.recording.hand_over()
    assert decode(Lateness, world.wire.ticks()[0]["late"]) == Lateness(0, 0, 31_000_000)


def test_a_recorder_that_is_behind_gets_no_more_than_fits_and_then_all_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(recording, "UNDER_WAY_BYTES", 50)
    world = World()
    for tick in range(30):
        world.tick(tick, None)
        world.account(tick)
    assert max(world.wire.ticks()) < 12
    for _ in range(10):
        world.wire.acknowledge(max(world.wire.ticks()))
    world.recording.hand_over()
    assert sorted(world.wire.ticks()) == list(range(30))
    assert world.recording.left_out == 0


def test_what_does_not_fit_into_the_worlds_memory_is_left_out_and_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(recording, "UNDER_WAY_BYTES", 50)
    monkeypatch.setattr(recording, "WAITING_BYTES", 200)
    world = World()
    for tick in range(30):
        world.tick(tick, None)
        world.account(tick)
    world.recording.hand_over()
    ticks = sorted(world.wire.ticks())
    assert world.recording.left_out == 30 - len(ticks) > 0
    assert ticks == list(range(len(ticks)))
