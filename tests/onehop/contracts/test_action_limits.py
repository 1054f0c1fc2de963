"""What a robot may say: every field has a limit, and an action that breaks one is told which."""

import math
from collections.abc import Iterator
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.contracts.action_limits import MSDU_BYTES, NOTE_TEXT, NOTE_VALUES, NOTES, ActionLimits
from onehop.contracts.geometry import Twist
from onehop.contracts.messages import BROADCAST, Action, Note, Transmission
from onehop.contracts.sections import MOST_ROBOTS
from onehop.contracts.serial_numbers import LIMIT
from onehop.contracts.team import Mode, Shape, Status
from onehop.wire.codec import encode

TEAM = (1, 2, 3, 4, 5, 6)
LIMITS = ActionLimits(TEAM)
STATUS = Status(Mode.BORDER, 3, 4, TEAM, Shape.HEXAGON, 5e5, 5e5, 1.0, 0.3, 3.0, 4.0)
ACTION = Action(7, 1, Twist(1.0, -0.2), (), 1.0, 30.0, STATUS, ())
WORST = (math.nan, math.inf, -math.inf, 1e308, -1e308)


def breach(action: Action) -> str | None:
    return LIMITS.breach(action, 7, 1)


def saying(**changes: Any) -> str | None:
    """The breach of an action with other fields, or with other fields of its status."""
    own = {name: changes.pop(name) for name in list(changes) if name in Action.__struct_fields__}
    status = msgspec.structs.replace(STATUS, **changes)
    return breach(msgspec.structs.replace(ACTION, status=status, **own))


def with_a_bad_number(value: Any) -> Iterator[tuple[str, Any]]:
    """A value with each of its floats replaced in turn, however deep it lies."""
    for field in msgspec.structs.fields(value):
        inner = getattr(value, field.name)
        if isinstance(inner, msgspec.Struct):
            for path, changed in with_a_bad_number(inner):
                yield f"{field.name}.{path}", msgspec.structs.replace(value, **{field.name: changed})
        elif field.type is float:
            for bad in WORST:
                yield field.name, msgspec.structs.replace(value, **{field.name: bad})


def test_an_ordinary_action_keeps_the_limits() -> None:
    assert breach(ACTION) is None


def test_no_number_of_an_action_may_be_infinite_or_none_at_all() -> None:
    found = list(with_a_bad_number(ACTION))
    assert len(found) == 10 * len(WORST)
    for name, action in found:
        said = breach(action)
        assert said is not None
        assert said.startswith(f"{name} is ")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"speed": -0.1}, "speed is -0.1, not a number from 0 to 1e+09"),
        ({"remaining_distance": -1.0}, "remaining_distance is -1.0"),
        ({"error": -1.0}, "status.error is -1.0"),
        ({"throughput_bps": -2.0}, "status.throughput_bps is -2.0, not a number from -1 to"),
        ({"epoch": LIMIT}, "status.epoch is 4294967296"),
        ({"epoch": -1}, "status.epoch is -1"),
        ({"leader": 7}, "status.leader is 7, no robot of the team"),
        ({"members": ()}, "status.members are not robots of the team"),
        ({"members": (1, 2, 7)}, "status.members are not robots of the team"),
        ({"members": (2, 1)}, "status.members are not in rising order"),
        ({"members": (1, 1)}, "status.members are not in rising order"),
        ({"tick": 8}, "answered for tick 8 as incarnation 1 when asked for tick 7 as incarnation 1"),
        ({"incarnation": 0}, "answered for tick 7 as incarnation 0 when asked for"),
    ],
)
def test_what_is_out_of_its_range_is_named(changes: dict[str, Any], said: str) -> None:
    assert (saying(**changes) or "").startswith(said)


def test_a_robot_that_joins_may_have_no_leader() -> None:
    assert saying(leader=0, members=(3,)) is None


@pytest.mark.parametrize(
    ("transmission", "said"),
    [
        (
            Transmission(2, b"", 2**40, 0),
            "a message of 1099511627776 bytes on the air; a frame carries 2304",
        ),
        (Transmission(2, b"", -1, 0), "a message of -1 bytes"),
        (Transmission(2, b"", 10, -1), "a message that lives for -1 ns"),
        (Transmission(2, b"", 10, 2**63), "a message that lives for 9223372036854775808 ns"),
        (Transmission(BROADCAST, bytes(60_000), 60_000, 0), "a message of 60000 bytes"),
        (Transmission(2, b"four", 3, 0), "a payload of 4 bytes in 3 bytes on the air"),
        (Transmission(-1, b"", 10, 0), "a message to robot -1"),
        (Transmission(2**63, b"", 10, 0), "a message to robot 9223372036854775808"),
    ],
)
def test_a_message_that_no_frame_carries_is_named(transmission: Transmission, said: str) -> None:
    assert (saying(outbox=(transmission,)) or "").startswith(said)


def test_the_longest_message_is_carried() -> None:
    assert saying(outbox=(Transmission(BROADCAST, bytes(MSDU_BYTES), MSDU_BYTES, 0),)) is None


def test_a_broadcast_counts_once_for_each_other_robot() -> None:
    one, all_of_them = Transmission(2, b"", 10, 0), Transmission(BROADCAST, b"", 10, 0)
    assert LIMITS.messages == 88
    assert saying(outbox=(one,) * 88) is None
    assert saying(outbox=(one,) * 89) == "89 messages in a tick; 88 may be sent"
    assert saying(outbox=(all_of_them,) * 17 + (one,) * 3) is None
    assert saying(outbox=(all_of_them,) * 17 + (one,) * 4) == "89 messages in a tick; 88 may be sent"


@given(st.lists(st.sampled_from((BROADCAST, 2, 5)), max_size=200), st.integers(1, 12))
def test_what_fits_is_the_longest_beginning_that_may_be_sent(to: list[int], robots: int) -> None:
    limits = ActionLimits(range(1, robots + 1))
    outbox = [Transmission(robot, b"x", 10, 0) for robot in to]
    status = msgspec.structs.replace(STATUS, leader=1, members=(1,))

    def is_sent(messages: list[Transmission]) -> bool:
        changed = msgspec.structs.replace(ACTION, outbox=tuple(messages), status=status)
        return limits.breach(changed, 7, 1) is None

    fitting = limits.fitting(outbox)
    assert fitting == outbox[: len(fitting)]
    assert is_sent(fitting)
    assert len(fitting) == len(outbox) or not is_sent(outbox[: len(fitting) + 1])


@pytest.mark.parametrize(
    ("note", "said"),
    [
        (Note("<b>", {}), "a note whose kind is no word"),
        (Note("a" * 33, {}), "a note whose kind is no word"),
        (Note("", {}), "a note whose kind is no word"),
        (Note("mode", {"a\x1b[2J": 1}), "a note mode with more than 8 values, or one without a name"),
        (Note("mode", {f"v{i}": i for i in range(9)}), "a note mode with more than 8 values"),
        (Note("mode", {"mode": "\x1b[2J"}), "a note mode whose mode is no value"),
        (Note("mode", {"mode": "a" * 101}), "a note mode whose mode is no value"),
        (Note("target", {"x": math.nan}), "a note target whose x is no value"),
        (Note("target", {"x": 2**63}), "a note target whose x is no value"),
        (Note("roster", {"lost": (1,) * 7}), "a note roster whose lost is no value"),
        (Note("roster", {"lost": (2**64,)}), "a note roster whose lost is no value"),
    ],
)
def test_a_note_that_people_should_not_see_is_named(note: Note, said: str) -> None:
    assert (saying(notes=(note,)) or "").startswith(said)


def test_the_notes_of_our_robots_are_taken() -> None:
    notes = (
        Note("wide", {"passage": math.inf}),
        Note("roster", {"epoch": 3, "lost": (), "members": TEAM}),
        Note("no_way", {"proven": True, "record": 2}),
    )
    assert saying(notes=notes) is None
    assert saying(notes=notes[:1] * NOTES) is None
    assert saying(notes=notes[:1] * (NOTES + 1)) == "33 notes in a tick; 32 may be taken"


@pytest.mark.parametrize("robots", [1, 2, 6, MOST_ROBOTS])
def test_no_action_within_the_limits_is_longer_than_its_limit(robots: int) -> None:
    ids = tuple(range(2**31 - robots, 2**31))
    limits = ActionLimits(ids)
    longest = f"{'z' * 30}"
    values: dict[str, Any] = {f"{longest}{i}": "\U0001f916" * NOTE_TEXT for i in range(NOTE_VALUES - 1)}
    values[longest] = (2**63 - 1,) * robots
    status = msgspec.structs.replace(STATUS, epoch=LIMIT - 1, leader=ids[0], members=ids)
    one = Transmission(2**63 - 1, bytes(MSDU_BYTES), MSDU_BYTES, 0)
    action = Action(
        7, 1, ACTION.twist, (one,) * limits.messages, 1.0, 1.0, status, (Note("z" * 32, values),) * NOTES
    )
    assert limits.breach(action, 7, 1) is None
    assert len(encode(action)) <= limits.action_bytes
