"""What happens to an input on its way: bytes and tokens flipped, cut, doubled, swapped, made extreme."""

import re
from collections.abc import Callable, Sequence
from random import Random

NUMBERS = (
    b"nan", b"inf", b"-inf", b"-1", b"0", b"-0.0", b"1", b"2", b"1e308", b"-1e308",
    b"5e-324", b"1e-3", b"0.5", b"255", b"256", b"65536", b"2147483648", b"9223372036854775807",
    b"18446744073709551616", b"0x7f", b"9" * 5000,
)  # fmt: skip
"""Numbers at which something ends: types, ranges, what a reader takes."""

PIECES = (
    b"\0", b"\xff" * 4, b"\t", b"\n", b"\r\n", b"#", b"=", b"[", b"]]", b"{", b'"', b"'''", b"*a",
    b"&a ", b"!!python/object:os.system ", b"\xef\xbb\xbf", b"\x1b[2J",
    "\u202e\u2028é".encode(), b"<script>", b"[" * 3000, b"{a=" * 500, b"x" * 100_000, b"1," * 20_000,
    b"\x93" * 2000, b"true", b'""', b"[]",
)  # fmt: skip
"""What a reader may stumble over."""

_NUMBER = re.compile(rb"-?\d+(\.\d+)?")
_TOKEN = re.compile(rb"[\w.+-]+|[^\w\s]")


def damaged(data: bytes, others: Sequence[bytes], random: Random) -> bytes:
    """An input after one change or a few. others: inputs of which something may get in."""
    for _ in range(random.choice((1, 1, 1, 2, 4))):
        change = random.choice(_CHANGES)
        data = change(data, random.choice(others), random) if data else random.choice(PIECES)
    return data


def _place(data: bytes, random: Random) -> int:
    return random.randrange(len(data) + 1)


def _flip(data: bytes, _: bytes, random: Random) -> bytes:
    changed = bytearray(data)
    for _number in range(random.choice((1, 1, 3, 20))):
        changed[random.randrange(len(changed))] ^= 1 << random.randrange(8)
    return bytes(changed)


def _cut(data: bytes, _: bytes, random: Random) -> bytes:
    at = _place(data, random)
    return data[:at] + data[at + random.choice((1, 2, 8, 100)) :]


def _tear(data: bytes, _: bytes, random: Random) -> bytes:
    return data[: _place(data, random)]


def _insert(data: bytes, _: bytes, random: Random) -> bytes:
    at = _place(data, random)
    piece = random.choice((random.choice(PIECES), random.randbytes(random.choice((1, 8, 100)))))
    return data[:at] + piece + data[at:]


def _repeat(data: bytes, _: bytes, random: Random) -> bytes:
    first, last = sorted((_place(data, random), _place(data, random)))
    return data[:last] + data[first:last] * random.choice((1, 1, 1, 100)) + data[last:]


def _swap(data: bytes, _: bytes, random: Random) -> bytes:
    a, b, c, d = sorted(_place(data, random) for _ in range(4))
    return data[:a] + data[c:d] + data[b:c] + data[a:b] + data[d:]


def _splice(data: bytes, other: bytes, random: Random) -> bytes:
    return data[: _place(data, random)] + other[_place(other, random) :]


def _extreme(data: bytes, _: bytes, random: Random) -> bytes:
    return _exchanged(data, _NUMBER, random.choice(NUMBERS), random)


def _token(data: bytes, other: bytes, random: Random) -> bytes:
    tokens = [*_TOKEN.findall(other), *PIECES[:16]]
    return _exchanged(data, _TOKEN, random.choice(tokens), random)


def _exchanged(data: bytes, what: re.Pattern[bytes], new: bytes, random: Random) -> bytes:
    found = list(what.finditer(data))
    if not found:
        return data + new
    place = random.choice(found)
    return data[: place.start()] + new + data[place.end() :]


_CHANGES: tuple[Callable[[bytes, bytes, Random], bytes], ...] = (
    _flip, _cut, _tear, _insert, _repeat, _swap, _splice, _extreme, _extreme, _extreme, _token, _token,
)  # fmt: skip
