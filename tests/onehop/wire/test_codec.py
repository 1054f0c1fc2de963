"""The wire format: what goes in comes out, and nothing else gets in."""

import math
import subprocess
import sys

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.contracts.errors import DecodeError
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import (
    Action,
    Cut,
    Inbox,
    Jam,
    Note,
    Observation,
    Presence,
    Reception,
    Transmission,
    Truth,
)
from onehop.contracts.team import Mode, Shape, Status
from onehop.contracts.values import WIRE_VERSION
from onehop.wire.codec import decode, encode

numbers = st.floats(allow_nan=False)
counts = st.integers(0, 2**53)
ids = st.integers(1, 200)
poses = st.builds(Pose, numbers, numbers, numbers)
twists = st.builds(Twist, numbers, numbers)
teams = st.lists(ids, max_size=5, unique=True).map(lambda members: tuple(sorted(members)))
receptions = st.builds(
    Reception, ids, st.binary(max_size=60), counts, counts, ids, ids, numbers, numbers, counts
)
statuses = st.builds(
    Status, st.sampled_from(Mode), counts, ids, teams, st.sampled_from(Shape), *[numbers] * 6
)
notes = st.builds(
    Note,
    st.text(max_size=10),
    st.dictionaries(
        st.text(max_size=5), st.one_of(counts, numbers, st.text(max_size=5), teams), max_size=3
    ),
)
transmissions = st.builds(Transmission, ids, st.binary(max_size=60), counts, counts)
actions = st.builds(
    Action,
    counts,
    counts,
    twists,
    st.lists(transmissions, max_size=3).map(tuple),
    numbers,
    numbers,
    statuses,
    st.lists(notes, max_size=2).map(tuple),
)
inboxes = st.builds(Inbox, counts, counts, st.lists(receptions, max_size=4).map(tuple))


@given(st.one_of(actions, inboxes))
def test_every_message_comes_back_as_it_was(message: Action | Inbox) -> None:
    data = encode(message)
    assert decode(type(message), data) == message
    assert encode(decode(type(message), data)) == data


@given(st.lists(st.floats(0, 100, width=32) | st.just(math.inf), max_size=181))
def test_a_scan_travels_as_float32_bytes(ranges: list[float]) -> None:
    scan = np.array(ranges, dtype=np.float32)
    seen = Observation(7, 350_000_000, 0, Pose(1.0, 2.0, 3.0), Twist(0.5, 0.0), scan)
    back = decode(Observation, encode(seen))
    assert back.scan.dtype == np.float32
    assert back.scan.tobytes() == scan.tobytes()
    assert (back.pose, back.twist, back.tick) == (seen.pose, seen.twist, seen.tick)


def test_truth_with_faults_comes_back() -> None:
    truth = Truth(
        3,
        150,
        (Presence(1, 0, Pose(1.0, 2.0, 0.5), Twist(0.0, 0.0), True),),
        (),
        (Cut((1,), (2, 3)),),
        (Jam(1.0, 2.0, 3.0, -60.0),),
        (),
        (),
    )
    assert decode(Truth, encode(truth)) == truth


@given(st.binary(max_size=200))
def test_garbage_is_refused_with_decode_error_only(data: bytes) -> None:
    with pytest.raises(DecodeError):
        decode(Inbox, data)


def _refusal(wire: bytes) -> str | None:
    try:
        decode(Action, wire)
    except DecodeError as error:
        return str(error)
    return None


@given(actions, st.data())
def test_a_cut_or_changed_message_never_raises_anything_else(
    action: Action, data: st.DataObject
) -> None:
    wire = bytearray(encode(action))
    place = data.draw(st.integers(0, len(wire) - 1))
    if data.draw(st.booleans()):
        wire = wire[:place]
    else:
        wire[place] ^= data.draw(st.integers(1, 255))
    reason = _refusal(bytes(wire))
    assert reason is None or (reason.startswith("Action: ") and "\n" not in reason)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"v": 99}, f"schema version 99; this program speaks {WIRE_VERSION}"),
        ({"v": True}, "schema version True"),
        ({"tick": 1.0}, "Expected `int`, got `float` - at `$.tick`"),
        ({"tick": True}, "Expected `int`, got `bool` - at `$.tick`"),
        ({"time_ns": "5"}, "Expected `int`, got `str` - at `$.time_ns`"),
        ({"receptions": None}, "Expected `array`, got `None` - at `$.receptions`"),
        ({"extra": 1}, "unknown field `extra`"),
    ],
)
def test_nothing_is_coerced(change: dict[str, object], reason: str) -> None:
    good = {"v": WIRE_VERSION, "tick": 1, "time_ns": 5, "receptions": []}
    with pytest.raises(DecodeError, match="Inbox: ") as refusal:
        decode(Inbox, msgpack.packb({**good, **change}))
    assert reason in str(refusal.value)


def test_a_reason_is_one_printable_line_whatever_the_sender_names() -> None:
    bad = msgpack.packb({"v": WIRE_VERSION, "tick": 1, "time_ns": 5, "receptions": [], "a\n\x1b[2J": 1})
    with pytest.raises(DecodeError) as refused:
        decode(Inbox, bad)
    assert str(refused.value) == r"Inbox: Object contains unknown field `a\n\x1b[2J`"


def test_a_missing_key_is_named() -> None:
    with pytest.raises(DecodeError, match="missing required field `time_ns`"):
        decode(Inbox, msgpack.packb({"v": WIRE_VERSION, "tick": 1, "receptions": []}))


def test_the_version_comes_first() -> None:
    with pytest.raises(DecodeError, match="not its first key"):
        decode(Inbox, msgpack.packb({"tick": 1, "time_ns": 5, "receptions": [], "v": WIRE_VERSION}))
    with pytest.raises(DecodeError, match="no schema version"):
        decode(Inbox, msgpack.packb({"tick": 1, "time_ns": 5, "receptions": []}))


def test_a_whole_number_stands_for_a_float() -> None:
    jam = {"x": 1, "y": 2, "radius": 3, "noise_dbm": -60}
    truth = Truth(3, 150, (), (), (), (Jam(1.0, 2.0, 3.0, -60.0),), (), ())
    fields = {**msgpack.unpackb(encode(truth)), "jams": [jam]}
    assert decode(Truth, msgpack.packb(fields)) == truth


THREADS = """
import sys, threading
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Presence, Truth
from onehop.wire.codec import decode, encode

one = Presence(1, 0, Pose(0.0, 0.0, 0.0), Twist(0.0, 0.0), False)
truth = Truth(1, 1, (one,), (), (), (), (), ())
data = encode(truth)
sys.setswitchinterval(1e-6)
together = threading.Barrier(4)

def work():
    together.wait()
    assert decode(Truth, data) == truth

threads = [threading.Thread(target=work) for _ in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
"""


def test_threads_may_decode_a_first_message_at_the_same_time() -> None:
    """As the readers of two logs do; msgspec by itself crashes the process, nearly every time."""
    for _ in range(3):
        done = subprocess.run(
            [sys.executable, "-c", THREADS], capture_output=True, text=True, check=False
        )
        assert (done.returncode, done.stderr) == (0, "")
