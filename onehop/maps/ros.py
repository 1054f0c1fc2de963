"""Maps of ROS map_server: a YAML file that says how to read an image.

The occupancy of each pixel is what nav2_map_server's map_io.cpp of 2026 makes of it. Where that is
unknown, or between free and occupied, the ground truth must decide: a cell is a wall when it is unknown
(nobody has seen that it is free) or at least half occupied.
"""

import unicodedata
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from onehop.contracts.arrays import BoolArray
from onehop.contracts.errors import MapError
from onehop.contracts.ranges import Range
from onehop.maps.grid import GridFrame, grid_map
from onehop.maps.image import read_image
from onehop.maps.map_yaml import MapYaml
from onehop.maps.picture import Picture
from onehop.maps.walls import WallMap

_MODES = ("trinary", "scale", "raw")

_UNKNOWN, _FREE, _OCCUPIED = -1, 0, 100
"""Occupancy in per cent, and what stands for unknown (nav_msgs/OccupancyGrid)."""

_WALL = 50
"""Occupancy from which on a cell is a wall."""

_RESOLUTION = Range(1e-3, 1e3)
"""Metres a pixel."""

_SHARE = Range(0.0, 1.0)

_COORDINATE, _YAW = Range(-1e7, 1e7), Range(-1e3, 1e3)
"""Of the origin [m] (UTM northings reach 1e7) and its turn [rad]."""


_LONGEST_NAME = 4095
"""Characters of an image's name (PATH_MAX of Linux)."""

_NOT_NAMED = ("Cc", "Cf", "Cs", "Zl", "Zp")
"""Unicode categories that no file name has: control signs, halves of surrogate pairs, line ends."""


class _Settings(NamedTuple):
    image: str
    frame: GridFrame
    mode: str
    negate: bool
    occupied: float
    free: float


def ros_image(name: str, content: bytes) -> str:
    """Name of the image that a map's YAML file refers to, as written there. Raises MapError."""
    return _settings(name, content).image


def ros_map(name: str, content: bytes, image: bytes) -> WallMap:
    """The map of a YAML file and its image. Raises MapError."""
    settings = _settings(name, content)
    picture = read_image(settings.image, image)
    filled = _filled(settings, picture)
    reading = _reading(settings, picture)
    if filled.all():
        raise MapError(f"{name}: mode", f"every pixel of {settings.image} is a wall or unknown", reading)
    free = 100.0 * (1.0 - np.count_nonzero(filled) / filled.size)
    reading = f"{free:.2g} % of {settings.image} is free; {reading}"
    return grid_map(filled[::-1], settings.frame, name, reading)


def _reading(settings: _Settings, picture: Picture) -> str:
    """Which pixels are free, for people: a map without free ground was mostly read wrongly."""
    share = "grey / 255" if settings.negate else "1 - grey / 255"
    rule = {
        "raw": f"grey < {_WALL}",
        "trinary": f"{share} <= free_thresh {settings.free:g}",
        "scale": f"{share} < {0.5 * (settings.free + settings.occupied):g}",
    }[settings.mode]
    opaque = " and opaque" if picture.alpha is not None and settings.mode != "raw" else ""
    negate = "" if settings.mode == "raw" else f", negate {int(settings.negate)}"
    greys = f"greys from {picture.grey.min()} to {picture.grey.max()}"
    return f"by mode {settings.mode}{negate} a pixel is free where {rule}{opaque}, and it has {greys}"


def _filled(settings: _Settings, picture: Picture) -> BoolArray:
    """Which pixels are walls, (rows, columns), row 0 at the top."""
    occupancy = _occupancy(settings)
    filled: BoolArray = ((occupancy == _UNKNOWN) | (occupancy >= _WALL))[picture.grey]
    if picture.alpha is not None and settings.mode != "raw":
        filled |= picture.alpha < 255
    return filled


def _occupancy(settings: _Settings) -> npt.NDArray[np.int16]:
    """Occupancy of an opaque pixel by its grey, (256,) in per cent, in nav2's single precision."""
    grey = np.arange(256, dtype=np.float32)
    if settings.mode == "raw":
        return np.where(grey <= _OCCUPIED, grey, _UNKNOWN).astype(np.int16)
    brightness = grey / np.float32(255.0)
    share = brightness if settings.negate else np.float32(1.0) - brightness
    free, occupied = np.float32(settings.free), np.float32(settings.occupied)
    values = np.full(256, _UNKNOWN, dtype=np.int16)
    values[share >= occupied] = _OCCUPIED
    values[share <= free] = _FREE
    if settings.mode == "scale":
        between = (share > free) & (share < occupied)
        part = (share[between] - free) / np.float32(settings.occupied - settings.free)
        values[between] = np.floor(part * np.float32(_OCCUPIED) + np.float32(0.5))
    return values


def _settings(name: str, content: bytes) -> _Settings:
    keys = MapYaml(name, content)
    image = keys.text("image")
    if not 0 < len(image) <= _LONGEST_NAME or any(
        unicodedata.category(sign) in _NOT_NAMED for sign in image
    ):
        raise keys.refusal(
            "image", f"{image[:40]!a} is no file name", "the name of a PGM, PNG or BMP file"
        )
    mode = keys.text("mode", "trinary")
    if mode.lower() not in _MODES:
        raise keys.refusal("mode", ascii(mode[:40]), f"one of {', '.join(_MODES)}")
    negate = keys.flag("negate")
    free = keys.number("free_thresh", _SHARE, "the occupancy up to which a cell is free")
    occupied = keys.number("occupied_thresh", _SHARE, "the occupancy from which on it is a wall")
    if not free < occupied:
        raise keys.refusal(
            "free_thresh",
            f"{free:g} is not below occupied_thresh {occupied:g}",
            "free_thresh < occupied_thresh",
        )
    return _Settings(image, _frame(keys), mode.lower(), negate, occupied, free)


def _frame(keys: MapYaml) -> GridFrame:
    cell = keys.number("resolution", _RESOLUTION, "metres a pixel")
    x, y, yaw = keys.numbers(
        "origin", (_COORDINATE, _COORDINATE, _YAW), "[x, y, yaw] of the lower left pixel in m, m, rad"
    )
    return GridFrame(x, y, yaw, cell)
