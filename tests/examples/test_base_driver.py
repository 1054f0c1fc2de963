"""The example of a base's driver, and its fake base: when it drives, when it rests, what it measures."""

import ast
import importlib
import math
import struct
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import msgpack
import pytest

from onehop.contracts.geometry import STANDSTILL, Pose, Twist
from onehop.contracts.hardware import Drive, Measured, wrong_measurement
from onehop.contracts.sections import RobotSection
from onehop.wire.codec import decode, encode

EXAMPLES = Path(__file__).parents[2] / "examples"
BODY = asdict(RobotSection())


class Clock:
    """Time that passes when somebody waits."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def monotonic(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def load(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], Any]]:
    """An example by its name, going by our clock."""
    monkeypatch.syspath_prepend(str(EXAMPLES))

    def loaded(name: str) -> ModuleType:
        module = importlib.import_module(name)
        monkeypatch.setattr(module, "time", clock)
        return module

    yield loaded
    for name in ("base_driver", "fake_base"):
        sys.modules.pop(name, None)


class Script:
    """A bus on which is said what a test says, each at its time [s]; then the mission is over."""

    def __init__(self, clock: Clock, *said: tuple[float, str, bytes]) -> None:
        self._clock = clock
        self._said = [*said]
        self.measured: list[Any] = []
        self.bus = SimpleNamespace(heard_by=self._heard_by, measured=self.measured.append)

    def _heard_by(self, deadline: float) -> tuple[str, bytes] | None:
        if self._said and 100.0 + self._said[0][0] <= deadline:
            at_s, what, data = self._said.pop(0)
            self._clock.now_s = max(self._clock.now_s, 100.0 + at_s)
            return what, data
        self._clock.now_s = max(self._clock.now_s, deadline)
        return None


class Wheels:
    """A base that stands at (1, 2); driven: when [s], and by what."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.driven: list[tuple[float, float, float]] = []

    def read(self) -> tuple[tuple[float, float, float], tuple[float, float], list[float]]:
        return (1.0, 2.0, 4.0), (0.0, 0.0), [1.0, math.inf]

    def drive(self, v: float, w: float) -> None:
        self.driven.append((round(self._clock.now_s - 100.0, 3), v, w))

    def by(self, at_s: float) -> tuple[float, float]:
        """By what it drives at an instant."""
        return next(((v, w) for when, v, w in reversed(self.driven) if when <= at_s), (0.0, 0.0))


def drive(v: float, w: float) -> bytes:
    return encode(Drive(0, Twist(v, w)))


def test_it_drives_as_it_is_told_and_rests_when_nothing_more_comes(load: Any, clock: Clock) -> None:
    driver, base = load("base_driver"), Wheels(clock)
    commands = [(0.1 * k, "drive", drive(0.5, -0.1 * k)) for k in range(1, 6)]
    script = Script(clock, *commands, (3.0, "end", b""))
    assert driver.serve(script.bus, base) == 0
    assert [base.by(0.1 * k + 0.001) for k in range(1, 6)] == [(0.5, -0.1 * k) for k in range(1, 6)]
    assert base.by(0.5 + driver.DEADMAN_S - 0.05) == (0.5, -0.5)
    assert base.by(0.5 + driver.DEADMAN_S + 1.5 / driver.RATE_HZ) == (0.0, 0.0)


def test_at_the_end_the_base_rests(load: Any, clock: Clock) -> None:
    driver, base = load("base_driver"), Wheels(clock)
    script = Script(clock, (0.1, "drive", drive(0.5, 0.2)), (0.2, "end", b""))
    assert driver.serve(script.bus, base) == 0
    assert base.by(0.15) == (0.5, 0.2)
    assert base.driven[-1] == (0.2, 0.0, 0.0)


def test_without_a_world_the_base_rests_at_once_until_one_is_there(load: Any, clock: Clock) -> None:
    driver, base = load("base_driver"), Wheels(clock)
    said = [(0.1, "drive", drive(0.5, 0.2)), (0.2, "world is gone", b"")]
    back = [(5.0, "world is there", b""), (5.2, "drive", drive(0.3, 0.0)), (5.3, "world is gone", b"")]
    assert driver.serve(Script(clock, *said, *back).bus, base) == 3
    assert base.by(0.15) == (0.5, 0.2)
    assert {base.by(0.2 + 1.5 / driver.RATE_HZ), base.by(1.0), base.by(5.1)} == {(0.0, 0.0)}
    assert base.by(5.25) == (0.3, 0.0)
    assert clock.now_s - 100.0 == pytest.approx(5.3 + driver.REUNION_S, abs=0.1)
    assert base.driven[-1][1:] == (0.0, 0.0)


def test_whatever_goes_wrong_the_base_rests(load: Any, clock: Clock) -> None:
    driver, base = load("base_driver"), Wheels(clock)
    script = Script(clock, (0.1, "drive", drive(0.5, 0.2)), (0.2, "drive", msgpack.packb({"v": 99})))
    with pytest.raises(SystemExit, match="the world speaks version 99 of the wire"):
        driver.serve(script.bus, base)
    assert base.driven[-1][1:] == (0.0, 0.0)


def test_it_says_what_it_measures_as_the_contracts_have_it(load: Any, clock: Clock) -> None:
    driver, base = load("base_driver"), Wheels(clock)
    script = Script(clock, (1.0, "end", b""))
    driver.serve(script.bus, base)
    said = [decode(Measured, data) for data in script.measured]
    assert [one.number for one in said] == list(range(1, len(said) + 1))
    assert abs(len(said) - driver.RATE_HZ) <= 1
    one = said[-1]
    assert (one.pose, one.twist) == (Pose(1.0, 2.0, 4.0 - math.tau), STANDSTILL)
    assert one.scan.tobytes() == struct.pack("<2f", 1.0, math.inf)
    assert wrong_measurement(one, 2) is None


def test_the_driver_knows_nothing_of_onehop() -> None:
    for name, known in (("base_driver", {"zenoh", "msgpack", "fake_base"}), ("fake_base", {"numpy"})):
        tree = ast.parse((EXAMPLES / f"{name}.py").read_text())
        names = [one.names[0].name for one in ast.walk(tree) if isinstance(one, ast.Import)]
        names += [one.module or "" for one in ast.walk(tree) if isinstance(one, ast.ImportFrom)]
        assert {one.partition(".")[0] for one in names} - sys.stdlib_module_names == known


def fake(load: Any, start: str) -> Any:
    return load("fake_base").FakeBase(BODY, str(EXAMPLES / "hardware.toml"), start)


def test_the_fake_base_sees_its_room(load: Any) -> None:
    _, _, ranges = fake(load, "3,4,180").read()
    assert len(ranges) == BODY["laser_beams"]
    assert ranges[90] == pytest.approx(3.0, abs=0.1)  # the wall x = 0 is ahead
    assert ranges[180] == pytest.approx(4.0, abs=0.1)  # and y = 0 to its left
    assert math.isinf(fake(load, "3,4,0").read()[2][90])  # 23 m to the other one


def test_the_fake_base_drives_with_lag_and_slip_and_stops_at_a_wall(load: Any, clock: Clock) -> None:
    base = fake(load, "5,4,0")
    base.drive(1.0, 0.0)
    clock.now_s += 0.05
    assert 0.0 < base.read()[1][0] < 0.5
    clock.now_s += 1.95
    (x, y, heading), (v, w), _ = base.read()
    assert 5.0 + 1.7 < x < 5.0 + 1.95
    assert 0.9 < v < 1.0
    assert (abs(w) > 0.01, abs(heading) > 0.01, abs(y - 4.0) > 0.02) == (True, True, True)  # it drifts
    clock.now_s += 60.0
    x, y, _ = base.read()[0]
    assert BODY["radius"] - 0.05 < x < 26.0 - BODY["radius"] + 0.05
    assert BODY["radius"] - 0.05 < y < 16.0 - BODY["radius"] + 0.05
