"""Grids of the MovingAI benchmarks (Sturtevant 2012), read for a wheeled robot.

x to the right, y up, the origin at the lower left corner, the file's first row at the top. Terrain: `.`
and `G` are ground, `S` (swamp) can be driven through; `@`, `O` (out of bounds), `T` (trees) and `W`
(water, which cannot be entered from the ground) cannot.
"""

import numpy as np

from onehop.contracts.errors import MapError
from onehop.maps.grid import GridFrame, grid_map
from onehop.maps.walls import WallMap

_FREE, _FILLED = b".GS", b"@OTW"
_LARGEST = 1 << 24
"""Cells of the largest grid that is read: 4096 x 4096."""


def movingai_map(name: str, content: bytes, cell: float) -> WallMap:
    """The map of a .map file with `cell` metres a cell. Raises MapError."""
    lines = content.replace(b"\r\n", b"\n").rstrip().split(b"\n")
    width, height, first = _header(name, lines)
    if width * height > _LARGEST:
        raise MapError(name, f"{width} x {height} cells", f"at most {_LARGEST} in all")
    rows = lines[first:]
    if len(rows) != height:
        raise MapError(name, f"{len(rows)} rows of cells", f"the header says height {height}")
    for number, row in enumerate(rows, start=first + 1):
        if len(row) != width:
            raise MapError(
                f"{name}: line {number}", f"{len(row)} cells", f"the header says width {width}"
            )
    cells = np.frombuffer(b"".join(rows), dtype=np.uint8).reshape(height, width)[::-1]
    filled = np.isin(cells, np.frombuffer(_FILLED, dtype=np.uint8))
    known = filled | np.isin(cells, np.frombuffer(_FREE, dtype=np.uint8))
    if not known.all():
        row_up, column = np.argwhere(~known)[0]
        raise MapError(
            f"{name}: line {first + height - int(row_up)}",
            f"unknown terrain {chr(cells[row_up, column])!r}",
            "terrain is one of . G S @ O T W",
        )
    if filled.all():
        raise MapError(name, "every cell is a wall", "ground is . G or S")
    return grid_map(filled, GridFrame(0.0, 0.0, 0.0, cell), name)


def _header(name: str, lines: list[bytes]) -> tuple[int, int, int]:
    """Width, height and the number of the first line of cells; the line `type` may be missing."""
    sizes: dict[str, int] = {}
    for number, line in enumerate(lines):
        words = line.decode("ascii", "replace").split()
        if words == ["map"]:
            missing = [key for key in ("width", "height") if key not in sizes]
            if missing:
                raise MapError(name, f"no {missing[0]}", f"a line `{missing[0]} N` before `map`")
            return sizes["width"], sizes["height"], number + 1
        if len(words) == 2 and words[0] in ("width", "height"):
            sizes[words[0]] = _size(f"{name}: line {number + 1}", words)
        elif words and words[0] != "type":
            raise MapError(
                f"{name}: line {number + 1}",
                f"{' '.join(words)[:40]!r} in the header",
                "lines `type octile`, `width N`, `height N`, then `map`",
            )
    raise MapError(name, "no line `map`", "a MovingAI grid: type, height, width, map, rows of cells")


def _size(where: str, words: list[str]) -> int:
    digits = words[1] if words[1].isascii() and words[1].isdigit() and len(words[1]) < 10 else "0"
    value = int(digits)
    if not 0 < value <= _LARGEST:
        raise MapError(where, f"{words[0]} {words[1][:20]!r}", "a whole number of cells above 0")
    return value
