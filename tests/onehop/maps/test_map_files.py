"""ROS and MovingAI map files, whole and malformed."""

import math
import os
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from onehop.contracts.errors import MapError
from onehop.contracts.sections import MapSection
from onehop.maps.grid import GridFrame, grid_map
from onehop.maps.map_file import load_map, map_files
from onehop.maps.walls import WallMap
from tests.onehop.maps.pictures import GREYS, YAML, cells, png, ros

MAPS = Path(os.environ.get("ONEHOP_MAPS", Path(__file__).parents[4] / "shared" / "maps"))
needs_maps = pytest.mark.skipif(not MAPS.is_dir(), reason="no folder of sample maps (ONEHOP_MAPS)")


def movingai(text: str, cell: float = 1.0) -> WallMap:
    return load_map(MapSection(file="m.map", cell=cell), {"m.map": text.encode()})


def test_a_ros_map_lies_at_its_origin_with_its_first_row_on_top() -> None:
    walls = ros()
    assert walls.bounds == (-1.0, -2.0, 0.5, -1.0)
    assert cells(walls) == [".xx", "..."]


def test_the_mode_is_trinary_unless_stated() -> None:
    assert cells(ros()) == cells(ros(YAML + "mode: trinary\n"))


@pytest.mark.parametrize(
    "image",
    [
        b"P2\n3 2\n255\n254 0 205\n254 254 254\n",
        b"P2 # one\n# two\n3 # three\n2 255\n254 0 205 # four\n254 254 254",
        b"P5 3 2 60000\n" + b"".join(struct.pack(">H", grey * 60000 // 255) for grey in GREYS),
        png([[(254,), (0,), (205,)], [(254,)] * 3], 0),
        png([[(254,) * 3, (0,) * 3, (205,) * 3], [(254,) * 3] * 3], 2),
    ],
    ids=["P2", "P2 with comments", "P5 of 16 bits", "grey PNG", "colour PNG"],
)
def test_the_same_picture_in_any_format_is_the_same_map(image: bytes) -> None:
    np.testing.assert_array_equal(ros(image=image).segments, ros().segments)


def test_the_origin_turns_the_map() -> None:
    walls = ros(YAML.replace("0.0]", f"{math.pi / 2}]"))
    assert walls.bounds == pytest.approx((-2.0, -2.0, -1.0, -0.5))
    assert not walls.is_free(-1.75, -1.25)
    assert walls.is_free(-1.75, -1.75)
    assert walls.is_free(-1.25, -1.25)


GRID = "type octile\nheight 2\nwidth 3\nmap\n.G@\nSTW\n"


def test_a_movingai_grid_has_its_first_row_on_top_and_its_corner_at_the_origin() -> None:
    walls = movingai(GRID)
    assert walls.bounds == (0.0, 0.0, 3.0, 2.0)
    assert cells(walls, 1.0) == ["..x", ".xx"]


@pytest.mark.parametrize(
    "text",
    [
        GRID.replace("type octile\n", ""),
        GRID.replace("height 2\nwidth 3", "width 3\nheight 2"),
        GRID.replace("\n", "\r\n"),
        GRID.rstrip("\n"),
        GRID + "\n",
        GRID.replace("@", "O"),
    ],
    ids=["no type line", "width first", "CRLF", "no last newline", "blank last line", "O for @"],
)
def test_movingai_variants_are_the_same_map(text: str) -> None:
    np.testing.assert_array_equal(movingai(text).segments, movingai(GRID).segments)


def test_cell_is_metres_a_cell() -> None:
    assert movingai(GRID, 0.25).bounds == (0.0, 0.0, 0.75, 0.5)


@pytest.mark.parametrize(
    ("text", "where", "problem"),
    [
        ("", "m.map", "no line `map`"),
        (GRID.replace("map\n", ""), "m.map: line 4", "'.G@' in the header"),
        (GRID.replace("height 2\n", ""), "m.map", "no height"),
        (GRID.replace("height 2", "height two"), "m.map: line 2", "height 'two'"),
        (GRID.replace("width 3", "width -3"), "m.map: line 3", "width '-3'"),
        (GRID.replace("height 2", "height 3"), "m.map", "2 rows"),
        (GRID + "...\n", "m.map", "3 rows"),
        (GRID.replace("STW", "STWW"), "m.map: line 6", "4 cells"),
        (GRID.replace("S", "q"), "m.map: line 6", "unknown terrain 'q'"),
        (GRID.replace("G", "\N{SNOWMAN}"), "m.map: line 5", "5 cells"),
    ],
)
def test_a_bad_grid_is_refused_by_line(text: str, where: str, problem: str) -> None:
    with pytest.raises(MapError) as refusal:
        movingai(text)
    assert refusal.value.where == where
    assert problem in refusal.value.problem
    assert "\n" not in str(refusal.value)


def test_an_unknown_kind_of_map_is_refused() -> None:
    with pytest.raises(MapError, match="no known kind of map"):
        load_map(MapSection(file="m.svg"), {"m.svg": b""})


def test_a_movingai_grid_needs_no_further_file() -> None:
    assert map_files("m.map", GRID.encode()) == ()


def test_edges_in_one_line_are_one_segment() -> None:
    filled = np.zeros((3, 4), dtype=np.bool_)
    filled[1, 1:3] = True
    walls = grid_map(filled, GridFrame(0.0, 0.0, 0.0, 1.0))
    assert len(walls.segments) == 8
    assert sorted(map(tuple, walls.segments[:, :].tolist()))[0] == (0.0, 0.0, 0.0, 3.0)


@given(arrays(np.bool_, st.tuples(st.integers(1, 9), st.integers(1, 9))), st.floats(-3.1, 3.1))
def test_segments_are_exactly_the_borders_of_the_cells(
    filled: np.ndarray[tuple[int, int], np.dtype[np.bool_]], yaw: float
) -> None:
    """Total length, and a wall within half a cell on each side of which exactly one cell is filled."""
    walls = grid_map(filled, GridFrame(3.0, -2.0, yaw, 0.5))
    closed = np.pad(filled, 1, constant_values=True)
    borders = (closed[:, 1:] != closed[:, :-1]).sum() + (closed[1:] != closed[:-1]).sum()
    run = walls.segments[:, 2:] - walls.segments[:, :2]
    length = np.hypot(run[:, 0], run[:, 1])
    assert length.sum() == pytest.approx(0.5 * borders)
    unit = run / length[:, None]
    normal = np.column_stack((-unit[:, 1], unit[:, 0]))
    for along in (0.25, -0.25):
        near = walls.segments[:, :2] if along > 0 else walls.segments[:, 2:]
        middle = near + along * unit
        left = walls.ground.solid(middle + 0.1 * normal)
        right = walls.ground.solid(middle - 0.1 * normal)
        assert (left != right).all()


@needs_maps
@pytest.mark.parametrize(
    ("name", "bounds"),
    [
        ("ros/depot.yaml", (0.0, 0.0, 30.2, 15.35)),
        ("ros/tb3_sandbox.yaml", (-10.0, -10.0, 9.2, 9.2)),
        ("movingai/arena.map", (0.0, 0.0, 49.0, 49.0)),
        ("movingai/den520d.map", (0.0, 0.0, 256.0, 257.0)),
        ("movingai/Paris_1_256.map", (0.0, 0.0, 256.0, 256.0)),
    ],
)
def test_sample_maps_are_read(name: str, bounds: tuple[float, ...]) -> None:
    content = (MAPS / name).read_bytes()
    files = {name: content}
    for further in map_files(name, content):
        files[further] = (MAPS / name).parent.joinpath(further).read_bytes()
    walls = load_map(MapSection(file=name), files)
    assert walls.bounds == pytest.approx(bounds)
    xmin, ymin, xmax, ymax = bounds
    places = np.random.default_rng(1).uniform((xmin, ymin), (xmax, ymax), (400, 2))
    share = walls.free(places).mean()
    assert 0.02 < share < 0.98
