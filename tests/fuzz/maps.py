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

_KEYS = {
    "resolution": ("0.5", "1e-3", "5", "1e3", "0.25"),
    "origin": ("[0.0, 0.0, 0.0]", "[-1, -1, 0]", "[0, 0, 1.5]", "[2e6, 0, 0]", "[0, 0]"),
    "negate": ("0", "1", "true"),
    "occupied_thresh": ("0.65", "0", "1", "0.196"),
    "free_thresh": ("0.196", "0", "1", "0.65"),
    "mode": ("trinary", "scale", "raw", "other"),
}
"""What a description may say: most of it is sound."""


def make(folder: Path, random: Random) -> None:
    """Write m.map, or m.yaml and m.pgm: as a mapper could make them, most of them damaged after that."""
    if random.random() < 0.3:
        grid = _repainted(GRID, b".G@STWO", random)
        if random.random() < 0.6:
            grid = damaged(grid, (GRID, SMALL_GRID), random)
        (folder / "m.map").write_bytes(grid)
        return
    lines = {"image": "m.pgm", **{key: values[0] for key, values in _KEYS.items()}}
    for key in random.sample(list(_KEYS), random.choice((0, 1, 1, 3))):
        lines[key] = random.choice(_KEYS[key])
    yaml = "".join(f"{key}: {value}\n" for key, value in lines.items()).encode()
    picture = random.choice(PICTURES)
    if random.random() < 0.5:
        picture = _repainted(PICTURES[0], bytes(range(256)), random)
    if random.random() < 0.3:
        picture = damaged(picture, (*PICTURES, *SMALL_PICTURES), random)
    if random.random() < 0.3:
        yaml = damaged(yaml, (yaml, YAML.encode(), GRID), random)
    (folder / "m.yaml").write_bytes(yaml)
    (folder / "m.pgm").write_bytes(picture)


def _repainted(data: bytes, colours: bytes, random: Random) -> bytes:
    """A picture, or a grid, with other cells; its header and its lines stay."""
    changed, header = bytearray(data), len(data) - _SIZE * _SIZE
    for _ in range(random.choice((1, 10, 300))):
        place = random.randrange(header, len(data))
        if changed[place] != ord("\n"):
            changed[place] = random.choice(colours)
    return bytes(changed)


def load_kernels(folder: Path) -> None:
    """Plan a way on each good kind of map here, so that no case has to load what that takes."""
    files = {"m.map": GRID, "m.yaml": YAML.encode(), "m.pgm": PICTURES[0]}
    for name, content in files.items():
        (folder / name).write_bytes(content)
    for name in ("m.map", "m.yaml"):
        with contextlib.redirect_stdout(io.StringIO()):
            keys = ["clock.limit_s=0.15"]
            plan(folder / name, "3,6", "9,6", None, None, None, keys, None, None, as_json=True)


def read(folder: Path) -> None:
    """Plan a way on the map for a few ticks."""
    name = next(name for name in ("m.map", "m.yaml") if (folder / name).exists())
    cell = ("--cell", 0.5) if name == "m.map" else ()
    places = ("--start", "3,6", "--goal", "9,6", "--set", "clock.limit_s=0.15")
    call(folder, "plan", folder / name, *places, *cell, "--json")
