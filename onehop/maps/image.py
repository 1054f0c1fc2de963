"""Pictures in memory: portable graymaps (P2, P5) and PNG, as brightness per channel."""

import re
from typing import NamedTuple

import numpy as np
from PIL import ImageFile, UnidentifiedImageError

from onehop.contracts.arrays import FloatArray
from onehop.contracts.errors import MapError


class Image(NamedTuple):
    """colours: (rows, columns, channels) float64 in 0..1, row 0 at the top; alpha likewise, or None."""

    colours: FloatArray
    alpha: FloatArray | None


_HEADER = re.compile(rb"(P[25])" + rb"(?:\s*#[^\n]*\n|\s)+(\d+)" * 3 + rb"(?:[ \t]*#[^\n]*\n|\s)")
"""Magic, width, height and largest value of a graymap; comments may stand between them."""

_LARGEST = 1 << 26
"""Pixels of the largest picture that is read."""


def read_image(name: str, content: bytes) -> Image:
    """Decode a picture from its bytes, whatever its name ends in. Raises MapError."""
    if content.startswith((b"P2", b"P5")):
        return _read_graymap(name, content)
    if content.startswith(b"\x89PNG"):
        return _read_png(name, content)
    raise MapError(name, "neither PGM nor PNG", "a graymap (P2 or P5) or a PNG picture")


def _read_graymap(name: str, content: bytes) -> Image:
    header = _HEADER.match(content)
    if header is None:
        raise MapError(name, "a broken PGM header", "P2 or P5, width, height, largest value")
    magic = header[1]
    width, height, largest = (int(number[:9]) for number in header.groups()[1:])
    if not (0 < largest < 65536 and 0 < width * height <= _LARGEST):
        raise MapError(
            name, f"{width} x {height} pixels up to {largest}", "a size above 0 and values up to 65535"
        )
    values = (_ascii_values if magic == b"P2" else _raw_values)(name, content[header.end() :], largest)
    if len(values) < width * height:
        raise MapError(name, f"{len(values)} pixels", f"{width} x {height} = {width * height}")
    grey = values[: width * height].reshape(height, width, 1)
    if grey.max() > largest:
        raise MapError(
            name, f"a pixel of {int(grey.max())}", f"no more than {largest}, as its header says"
        )
    return Image(grey / float(largest), None)


def _ascii_values(name: str, body: bytes, _largest: int) -> FloatArray:
    words = re.sub(rb"#[^\n]*", b"", body).split()
    try:
        return np.array(words, dtype="S9").astype(np.float64)
    except ValueError:
        raise MapError(name, "a pixel that is no number", "whole numbers (P2)") from None


def _raw_values(_name: str, body: bytes, largest: int) -> FloatArray:
    kind = np.dtype(">u2") if largest > 255 else np.dtype(np.uint8)
    usable = len(body) - len(body) % kind.itemsize
    return np.frombuffer(body[:usable], dtype=kind).astype(np.float64)


def _read_png(name: str, content: bytes) -> Image:
    parser = ImageFile.Parser()
    try:
        parser.feed(content)
        picture = parser.close()
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError) as error:
        raise MapError(name, f"not a whole PNG ({error})", "a PNG picture") from None
    if picture.mode.startswith("I"):
        return Image(np.asarray(picture, dtype=np.float64)[:, :, None] / 65535.0, None)
    opaque = "A" not in picture.mode and "transparency" not in picture.info
    grey = picture.mode in ("1", "L", "LA")
    pixels = np.asarray(picture.convert("LA" if grey else "RGBA"), dtype=np.float64) / 255.0
    return Image(pixels[:, :, :-1], None if opaque else pixels[:, :, -1])
