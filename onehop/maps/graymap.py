"""Portable graymaps, plain (P2) and raw (P5), after Netpbm's own definition (pgm(5)).

Refuses what does not fit its header; tells apart the line ends and comments that other programs put
behind the header of a raw graymap, which Netpbm's one white space does not foresee.
"""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from onehop.contracts.errors import MapError
from onehop.maps.picture import GreyArray, check_size

_HEADER = re.compile(rb"(P[25])" + rb"(?:\s|#[^\n]*\n)+(\d+)" * 3)
"""Magic, width, height and largest value; comments may stand between them."""

_LONGEST_HEADER = 1 << 16
"""Bytes in which the header must end, comments included."""

_LATE_COMMENT = re.compile(rb"\s*#[^\n]*\n")

_NO_PIXEL = re.compile(rb"[^\s\d]|[1-9]\d{5}")
"""What no value up to 65535 contains."""

_SPACE = re.compile(rb"\s")

_PIECE = 1 << 22
"""Pixels, or bytes of their text, that are converted at once: bounds the memory to some 100 MB."""


def read_graymap(name: str, content: bytes) -> GreyArray:
    """The grey of each pixel as 0..255, (rows, columns), row 0 at the top. Raises MapError."""
    magic, width, height, largest, end = _header(name, content)
    check_size(name, width, height)
    count = width * height
    if magic == b"P2":
        values = _plain_values(name, content[end:], width, count)
    else:
        values = _raw_values(content, end, count, np.dtype(">u2" if largest > 255 else "u1"))
    if len(values) < count:
        raise MapError(
            name, f"{len(values)} pixels", f"{width} x {height} = {count}, as its header says"
        )
    over = int(values.max())
    if over > largest:
        where = _place(int(np.argmax(values > largest)), width)
        raise MapError(name, f"a pixel of {over} ({where})", f"at most {largest}, as its header says")
    return _as_bytes(values, largest).reshape(height, width)


def _header(name: str, content: bytes) -> tuple[bytes, int, int, int, int]:
    """Magic, width, height, largest value, and the number of bytes before what follows them."""
    header = _HEADER.match(content[:_LONGEST_HEADER])
    if header is None or not re.match(rb"\s|#", content[header.end() : header.end() + 1]):
        raise MapError(name, "a broken PGM header", "P2 or P5, width, height, largest value")
    width, height, largest = (_whole(name, number) for number in header.groups()[1:])
    if not 0 < largest < 65536:
        raise MapError(
            name, f"{width} x {height} pixels up to {largest}", "a largest grey of 1 to 65535"
        )
    return header[1], width, height, largest, header.end()


def _whole(name: str, digits: bytes) -> int:
    if len(digits.lstrip(b"0")) > 9:
        raise MapError(
            name, f"a number of {len(digits)} digits in its header", "width, height, largest grey"
        )
    return int(digits.lstrip(b"0") or b"0")


def _raw_values(content: bytes, end: int, count: int, kind: np.dtype[Any]) -> npt.NDArray[Any]:
    """At most `count` pixels of a P5, whose header ends at `end`.

    One white space separates them (Netpbm). CR LF counts as one if the header has other lines that end
    so, or if that leaves enough pixels; a comment line is skipped if the picture follows it to the byte.
    """
    wanted = count * kind.itemsize
    comment = _LATE_COMMENT.match(content[end : end + _LONGEST_HEADER])
    start = end + 1
    if comment is not None and len(content) - end - comment.end() == wanted:
        start = end + comment.end()
    elif content[end : end + 2] == b"\r\n" and (
        b"\r\n" in content[:end] or len(content) - end - 2 >= wanted
    ):
        start = end + 2
    usable = (len(content) - start) // kind.itemsize
    return np.frombuffer(
        content, dtype=kind, count=max(0, min(count, usable)), offset=min(start, len(content))
    )


def _plain_values(name: str, body: bytes, width: int, count: int) -> npt.NDArray[np.int32]:
    """At most `count` numbers of a P2, its comments taken out."""
    text = re.sub(rb"#[^\n]*", b"", body) if b"#" in body else body
    wrong = _NO_PIXEL.search(text)
    if wrong is not None:
        before = text[: wrong.start()].rstrip(b"0123456789")
        word = text[len(before) :].split(maxsplit=1)[0]
        where = _place(sum(len(piece.split()) for piece in _pieces(before)), width)
        kind = "of" if word.isdigit() else "that is no number:"
        problem = f"a pixel {kind} {word[:20].decode('latin-1')!a} ({where})"
        raise MapError(name, problem, "whole numbers from 0 to 65535 (P2)")
    numbers = [
        np.fromstring(piece, dtype=np.int64, sep=" ").astype(np.int32)
        for piece in _pieces(text)
        if not piece.isspace()
    ]
    return np.concatenate([np.empty(0, np.int32), *numbers])[:count]


def _pieces(text: bytes) -> Iterator[bytes]:
    """The text in pieces that end between two numbers."""
    first = 0
    while first < len(text):
        space = _SPACE.search(text, first + _PIECE)
        last = space.start() if space else len(text)
        yield text[first:last]
        first = last


def _place(index: int, width: int) -> str:
    return f"column {index % width + 1} of row {index // width + 1}"


def _as_bytes(values: npt.NDArray[Any], largest: int) -> GreyArray:
    """Values 0..largest as 0..255, rounded down as GraphicsMagick does, (n,)."""
    if largest == 255:
        return values.astype(np.uint8, copy=False)
    scale = (np.arange(largest + 1) * 255 // largest).astype(np.uint8)
    grey = np.empty(len(values), dtype=np.uint8)
    for first in range(0, len(values), _PIECE):
        grey[first : first + _PIECE] = scale[values[first : first + _PIECE]]
    return grey
