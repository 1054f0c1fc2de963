"""PNG and BMP as map_saver and paint programs write them, and damaged ones."""

import struct
import zlib

import numpy as np
import pytest

from onehop.contracts.errors import MapError
from onehop.maps.image import read_image
from tests.onehop.maps.pictures import chunk, encoded, png

GREYS = [[254, 0, 205], [127, 1, 255]]


def bitmap(width: int, height: int, grey: bytes, alpha: bytes = b"", compression: int = 0) -> bytes:
    """A BMP, bottom up: of 32 bits with a mask for alpha (BITMAPV4HEADER), or of 8 bits without."""
    if alpha:
        pixels = b"".join(bytes((g, g, g, a)) for g, a in zip(grey, alpha, strict=True))
        masks = struct.pack("<4I", 0xFF0000, 0xFF00, 0xFF, 0xFF000000)
        info = struct.pack("<IiiHHIIiiII", 108, width, height, 1, 32, 3, len(pixels), 0, 0, 0, 0)
        info += masks + b"BGRs" + bytes(48)
        palette = b""
    else:
        rows = [grey[row * width : (row + 1) * width] for row in range(height)]
        pixels = b"".join(row + bytes(-width % 4) for row in rows)
        info = struct.pack(
            "<IiiHHIIiiII", 40, width, height, 1, 8, compression, len(pixels), 0, 0, 256, 0
        )
        palette = b"".join(bytes((g, g, g, 0)) for g in range(256))
    start = 14 + len(info) + len(palette)
    return struct.pack("<2sIHHI", b"BM", start + len(pixels), 0, 0, start) + info + palette + pixels


@pytest.mark.parametrize(
    "content",
    [
        png([[(g,) for g in row] for row in GREYS], 0),
        png([[(g, g, g) for g in row] for row in GREYS], 2),
        encoded(GREYS, "L", "PNG"),
        encoded(GREYS, "L", "BMP"),
        encoded([[(g, g, g) for g in row] for row in GREYS], "RGB", "BMP"),
        bitmap(3, 2, grey=bytes(GREYS[1] + GREYS[0])),
        b"P5 3 2 255\n" + bytes(GREYS[0] + GREYS[1]),
    ],
    ids=[
        "grey PNG",
        "colour PNG",
        "Pillow's PNG",
        "Pillow's BMP",
        "colour BMP",
        "palette BMP",
        "PGM",
    ],
)
def test_a_grey_picture_is_the_same_in_every_format(content: bytes) -> None:
    picture = read_image("m.pgm", content)
    assert picture.grey.tolist() == GREYS
    assert picture.alpha is None


@pytest.mark.parametrize(
    "content",
    [
        png([[(254, 255), (7, 254), (9, 0)]], 4),
        png([[(254, 254, 254, 255), (7, 7, 7, 254), (9, 9, 9, 0)]], 6),
        bitmap(3, 1, grey=bytes([254, 7, 9]), alpha=bytes([255, 254, 0])),
    ],
    ids=["grey PNG", "colour PNG", "map_saver's BMP in scale mode"],
)
def test_alpha_stands_beside_the_grey(content: bytes) -> None:
    picture = read_image("m.png", content)
    assert picture.alpha is not None
    assert picture.grey.tolist() == [[254, 7, 9]]
    assert picture.alpha.tolist() == [[255, 254, 0]]


def test_a_transparent_colour_of_a_palette_is_alpha() -> None:
    content = encoded([[0, 1, 2]], "L", "PNG", transparency=1)
    picture = read_image("m.png", content)
    assert picture.alpha is not None
    assert (picture.alpha == 255).tolist() == [[True, False, True]]


def test_sixteen_bits_are_rounded_down_to_eight() -> None:
    """As GraphicsMagick: a grey of 16 bits divided by 257."""
    row = [0, 256, 257, 52684, 52685, 65278, 65535]
    header = struct.pack(">IIBBBBB", len(row), 1, 16, 0, 0, 0, 0)
    data = zlib.compress(b"\0" + struct.pack(f">{len(row)}H", *row))
    content = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")
    assert read_image("m.png", content).grey.tolist() == [[0, 0, 1, 204, 205, 254, 255]]


def test_colours_become_grey_as_in_graphicsmagick() -> None:
    """Values of GraphicsMagick 1.3.40: gm convert -type Grayscale."""
    row = [(255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0), (1, 2, 3), (200, 100, 50)]
    assert read_image("m.png", encoded([row], "RGB", "PNG")).grey.tolist() == [
        [76, 149, 29, 225, 1, 124]
    ]


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"", "neither PGM nor PNG nor BMP"),
        (b"GIF89a", "neither PGM nor PNG nor BMP"),
        (b"P7\nWIDTH 1\n", "neither PGM nor PNG nor BMP"),
        (png([[(1,)]], 0)[:40], "not a whole PNG"),
        (png([[(1,)] * 300] * 300, 0)[:-30], "not a whole PNG"),
        (b"\x89PNG\r\n\x1a\n", "not a whole PNG"),
        (b"BM", "not a whole BMP"),
        (bitmap(3, 2, grey=bytes(6))[:-5], "not a whole BMP"),
        (bitmap(3, 2, grey=bytes(6), compression=1), "run-length coded"),
        (bitmap(8193, 8193, grey=b""), "8193 x 8193 pixels; at least one, and at most 67108864"),
        (bitmap(0, 5, grey=b""), "not a whole BMP"),
    ],
)
def test_a_picture_that_is_none_is_refused(content: bytes, problem: str) -> None:
    with pytest.raises(MapError, match=problem) as refusal:
        read_image("m.pgm", content)
    assert refusal.value.where == "m.pgm"
    assert str(refusal.value).isprintable()


def test_a_decompression_bomb_is_refused_by_its_header() -> None:
    header = struct.pack(">IIBBBBB", 60000, 60000, 8, 0, 0, 0, 0)
    data = zlib.compress(bytes(60001) * 100)
    bomb = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data)
    with pytest.raises(MapError, match="60000 x 60000 pixels"):
        read_image("m.png", bomb)


def test_a_picture_larger_than_its_bytes_can_hold_is_refused_before_it_takes_memory() -> None:
    header = struct.pack(">IIBBBBB", 8000, 8000, 8, 6, 0, 0, 0)
    content = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"12"))
    with pytest.raises(MapError, match="8000 x 8000 pixels in 55 bytes"):
        read_image("m.png", content)


def test_a_picture_that_deflate_packs_best_is_read() -> None:
    picture = read_image("m.png", encoded(np.zeros((3000, 3000)).tolist(), "L", "PNG", compress_level=9))
    assert picture.grey.shape == (3000, 3000)


def test_a_large_colour_picture_is_made_grey_in_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    pixels = np.random.default_rng(5).integers(0, 256, (40, 30, 3), dtype=np.uint8)
    content = encoded(pixels.tolist(), "RGB", "PNG")
    whole = read_image("m.png", content).grey
    monkeypatch.setattr("onehop.maps.image._PIXELS_AT_ONCE", 100)
    np.testing.assert_array_equal(read_image("m.png", content).grey, whole)
