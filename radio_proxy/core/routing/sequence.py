"""Destination sequence numbers of AODV (RFC 3561, 6.1): 32 bits that roll over."""

_HALF = 1 << 31
_ALL = (1 << 32) - 1


def newer(a: int, b: int) -> bool:
    """Whether a is fresher than b: their difference as a signed 32-bit number is positive."""
    return a != b and (a - b) & _ALL < _HALF


def following(a: int) -> int:
    """The next sequence number; 0 follows 2^32 - 1."""
    return (a + 1) & _ALL


def freshest(a: int, b: int) -> int:
    """The newer of two sequence numbers."""
    return a if newer(a, b) else b
