"""What all values that cross a boundary are made of: frozen msgspec structs with strict fields."""

import msgspec

WIRE_VERSION = 3
"""Schema version that every wire message starts with; any other is refused by name. 3: messages have a
lifetime, truths tell of every fault that begins, payloads of the team end in a checksum."""


class Value(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A frozen value that may be part of a wire message."""


class Wire(Value, frozen=True, tag_field="v", tag=WIRE_VERSION):
    """A value that is a wire message by itself: its map starts with the schema version."""
