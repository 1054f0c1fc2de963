"""Pictures of maps from their bytes: graymaps (P2, P5), PNG and BMP, which are what map_saver writes.

Colours become grey as in GraphicsMagick, through which nav2_map_server reads: luma after ITU-R BT.601
with 16 bits, rounded down to 8. Of PNGs with 16 bits a colour channel only the upper 8 count.
"""

import io
import struct
import warnings
import zlib

import numpy as np
from PIL.BmpImagePlugin import BmpImageFile
from PIL.Image import Image
from PIL.PngImagePlugin import PngImageFile

from onehop.contracts.errors import MapError
from onehop.maps.graymap import read_graymap
from onehop.maps.picture import GreyArray, Picture, check_size

_DECODER_ERRORS = (
    OSError, SyntaxError, ValueError, TypeError, LookupError, AttributeError, AssertionError,
    EOFError, ArithmeticError, MemoryError, SystemError, struct.error, zlib.error,
)  # fmt: skip
"""What Pillow raises on damaged pictures."""

_RUN_LENGTH = (1, 2)
"""Kinds of BMP compression that Pillow unpacks byte by byte in Python: minutes for a large map."""

_DENSEST = {"PNG": 8 * 1032, "BMP": 8}
"""Pixels that a byte can hold: 1 bit each, and deflate packs at most 1032 bytes into one."""

_PIXELS_AT_ONCE = 1 << 22
"""Pixels whose colours are made grey at once: bounds the memory to some 100 MB."""


def read_image(name: str, content: bytes) -> Picture:
    """Decode a picture from its bytes, whatever its name ends in. Raises MapError."""
    if content.startswith((b"P2", b"P5")):
        return Picture(read_graymap(name, content), None)
    if content.startswith(b"\x89PNG"):
        return _decode(name, "PNG", PngImageFile, content)
    if content.startswith(b"BM"):
        return _decode(name, "BMP", BmpImageFile, content)
    raise MapError(name, "neither PGM nor PNG nor BMP", "a graymap (P2 or P5), a PNG or a BMP picture")


def _decode(
    name: str, kind: str, opener: type[PngImageFile] | type[BmpImageFile], content: bytes
) -> Picture:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            picture = opener(io.BytesIO(content))
            check_size(name, *picture.size)
            if picture.width * picture.height > _DENSEST[kind] * len(content):
                raise MapError(
                    name,
                    f"{picture.width} x {picture.height} pixels in {len(content)} bytes",
                    "a whole file",
                )
            if kind == "BMP" and picture.info.get("compression") in _RUN_LENGTH:
                raise MapError(name, "a run-length coded BMP", "an uncompressed BMP, PNG or PGM")
            picture.load()
            return _picture(picture)
        except _DECODER_ERRORS as error:
            reason = " ".join(str(error).split())[:80] or type(error).__name__
            raise MapError(name, f"not a whole {kind} ({reason})", f"a {kind} picture") from None


def _picture(picture: Image) -> Picture:
    key = picture.info.get("transparency")
    if picture.mode.startswith("I"):
        values = np.asarray(picture)
        alpha = None if key is None else np.where(values == key, 0, 255).astype(np.uint8)
        return Picture((values // 257).astype(np.uint8), alpha)
    if "A" not in picture.mode and key is None:
        if picture.mode in ("1", "L"):
            return Picture(np.asarray(picture.convert("L")), None)
        return Picture(_grey(np.asarray(picture.convert("RGB"))), None)
    pixels = np.asarray(picture.convert("RGBA"))
    return Picture(_grey(pixels), pixels[:, :, 3].copy())


def _grey(pixels: GreyArray) -> GreyArray:
    """Luma of pixels (rows, columns, 3 or 4), (rows, columns)."""
    rows, columns, _ = pixels.shape
    grey = np.empty((rows, columns), dtype=np.uint8)
    step = max(1, _PIXELS_AT_ONCE // columns)
    for first in range(0, rows, step):
        red, green, blue = np.moveaxis(pixels[first : first + step, :, :3].astype(np.uint32), 2, 0)
        luma = ((299 * red + 587 * green + 114 * blue) * 257 + 500) // 1000
        grey[first : first + step] = luma // 257
    return grey
