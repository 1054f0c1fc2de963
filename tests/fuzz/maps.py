"""Map files: ROS with each kind of picture, MovingAI grids; one leader drives on what is accepted."""

import contextlib
import io
from pathlib import Path
from random import Random

from onehop.commands.plan import plan
from tests.fuzz.commands import call
from tests.fuzz.damage import damaged
from tests.onehop.maps.pictures import YAML, encoded
from tests.onehop.maps.test_hostile_maps import GRID as SMALL_GRID
from tests.onehop.maps.test_hostile_maps import PICTURES as SMALL_PICTURES

_SIZE = 24
"""Cells along each side of the good maps."""

_OPEN, _WALL = 254, 0
_CELLS = [
    [_WALL if y in (0, _SIZE - 1) or (x, y // 6) == (12, 1) else _OPEN for x in range(_SIZE)]
    for y in range(_SIZE)
]
_HEADER = f"{_SIZE} {_SIZE}\n255\n".encode()
_FLAT = [grey for row in _CELLS for grey in row]

PICTURES = (
    b"P5\n# made by a mapper\n" + _HEADER + bytes(_FLAT),
    b"P2\n" + _HEADER + b" ".join(b"%d" % grey for grey in _FLAT),
    encoded(_CELLS, "L", "PNG"),
    encoded([[(grey, grey, grey) for grey in row] for row in _CELLS], "RGB", "PNG"),
    encoded([[(grey, grey, grey, 255) for grey in row] for row in _CELLS], "RGBA", "PNG"),
    encoded(_CELLS, "L", "BMP"),
)
GRID = f"type octile\nheight {_SIZE}\nwidth {_SIZE}\nmap\n".encode() + b"".join(
    bytes(ord("@") if grey == _WALL else ord(".") for grey in row) + b"\n" for row in _CELLS
)
DESCRIPTIONS = tuple(
    YAML.replace("-1.0, -2.0", "0.0, 0.0").encode() + extra
    for extra in (b"", b"mode: scale\n", b"mode: raw\n", b"mode: trinary\n")
)


def make(folder: Path, random: Random) -> None:
    """Write m.yaml and m.pgm, or m.map; one of the files is damaged, or both."""
    grid, yaml, picture = GRID, random.choice(DESCRIPTIONS), random.choice(PICTURES)
    what = random.randrange(8)
    if what < 2:
        (folder / "m.map").write_bytes(damaged(grid, (grid, SMALL_GRID), random))
        return
    if what != 2:
        picture = damaged(picture, (*PICTURES, *SMALL_PICTURES), random)
    if what < 5:
        yaml = damaged(yaml, (*DESCRIPTIONS, GRID), random)
    (folder / "m.yaml").write_bytes(yaml)
    (folder / "m.pgm").write_bytes(picture)


def load_kernels(folder: Path) -> None:
    """Plan a way on each good kind of map here, so that no case has to load what that takes."""
    files = {"m.map": GRID, "m.yaml": DESCRIPTIONS[0], "m.pgm": PICTURES[0]}
    for name, content in files.items():
        (folder / name).write_bytes(content)
    for name in ("m.map", "m.yaml"):
        with contextlib.redirect_stdout(io.StringIO()):
            plan(folder / name, "3,6", "9,6", None, None, None, ["clock.limit_s=0.15"], None, True)


def read(folder: Path) -> None:
    """Plan a way on the map for a few ticks."""
    name = next(name for name in ("m.map", "m.yaml") if (folder / name).exists())
    cell = ("--cell", 0.5) if name == "m.map" else ()
    places = ("--start", "3,6", "--goal", "9,6", "--set", "clock.limit_s=0.15")
    call(folder, "plan", folder / name, *places, *cell, "--json")
