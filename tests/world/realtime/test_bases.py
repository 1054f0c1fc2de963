"""Drivers of real bases in real time: the newest counts, what is wrong is dropped, silence is an end."""

import contextlib
from collections.abc import Callable, Iterator
from typing import Any

import msgpack
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onehop.contracts import topics
from onehop.contracts.geometry import STANDSTILL, Pose, Twist
from onehop.contracts.hardware import Drive, Measured, Taken
from onehop.contracts.messages import Presence, Truth
from onehop.maps.map_file import load_map
from onehop.wire.codec import decode, encode
from tests.world.test_bases import BEAMS, REAL, ROOM, scenario
from world_server.core.bases import Bases
from world_server.mailbox import MissionBrokenError
from world_server.realtime.bases import RealTimeBases

NAME = topics.base_name(REAL)


class House:
    """One base, and what it deals with. said: by key. briefings: how often they have been opened."""

    def __init__(self, silence_s: float = 60.0, hold_s: float = 60.0) -> None:
        self.said: list[tuple[str, bytes]] = []
        self.readers: dict[str, Callable[[bytes], None]] = {}
        self.present = {NAME}
        self.open = 0
        rules = Bases(scenario(), load_map(ROOM, {}))
        world: Any = self
        self.bases = RealTimeBases(world, world, world, rules, silence_s, hold_s, self.briefings)

    def publisher(self, key: str, **_: Any) -> Callable[[bytes], None]:
        return lambda data: self.said.append((key, data))

    def read(self, name: str, what: str, reader: Callable[[bytes], None]) -> None:
        self.readers[topics.by(name, what)] = reader

    def wait(self, done: Callable[[], bool], _: float) -> bool:
        return done()

    @contextlib.contextmanager
    def briefings(self) -> Iterator[None]:
        self.open += 1
        yield
        self.open -= 1

    def measure(self, x: float, number: int = 1, beams: int = BEAMS) -> None:
        scan = np.full(beams, 5.0, dtype=np.float32)
        self.put(encode(Measured(number, Pose(x, 5.0, 0.0), STANDSTILL, scan)))

    def put(self, data: bytes) -> None:
        self.readers[topics.by(NAME, topics.MEASURED)](data)

    def told(self) -> list[str]:
        told = topics.to(topics.OPERATOR, topics.TOLD)
        return [data.decode() for key, data in self.said if key == told]


def truth(*present: int) -> Truth:
    there = tuple(Presence(i, 0, Pose(0.0, 0.0, 0.0), STANDSTILL, False) for i in present)
    return Truth(7, 350_000_000, there, (), (), (), (), ())


def test_the_newest_measurement_counts_once_and_is_recorded_as_it_came() -> None:
    house = House()
    house.measure(3.0, 1)
    house.measure(3.1, 2)
    assert [(robot, one.number) for robot, one in house.bases.take().items()] == [(REAL, 2)]
    ((key, data),) = house.bases.record(8, 400_000_000)
    taken = decode(Taken, data)
    assert (key, taken.tick, taken.time_ns) == (f"base/{REAL}", 8, 400_000_000)
    assert taken.measured.pose == Pose(3.1, 5.0, 0.0)
    assert house.bases.take() == {}
    assert house.bases.record(9, 450_000_000) == []


@pytest.mark.parametrize(
    ("put", "why"),
    [
        (lambda house: house.measure(3.0, beams=90), "its scan has 90 ranges, the robot's laser 181"),
        (lambda house: house.measure(300.0), "(300.00, 5.00) is outside of the map, x from 0.00"),
        (lambda house: house.put(b"no"), "Measured: not msgpack"),
        (lambda house: house.put(msgpack.packb({"v": 3, "number": 1})), "Measured: Object missing"),
    ],
)
def test_what_is_wrong_is_dropped_and_told_once(put: Callable[[House], None], why: str) -> None:
    house = House()
    house.measure(3.0)
    house.bases.take()
    for _ in range(3):
        put(house)
        assert house.bases.take() == {}
    (line,) = house.told()
    assert line.startswith(f"{NAME}: a measurement is dropped: {why}")
    assert house.bases.fenced(truth(REAL)) == {}


@given(st.data())
@settings(deadline=None)
def test_bytes_that_are_altered_are_taken_or_dropped_and_nothing_else(data: st.DataObject) -> None:
    house = House()
    house.measure(3.0)
    house.bases.take()
    scan = np.full(BEAMS, 5.0, dtype=np.float32)
    wire = bytearray(encode(Measured(2, Pose(3.0, 5.0, 0.0), STANDSTILL, scan)))
    place = data.draw(st.integers(0, len(wire) - 1))
    wire[place] ^= data.draw(st.integers(1, 255))
    house.put(bytes(wire[: data.draw(st.sampled_from((place, len(wire))))]))
    taken = house.bases.take()
    assert len(taken) + len(house.told()) == 1
    assert "\n" not in "".join(house.told())


def test_who_measures_nothing_sound_for_too_long_leaves_and_is_told_why() -> None:
    house = House(silence_s=-1.0)  # any time is too long
    house.measure(3.0)
    house.bases.take()
    assert house.bases.fenced(truth(REAL)) == {REAL: "its base is silent for -1 s"}
    for _ in range(2):
        house.measure(3.0, beams=90)
        house.bases.take()
    why = "2 measurements were dropped, the last because its scan has 90 ranges, the robot's laser 181"
    assert house.bases.fenced(truth(REAL)) == {REAL: f"its base is silent for -1 s: {why}"}
    assert house.bases.fenced(truth(1)) == {}  # it has left already
    house.measure(3.0)
    house.bases.take()
    assert house.bases.fenced(truth(REAL)) == {REAL: "its base is silent for -1 s"}


def test_without_its_driver_a_robot_leaves_and_the_driver_may_come_again() -> None:
    house = House()
    house.measure(3.0)
    house.bases.take()
    assert house.bases.fenced(truth(REAL)) == {}
    assert house.open == 0
    house.present.clear()
    for _ in range(2):
        assert house.bases.fenced(truth(REAL)) == {REAL: "its base is gone"}
        assert house.open == 1
    house.present.add(NAME)
    assert house.bases.fenced(truth(1)) == {}
    assert house.open == 0


def test_a_base_is_told_by_what_to_drive_unless_its_measurement_is_old() -> None:
    for hold_s, told in ((60.0, Twist(0.5, -0.25)), (-1.0, STANDSTILL)):
        house = House(hold_s=hold_s)
        house.measure(3.0)
        house.bases.take()
        house.bases.drive(7, {REAL: Twist(0.5, -0.25)})
        ((key, data),) = house.said
        assert key == topics.to(NAME, topics.DRIVE)
        assert decode(Drive, data) == Drive(7, told)


def test_the_mission_waits_for_the_first_measurement_of_each() -> None:
    house = House()
    with pytest.raises(MissionBrokenError, match=r"^base-2 measured nothing within 30 s$"):
        house.bases.await_all()
    house.measure(3.0, beams=90)
    why = "within 30 s: one measurement was dropped, the last because its scan has 90 ranges"
    with pytest.raises(MissionBrokenError, match=why):
        house.bases.await_all()
    house.measure(3.0)
    house.bases.await_all()
    assert list(house.bases.take()) == [REAL]


def test_silence_counts_from_when_it_can_be_heard_again_and_it_does_not_drive_meanwhile(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now_s = [100.0]
    monkeypatch.setattr("world_server.realtime.bases.time.monotonic", lambda: now_s[0])
    house = House(silence_s=5.0, hold_s=0.5)
    house.measure(3.0)
    house.bases.take()
    now_s[0] = 108.0
    house.bases.excuse()
    assert house.bases.fenced(truth(REAL)) == {}
    house.bases.drive(7, {REAL: Twist(0.5, 0.0)})
    assert decode(Drive, house.said[-1][1]).twist == STANDSTILL
    now_s[0] = 113.5
    assert house.bases.fenced(truth(REAL)) == {REAL: "its base is silent for 5 s"}
