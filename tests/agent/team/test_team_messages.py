"""Team messages: what is encoded comes back, and nothing else is accepted."""

import math

import msgpack
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onehop.contracts.action_limits import MSDU_BYTES
from onehop.contracts.errors import DecodeError
from onehop.contracts.geometry import Pose
from onehop.contracts.sections import MOST_ROBOTS
from onehop.contracts.serial_numbers import LIMIT
from robot_agent.core.team.roster import Roster
from robot_agent.core.team.team_messages import (
    MAX_COORDINATE,
    MAX_TRAIL,
    SCHEMA,
    Ack,
    Beacon,
    Command,
    CommandKind,
    Join,
    MissionPhase,
    decode,
    encode,
    sealed,
)

counts = st.integers(0, 2**31 - 1)
metres = st.floats(-1e6, 1e6, allow_nan=False)
poses = st.builds(Pose, metres, metres, st.floats(-math.pi, math.pi))
members = st.sets(st.integers(1, 1000), min_size=1, max_size=30).map(lambda ids: tuple(sorted(ids)))
rosters = st.builds(Roster, counts, members)
centimetres = st.integers(-(10**8), 10**8).map(lambda n: n / 100.0)
trails = st.lists(st.tuples(centimetres, centimetres), max_size=24).map(tuple)
commands = st.builds(
    Command,
    st.sampled_from(CommandKind),
    rosters,
    counts,
    st.sampled_from(MissionPhase),
    st.booleans(),
    poses,
    members,
    trails,
)
messages = st.one_of(
    commands,
    st.builds(Ack, counts, counts, st.booleans(), poses),
    st.builds(Beacon, rosters, st.sampled_from(MissionPhase), st.booleans(), poses),
    st.builds(Join, counts, poses),
)


@settings(deadline=None)
@given(messages)
def test_what_is_encoded_comes_back(message):
    assert decode(encode(message)) == message


@settings(deadline=None)
@given(st.binary(max_size=300))
def test_arbitrary_bytes_are_refused_without_another_error(payload):
    with pytest.raises(DecodeError):
        decode(payload)


@settings(deadline=None)
@given(st.binary(max_size=300))
def test_arbitrary_bytes_with_a_right_checksum_are_refused_without_another_error(content):
    with pytest.raises(DecodeError):
        decode(sealed(content))


@settings(deadline=None)
@given(messages, st.data())
def test_a_flipped_byte_is_refused(message, data):
    payload = bytearray(encode(message))
    place = data.draw(st.integers(0, len(payload) - 1))
    payload[place] ^= data.draw(st.integers(1, 255))
    with pytest.raises(DecodeError, match="checksum"):
        decode(bytes(payload))


@settings(deadline=None)
@given(messages, st.integers(0, 400))
def test_a_torn_payload_is_refused(message, length):
    payload = encode(message)
    with pytest.raises(DecodeError):
        decode(payload[: min(length, len(payload) - 1)])


@pytest.mark.parametrize(
    "content",
    [
        [SCHEMA + 1, "join", 0, 0.0, 0.0, 0.0],
        [SCHEMA, "hello", 0, 0.0, 0.0, 0.0],
        [SCHEMA, "join", 0, 0.0, 0.0],
        [SCHEMA, "join", -1, 0.0, 0.0, 0.0],
        [SCHEMA, "join", True, 0.0, 0.0, 0.0],
        [SCHEMA, "join", 0, 0, 0.0, 0.0],
        [SCHEMA, "join", 0, math.nan, 0.0, 0.0],
        [SCHEMA, "join", 0, math.inf, 0.0, 0.0],
        [SCHEMA, "join", 2**40, 0.0, 0.0, 0.0],
        [SCHEMA, "beacon", 0, [], "driving", False, 0.0, 0.0, 0.0],
        [SCHEMA, "beacon", 0, [2, 1], "driving", False, 0.0, 0.0, 0.0],
        [SCHEMA, "beacon", 0, [1, 1], "driving", False, 0.0, 0.0, 0.0],
        [SCHEMA, "beacon", 0, [0, 1], "driving", False, 0.0, 0.0, 0.0],
        [SCHEMA, "beacon", 0, [1], "flying", False, 0.0, 0.0, 0.0],
        [SCHEMA, "beacon", 0, [1], "driving", 0, 0.0, 0.0, 0.0],
        [SCHEMA, {"join": 1}],
        {"schema": SCHEMA},
        SCHEMA,
        [],
    ],
)
def test_what_is_almost_a_message_is_refused(content):
    with pytest.raises(DecodeError):
        decode(sealed(msgpack.packb(content)))


def test_a_next_of_a_hundred_robots_with_its_trail_fits_into_one_msdu():
    trail = tuple((90.0 + 0.01 * n, 99.99) for n in range(24))
    roster = Roster(1000, tuple(range(1, 101)))
    command = Command(
        CommandKind.NEXT, roster, 10_000, MissionPhase.DRIVING, False, Pose(99.9, 99.9, 3.1), (), trail
    )
    assert len(encode(command)) <= 800  # thesis 3.7: one MSDU of 800 B


def test_the_longest_command_of_the_largest_team_fits_into_one_frame():
    """Whatever the ids are, and however many are given up: nobody is both member and lost."""
    ids = tuple(range(2**31 - MOST_ROBOTS, 2**31))
    far = tuple((MAX_COORDINATE, -MAX_COORDINATE) for _ in range(MAX_TRAIL))
    command = Command(
        CommandKind.LOST_FOLLOWER,
        Roster(LIMIT - 1, ids[:1]),
        LIMIT - 1,
        MissionPhase.DRIVING,
        True,
        Pose(1.5, 1.5, 1.5),
        ids[1:],
        far,
        far[:2],
    )
    assert len(encode(command)) <= MSDU_BYTES
