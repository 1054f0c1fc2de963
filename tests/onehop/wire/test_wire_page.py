"""docs/wire.md says what the code does: layouts, keys, rights, session, bytes, digest."""

import dataclasses
import hashlib
import json
import re
import struct
from collections.abc import Mapping
from enum import EnumMeta
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import msgspec
import pytest

from onehop.contracts import briefings, messages, realtime, sections, team, topics
from onehop.contracts.arrays import Ranges
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.neighbour import Neighbour
from onehop.contracts.printable import LONGEST
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.values import WIRE_VERSION, Wire
from onehop.node import bus, parts, startup
from onehop.node.identity import session_id
from onehop.node.rights import rights
from onehop.wire.codec import decode, encode
from onehop.wire.journal import Digest, Journal
from onehop.wire.spoken import failed
from world_server.briefings import ANSWERS
from world_server.process import START_S

PAGE = (Path(__file__).parents[3] / "docs" / "wire.md").read_text()

LAYOUTS: dict[str, type] = {
    "Observation": messages.Observation,
    "Pose": Pose,
    "Twist": Twist,
    "Inbox": messages.Inbox,
    "Heard": realtime.Heard,
    "Acted": realtime.Acted,
    "Reception": messages.Reception,
    "Neighbour": Neighbour,
    "Action": messages.Action,
    "Transmission": messages.Transmission,
    "Note": messages.Note,
    "Status": team.Status,
    "Briefing": briefings.Briefing,
    "Goal": sections.GoalSection,
    "Body": sections.RobotSection,
}
"""The page's name of each map that has a table."""

SCALARS = {int: "int", float: "float", str: "str", bytes: "bin", bool: "bool", NoneType: "nil"}
NAMES = {kind: name for name, kind in LAYOUTS.items()} | {
    sections.TeamSection: "Team",
    sections.GainsSection: "Gains",
    sections.PlannerSection: "Planner",
    RadioSection: "Radio",
}


def in_words(kind: Any) -> str:
    """A field's type as the page writes it."""
    origin, inner = get_origin(kind), get_args(kind)
    if kind is Any:
        return "any"
    if kind == Ranges:
        return "bin"
    if origin is Annotated:
        return in_words(inner[0])
    if origin is Literal or isinstance(kind, EnumMeta):
        return "str"
    if origin in (Union, UnionType):
        return " or ".join(map(in_words, inner))
    if origin is tuple:
        return f"[{in_words(inner[0])}]"
    if origin is dict:
        return f"{{{in_words(inner[0])}: {in_words(inner[1])}}}"
    return SCALARS.get(kind) or NAMES[kind]


def layout(kind: type) -> list[tuple[str, str]]:
    """Fields and types of a map, in their order on the wire."""
    if kind is briefings.Briefing:  # what the free table of parameters is on the wire
        hints: Mapping[str, Any] = get_type_hints(kind, include_extras=True) | {
            "parameters": dict[str, Any]
        }
    else:
        hints = get_type_hints(kind, include_extras=True)
    names = (
        [one.name for one in dataclasses.fields(kind)]
        if dataclasses.is_dataclass(kind)
        else [one.encode_name for one in msgspec.structs.fields(kind)]
    )
    rows = [(name, in_words(hints[name])) for name in names]
    return [("v", "int"), *rows] if issubclass(kind, Wire) else rows


def tables(page: str) -> dict[str, list[tuple[str, str]]]:
    """Name, type of every field in the page's tables, by heading."""
    found = {}
    for name, text in re.findall(r"^### (\w+)\n\n(\|.*?)\n\n", page, flags=re.M | re.S):
        rows = [line.split(" | ") for line in text.splitlines()[2:]]
        found[name] = [(row[0].strip("| `"), row[1].strip()) for row in rows]
    return found


def section(heading: str) -> str:
    return PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]


@pytest.mark.parametrize("name", LAYOUTS)
def test_the_page_has_every_field_in_its_order_with_its_type(name: str) -> None:
    assert tables(PAGE)[name] == layout(LAYOUTS[name])


def test_the_page_has_no_other_tables() -> None:
    assert tables(PAGE).keys() == LAYOUTS.keys()


@pytest.mark.parametrize(
    ("what", "instead"),
    [
        ("| `incarnation` | int | of the briefing |\n", ""),
        ("| `hops` | int | over", "| `hops` | float | over"),
        ("| `speed` | float |", "| `pace` | float |"),
        ("| `x` | float | map frame [m] |\n| `y` | float |", "| `y` | float | - |\n| `x` | float |"),
    ],
)
def test_a_page_that_is_wrong_is_found_out(what: str, instead: str) -> None:
    assert what in PAGE
    assert tables(PAGE.replace(what, instead, 1)) != {n: layout(kind) for n, kind in LAYOUTS.items()}


def test_words_of_a_team_are_listed() -> None:
    for words in (team.Mode, team.Shape):
        assert ", ".join(f"`{word}`" for word in words) in PAGE


def test_the_keys_are_those_of_a_robot() -> None:
    name = topics.robot_name(5)
    said = re.findall(r"^\| `(\S+)` \|", section("What is said"), flags=re.M)
    hears = (
        *(topics.PERCEPT, topics.OBSERVATION, topics.HEARD),
        *(topics.STOP, topics.WAKE, topics.KILL, topics.END),
    )
    puts = (topics.ARRIVAL, topics.OUT, topics.ACTED, topics.AWAKE, topics.FAILED)
    assert said == [topics.to(name, one) for one in hears] + [topics.by(name, one) for one in puts]
    for key in (topics.to("robot-", topics.PERCEPT), topics.by("robot-", topics.PART)):
        assert key.partition("robot-")[0] in PAGE


def test_the_rights_are_those_of_the_router() -> None:
    may = rights(topics.robot_name(5))
    rows = re.findall(r"^\| (put|subscribe|query|declare alive|watch) \| (.*) \|$", PAGE, flags=re.M)
    granted = {
        "put": list(may.puts),
        "subscribe": [may.hears],
        "query": [may.asks],
        "declare alive": [may.announces],
        "watch": list(may.watches),
    }
    assert {what: re.findall(r"`(.*?)`", keys) for what, keys in rows} == granted


def test_the_session_is_opened_as_our_own_robots_open_it(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: dict[str, Any] = {}

    class Nothing:
        def __getattr__(self, _: str) -> Any:
            return lambda *_, **__: None

    def take(settings: Mapping[str, Any]) -> Any:
        opened.update({**bus.QUIET, **settings})
        return Nothing()

    monkeypatch.setattr(bus, "_open", take)
    bus.open_client("m", "ENDPOINT", "robot-5", "PASSWORD")
    (text,) = re.findall(r"```json\n(.*?)```", PAGE, flags=re.S)
    session = json.loads(text.replace("NAME", "robot-5"))
    digits = hashlib.sha256(b"PASSWORD").hexdigest()[:31]
    assert session.pop("id") == "SESSION"
    assert opened["id"] == f"1{digits}"
    assert session == {key: opened[key] for key in session}


def test_the_numbers_are_those_of_the_code() -> None:
    assert f"now **{WIRE_VERSION}**" in PAGE
    assert f"longer than {parts.PART_BYTES:,} bytes" in PAGE
    assert f"up to {startup.BRIEFING_TIMEOUT_S:g} s" in PAGE
    assert f"answers each process {ANSWERS} times" in PAGE
    assert f"have {START_S:g} s to get so far" in PAGE
    assert f"a lease ({bus.LEASE_MS / 1000:g} s)" in PAGE
    assert f"waits {startup.REUNION_S:g} s" in PAGE
    assert f"some {LONGEST - len(failed(''))} letters" in PAGE
    assert f"exit with status {startup.PROGRAM_FAILED}" in PAGE
    assert f"{startup.WORLD_IS_GONE}: the world has gone" in PAGE
    assert f"`{startup.PASSWORD_VARIABLE}`" in PAGE
    assert session_id("x") == "1" + hashlib.sha256(b"x").hexdigest()[:31]


def test_the_example_is_the_action_that_it_says_it_is() -> None:
    (digits,) = re.findall(r"```\n([0-9a-f\n]+)```", PAGE)
    action = decode(messages.Action, bytes.fromhex(digits))
    assert encode(action).hex() == digits.replace("\n", "")
    hi = messages.Transmission(messages.BROADCAST, b"hi", 2, 0)
    assert action == messages.Action(300, 0, Twist(0.5, 0.0), (hi,), 0.5, 12.0, None, ())


def test_the_digest_is_made_as_the_page_says() -> None:
    ticks = {0: [("out/2", b"c"), ("truth", b"a"), ("rx/10", b""), ("rx/2", b"b")], 7: [("radio", b"d")]}
    sha = hashlib.sha256()
    for tick, key, data in (
        (0, "truth", b"a"), (0, "rx/2", b"b"), (0, "rx/10", b""), (0, "out/2", b"c"), (7, "radio", b"d"),
    ):  # fmt: skip
        sha.update(struct.pack("<QI", tick, len(data)) + key.encode() + data)
    journal = Journal(lambda _, __: None)
    for tick, said in ticks.items():
        journal.add(tick, said)
    assert journal.digest() == sha.hexdigest() != Digest().hex()
