"""Names and bytes of rmw_zenoh, to the letter: examples of its design document, and of its source."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.analysis.ros2.types import LINK, typestore
from onehop.ros2.rmw import (
    NO_HASH,
    PUBLISHER,
    Endpoint,
    Node,
    Qos,
    attachment,
    dds_name,
    endpoint_token,
    gid,
    node_token,
    topic_key,
)

STRING = "std_msgs/msg/String"
STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
SESSION = "8b20917502ee955ac4476e0266340d5c"
TALKER = Node(2, SESSION, 0, "talker")


def test_a_key_is_that_of_the_design_document() -> None:
    assert topic_key(0, "/robot1/chatter", STRING, STRING_HASH) == (
        f"0/robot1/chatter/std_msgs::msg::dds_::String_/{STRING_HASH}"
    )


def test_tokens_are_those_of_the_design_document() -> None:
    assert node_token(TALKER) == f"@ros2_lv/2/{SESSION}/0/0/NN/%/%/talker"
    chatter = Endpoint(10, PUBLISHER, "/chatter", STRING, STRING_HASH, Qos(False, 7))
    assert endpoint_token(TALKER, chatter) == (
        f"@ros2_lv/2/{SESSION}/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/"
        f"{STRING_HASH}/::,7:,:,:,,"
    )


@pytest.mark.parametrize(
    ("qos", "text"),
    [(Qos(False, 10), "::,10:,:,:,,"), (Qos(True, 1), ":1:,1:,:,:,,"), (Qos(False, 42), "::,:,:,:,,")],
)
def test_a_qos_leaves_out_what_is_the_default(qos: Qos, text: str) -> None:
    assert qos.text() == text


def test_hashes_are_those_of_ros() -> None:
    assert typestore().hash_rihs01(STRING) == STRING_HASH
    assert dds_name(LINK) == "onehop_msgs::msg::dds_::Link_"
    assert topic_key(0, "/chatter", STRING, NO_HASH).endswith("String_/TypeHashNotSupported")


def test_a_global_id_is_the_hash_of_the_token_low_half_first() -> None:
    """XXH3-128 of nothing is 99aa06d3014798d8 6001c324468d497f, high half first (xxHash's own tests)."""
    assert gid("") == struct.pack("<QQ", 0x6001C324468D497F, 0x99AA06D3014798D8)


@given(st.integers(1, 2**63 - 1), st.integers(0, 2**63 - 1), st.text())
def test_an_attachment_is_33_bytes(number: int, at_ns: int, token: str) -> None:
    data = attachment(number, at_ns, gid(token))
    assert len(data) == 33
    assert struct.unpack_from("<qqB", data) == (number, at_ns, 16)
    assert data[17:] == gid(token)
