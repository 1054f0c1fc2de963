"""Small maps for tests: a map_server file, its picture in several formats, and the cells as text."""

import io
import struct
import zlib
from collections.abc import Sequence

import numpy as np
from PIL import Image

from onehop.contracts.sections import MapSection
from onehop.maps.map_file import load_map, map_files
from onehop.maps.walls import WallMap

YAML = """image: m.pgm
resolution: 0.5
origin: [-1.0, -2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""
GREYS = bytes([254, 0, 205, 254, 254, 254])
PGM = b"P5\n# made by a mapper\n3 2\n255\n" + GREYS


def ros(yaml: str | bytes = YAML, image: bytes = PGM) -> WallMap:
    content = yaml.encode() if isinstance(yaml, str) else yaml
    names = map_files("m.yaml", content)
    return load_map(MapSection(file="m.yaml"), {"m.yaml": content, names[0]: image})


def cells(walls: WallMap, cell: float = 0.5) -> list[str]:
    """The map's cells as text, the top row first, x a wall."""
    xmin, ymin, xmax, ymax = walls.bounds
    columns, rows = round((xmax - xmin) / cell), round((ymax - ymin) / cell)
    return [
        "".join(
            "." if walls.is_free(xmin + (column + 0.5) * cell, ymin + (row + 0.5) * cell) else "x"
            for column in range(columns)
        )
        for row in reversed(range(rows))
    ]


def png(rows: list[list[tuple[int, ...]]], colour_type: int) -> bytes:
    """A PNG with 8 bits a channel (PNG specification 5, 11)."""
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, colour_type, 0, 0, 0)
    lines = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(lines))
        + chunk(b"IEND", b"")
    )


def chunk(kind: bytes, data: bytes) -> bytes:
    """A part of a PNG."""
    body = kind + data
    return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))


def encoded(pixels: Sequence[object], mode: str, file_format: str, **options: object) -> bytes:
    """Pixels as Pillow writes them: rows of numbers or tuples of 8 bits."""
    out = io.BytesIO()
    array = np.array(pixels, dtype=np.uint8)
    size = (array.shape[1], array.shape[0])
    Image.frombytes(mode, size, array.tobytes()).save(out, file_format, **options)
    return out.getvalue()
