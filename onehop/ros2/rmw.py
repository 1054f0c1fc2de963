"""Names and bytes of rmw_zenoh: how ROS 2 nodes find each other, and what goes with a message.

Source: ros2/rmw_zenoh, docs/design.md and rmw_zenoh_cpp/src/detail/{liveliness_utils,
attachment_helpers, qos}.cpp, as they are since version 0.2.4 (April 2025); before, attachments had
another form.
"""

import struct
from typing import NamedTuple

import xxhash

NO_HASH = "TypeHashNotSupported"
"""In the place of every type's hash with Humble, which has none."""

NODE, PUBLISHER, SUBSCRIPTION = "NN", "MP", "MS"

_DEFAULT_DEPTH = 42
"""Of rmw_zenoh; a field of a QoS that is the default is left empty."""


class Qos(NamedTuple):
    """Of a publisher or subscription: reliable, the newest `depth` kept. lasting: transient local."""

    lasting: bool
    depth: int

    def text(self) -> str:
        """reliability:durability:history,depth:deadline:lifespan:liveliness,lease"""
        depth = "" if self.depth == _DEFAULT_DEPTH else str(self.depth)
        return f":{'1' if self.lasting else ''}:,{depth}:,:,:,,"


class Node(NamedTuple):
    """A node of the graph. session: the id of its Zenoh session. number: unique in that session."""

    domain: int
    session: str
    number: int
    name: str


class Endpoint(NamedTuple):
    """A publisher or subscription of a topic. number: unique in the session. type_hash: RIHS01_..."""

    number: int
    role: str
    topic: str
    kind: str
    type_hash: str
    qos: Qos


def dds_name(kind: str) -> str:
    """Name of a type on the wire: std_msgs/msg/String is std_msgs::msg::dds_::String_."""
    package, group, name = kind.split("/")
    return f"{package}::{group}::dds_::{name}_"


def topic_key(domain: int, topic: str, kind: str, type_hash: str) -> str:
    """Key expression of a topic's messages."""
    return f"{domain}/{topic.strip('/')}/{dds_name(kind)}/{type_hash}"


def node_token(node: Node) -> str:
    """Liveliness token of a node in the root namespace, without enclave."""
    return f"@ros2_lv/{node.domain}/{node.session}/{node.number}/{node.number}/{NODE}/%/%/{node.name}"


def endpoint_token(node: Node, one: Endpoint) -> str:
    """Liveliness token of a publisher or subscription."""
    place = f"@ros2_lv/{node.domain}/{node.session}/{node.number}/{one.number}/{one.role}"
    what = f"{one.topic.replace('/', '%')}/{dds_name(one.kind)}/{one.type_hash}/{one.qos.text()}"
    return f"{place}/%/%/{node.name}/{what}"


def gid(token: str) -> bytes:
    """Global id of an endpoint: XXH3-128 of its token, low half first, each little-endian."""
    return int(xxhash.xxh3_128_intdigest(token.encode())).to_bytes(16, "little")


def attachment(number: int, at_ns: int, sender: bytes) -> bytes:
    """What goes with a message. number: counts from 1. at_ns: when it was sent, UNIX time [ns]."""
    return struct.pack("<qqB", number, at_ns, len(sender)) + sender
