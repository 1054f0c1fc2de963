"""Every number of a scenario has a range, and whatever else stands there is one line with its key."""

import dataclasses
import types
import typing
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import pytest

from onehop.contracts.errors import ScenarioError
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.ranges import Range, out_of_range
from onehop.contracts.robot_entry import RobotEntry
from onehop.contracts.scenario import Scenario
from onehop.scenario import scenario_file

MISSION = """
name = "small"
[map]
width = 40
height = 40
[start]
x = 8
y = 8
[goal]
x = 30
y = 14
"""
NUMBERS = (
    "nan", "inf", "-inf", "-1", "0", "1e308", "-1e308", "5e-324", str(2**63), str(2**64), "9" * 4000,
    "9" * 5000,
)  # fmt: skip


def numbers(kind: type, path: str) -> Iterator[tuple[str, Range]]:
    """Key path and range of every number of a section, and of the sections within it."""
    hints = typing.get_type_hints(kind, include_extras=True)
    for field in dataclasses.fields(kind):
        yield from _numbers(hints[field.name], f"{path}{field.name}")


def _numbers(kind: Any, key: str) -> Iterator[tuple[str, Range]]:
    inner = typing.get_args(kind)
    if typing.get_origin(kind) is Annotated:
        yield key, next(mark for mark in inner[1:] if isinstance(mark, Range))
    elif typing.get_origin(kind) in (types.UnionType, typing.Union):
        yield from _numbers(inner[0], key)
    elif dataclasses.is_dataclass(kind):
        yield from numbers(typing.cast(type, kind), f"{key}.")
    else:
        assert kind not in (int, float), f"{key} has no range"


FAULT = dict(numbers(FaultSection, "faults."))
ENTRY = dict(numbers(RobotEntry, "robots."))
KEYS = dict(numbers(Scenario, "")) | FAULT | ENTRY


def read(folder: Path, key: str, value: str) -> None:
    """Read a mission with one number changed."""
    setting = f"{key}={value}"
    if key in FAULT:
        fault = {"kind": "'jam'", "at_s": "1", "radius": "1", key.removeprefix("faults."): value}
        setting = f"faults=[{{{', '.join(f'{name}={text}' for name, text in fault.items())}}}]"
    if key in ENTRY:
        name = key.removeprefix("robots.")
        setting = f"robots=[{{{'' if name == 'id' else 'id=1, '}{name}={value}}}]"
    path = folder / "small.toml"
    path.write_text(MISSION)
    scenario_file.load(path, [setting])


def test_the_walk_finds_the_numbers_of_every_section() -> None:
    with_numbers = {key.partition(".")[0] for key in KEYS}
    texts = {"name", "profile", "programs"}
    assert with_numbers == {field.name for field in dataclasses.fields(Scenario)} - texts


@pytest.mark.parametrize("value", NUMBERS, ids=lambda value: value[:6] + f"({len(value)})")
def test_a_number_out_of_range_is_one_line_that_names_its_key(tmp_path: Path, value: str) -> None:
    for key, limits in KEYS.items():
        if limits.least <= float(value) <= limits.most:
            continue
        with pytest.raises(ScenarioError) as refused:
            read(tmp_path, key, value)
        line = str(refused.value)
        assert key.rpartition(".")[2] in line, line
        assert "\n" not in line
        assert len(line) < 400


@pytest.mark.parametrize("key", sorted(KEYS))
def test_both_ends_of_a_range_are_read_or_clash_with_another_key_in_one_line(
    tmp_path: Path, key: str
) -> None:
    for end in KEYS[key]:
        refused = ""
        try:
            read(tmp_path, key, str(end))
        except ScenarioError as clash:
            refused = str(clash)
        assert "out of range" not in refused


def test_a_number_that_was_declared_without_a_range_is_a_mistake_of_ours() -> None:
    @dataclasses.dataclass
    class Section:
        length: float = 1.0

    with pytest.raises(TypeError, match="length is declared without a range"):
        list(out_of_range(Section()))


@pytest.mark.parametrize("name", ["a/../../x", "", "..", "x" * 201, "é" * 101, "-x", "a\u202eb"])
def test_a_name_that_is_no_name_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / "small.toml"
    path.write_text(MISSION.replace("small", name))
    with pytest.raises(ScenarioError, match=r"name: .* is no name; a letter or digit, then"):
        scenario_file.load(path)


@pytest.mark.parametrize("name", ["small", "a passage, and a block (2)", "Halle 7: Übung", "x" * 200])
def test_a_name_may_be_words(tmp_path: Path, name: str) -> None:
    path = tmp_path / "small.toml"
    path.write_text(MISSION.replace("small", name))
    assert scenario_file.load(path).scenario.name == name


def test_a_byte_order_mark_is_read_over(tmp_path: Path) -> None:
    path = tmp_path / "small.toml"
    path.write_bytes(b"\xef\xbb\xbf" + MISSION.encode())
    assert scenario_file.load(path).scenario.name == "small"


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"x = " + b"[" * 3000, "nested too deeply"),
        (b"x = " + b"9" * 5000, "a whole number of thousands of digits; whole numbers below"),
        (b"x = \xff", "not TOML"),
    ],
)
def test_what_no_toml_reader_takes_is_refused_in_one_line(
    tmp_path: Path, content: bytes, said: str
) -> None:
    path = tmp_path / "small.toml"
    path.write_bytes(content)
    with pytest.raises(ScenarioError) as refused:
        scenario_file.load(path)
    assert "\n" not in str(refused.value)
    assert str(path) in str(refused.value)
    assert said in str(refused.value)


@pytest.mark.parametrize("text", ["nan,2", "1e400,2", "-inf,0", "1", "1,2,3", "x,y"])
def test_a_point_is_two_finite_numbers(text: str) -> None:
    with pytest.raises(ScenarioError, match=r"--start .*: not a point"):
        scenario_file.point(text, "--start")
