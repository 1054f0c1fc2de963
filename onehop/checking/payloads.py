"""What robots of a team say to each other, as far as it can be judged: read anew, not by their decoder.

A payload is one msgpack array, [schema, kind, fields...], and its CRC-32 in four bytes. Robots may say
other things, which are no messages of a team and are left alone, as is what was altered on its way.
"""

import zlib
from functools import lru_cache
from typing import NamedTuple

import msgpack

from onehop.checking.rosters import Roster
from onehop.contracts.printable import ids_in_words
from onehop.wire.codec import UNPACK_REFUSALS

SCHEMA = 3
"""Version of the team's messages that is read here."""

HANDOVER = "lost follower"
"""The one command that somebody else than the leader may give: by it a leader gives way."""


class Order(NamedTuple):
    """A command or a beacon: what a leader says of its roster. word: "next", "narrow", ..., "beacon"."""

    word: str
    roster: Roster
    narrow: bool

    def __str__(self) -> str:
        column = ", in column" if self.narrow else ""
        return f"{self.word}: epoch {self.roster.epoch} of {ids_in_words(self.roster.members)}{column}"


@lru_cache(maxsize=4096)
def order_in(payload: bytes) -> Order | None:
    """The command or beacon in a payload; None for anything else."""
    content, checksum = payload[:-4], payload[-4:]
    if zlib.crc32(content).to_bytes(4, "little") != checksum:
        return None
    try:
        fields = msgpack.unpackb(content)
    except UNPACK_REFUSALS:
        return None
    if not isinstance(fields, list) or fields[:1] != [SCHEMA]:
        return None
    match fields[1:]:
        case ["command", str(word), int(epoch), list(members), _, _, bool(narrow), *_]:
            pass
        case ["beacon" as word, int(epoch), list(members), _, bool(narrow), *_]:
            pass
        case _:
            return None
    if not members or not all(type(member) is int for member in members):
        return None
    return Order(word, Roster(epoch, tuple(members)), narrow)
