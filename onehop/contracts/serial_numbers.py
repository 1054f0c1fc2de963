"""Serial numbers of 32 bits that roll over and are compared all the same (RFC 1982).

Epochs of rosters and sequence numbers of routes are such numbers: whatever a message claims, the next
one is newer, so nobody can use them up.
"""

_ALL = (1 << 32) - 1
_HALF = 1 << 31

_QUARTER = 1 << 30

LIMIT = 1 << 32
"""All serial numbers are below."""


def newer(a: int, b: int) -> bool:
    """Whether a comes after b (RFC 1982, 3.2); of two that lie half the circle apart, the greater."""
    ahead = (a - b) & _ALL
    return a > b if ahead == _HALF else 0 < ahead < _HALF


def following(a: int) -> int:
    """The next serial number; 0 follows 2^32 - 1 (RFC 1982, 3.1)."""
    return (a + 1) & _ALL


def newest(a: int, b: int) -> int:
    """The newer of two serial numbers."""
    return a if newer(a, b) else b


def towards(a: int, b: int) -> int:
    """a, moved on towards b if b is newer, by a quarter of the circle at most.

    No number is newer than two that lie half the circle apart. In steps of a quarter each is newer than
    the one before, so that whoever knows only that one follows.
    """
    return (a + min((b - a) & _ALL, _QUARTER)) & _ALL if newer(b, a) else a
