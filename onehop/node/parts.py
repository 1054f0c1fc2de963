"""Messages that are longer than a link of low latency carries: they travel in parts.

Zenoh's low-latency transport writes to the socket from the sender's thread, but knows no fragments: it
would drop what is longer without a word. A percept has no useful bound: a scan has up to 40 kB, and the
air alone up to 1.4 MB from each robot in reach in a tick of a second. So every part but the last goes
under a key of its own. A link keeps the order, and what comes next from the same sender is the rest.
"""

from collections.abc import Iterator

from onehop.contracts import topics

PART_BYTES = 48_000
"""Longest part: what low-latency transport takes, 65,535 bytes less the key and its headers, rounded."""


def leading_parts(data: bytes) -> Iterator[bytes]:
    """All parts but the last."""
    for start in range(0, len(data) - PART_BYTES, PART_BYTES):
        yield data[start : start + PART_BYTES]


def last_part(data: bytes) -> bytes:
    """The rest, never empty unless the message is."""
    return data[(len(data) - 1) // PART_BYTES * PART_BYTES :] if data else data


class Parts:
    """Puts together what one process hears. most_bytes: what it keeps of a sender's parts at most.

    waiting: by sender, what has come of a message. While there is none, `joined` gives back whatever is
    no part itself.
    """

    def __init__(self, most_bytes: int) -> None:
        self._most_bytes = most_bytes
        self.waiting: dict[str, bytearray] = {}

    def joined(self, what: str, data: bytes) -> bytes | None:
        """A message with the parts that came before it; None if it is a part itself.

        what: its name, after its sender's if there may be several. A part too many is a message itself,
        which nobody reads, and ends what came before.
        """
        sender, _, word = what.rpartition("/")
        if word == topics.PART:
            waiting = self.waiting.setdefault(sender, bytearray())
            waiting += data
            return None if len(waiting) <= self._most_bytes else bytes(self.waiting.pop(sender))
        if sender in self.waiting:
            return bytes(self.waiting.pop(sender) + data)
        return data
