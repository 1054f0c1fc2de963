"""Maps of ROS map_server: a YAML file that says how to read an image.

Follows nav2_map_server (map_io): brightness is the mean of the colour channels, and in trinary mode of
the inverted alpha channel too; occupancy is 1 - brightness, or brightness with negate; mode trinary
unless stated. Where it yields unknown, or an occupancy between free and occupied, the ground truth must
decide: a cell is a wall when it is unknown (nobody has seen that it is free) or at least half occupied.
"""

import math
from typing import NamedTuple

import numpy as np
import yaml

from onehop.contracts.arrays import BoolArray, FloatArray
from onehop.contracts.errors import MapError
from onehop.maps.grid import GridFrame, grid_map
from onehop.maps.image import Image, read_image
from onehop.maps.walls import WallMap

_MODES = ("trinary", "scale", "raw")
_RAW_FULL = 100
"""Occupancy of a full cell in raw mode; larger values mean unknown (nav_msgs/OccupancyGrid)."""


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
    return grid_map(_filled(settings, picture)[::-1], settings.frame)


def _filled(settings: _Settings, picture: Image) -> BoolArray:
    """Which pixels are walls, (rows, columns), row 0 at the top."""
    transparent = picture.alpha is not None
    brightness = picture.colours.mean(axis=2)
    if settings.mode == "trinary" and picture.alpha is not None:
        channels = picture.colours.shape[2]
        brightness = (brightness * channels + 1.0 - picture.alpha) / (channels + 1)
    if settings.mode == "raw":
        value: FloatArray = np.round(brightness * 255.0)
        return np.asarray(value >= _RAW_FULL / 2)
    occupancy = brightness if settings.negate else 1.0 - brightness
    if settings.mode == "trinary":
        return np.asarray(occupancy >= settings.free)
    halfway = 0.5 * (settings.free + settings.occupied)
    filled: BoolArray = occupancy >= halfway
    if transparent:
        filled = filled | (picture.alpha != 1.0)
    return filled


def _settings(name: str, content: bytes) -> _Settings:
    try:
        document = yaml.safe_load(content)
    except yaml.YAMLError as error:
        raise MapError(name, f"not YAML ({_first_line(error)})", "a map_server YAML file") from None
    if not isinstance(document, dict):
        raise MapError(name, "not a table of keys", "keys image, resolution, origin, ...")
    image = document.get("image")
    if not isinstance(image, str) or not image:
        raise MapError(f"{name}: image", f"{image!r}", "the name of a .pgm or .png file")
    mode = document.get("mode", "trinary")
    if mode not in _MODES:
        raise MapError(f"{name}: mode", f"{mode!r}", f"one of {', '.join(_MODES)}")
    negate = document.get("negate", 0)
    if negate not in (0, 1):
        raise MapError(f"{name}: negate", f"{negate!r}", "0 or 1")
    free = _number(name, document, "free_thresh", 0.25)
    occupied = _number(name, document, "occupied_thresh", 0.65)
    if not 0.0 <= free < occupied <= 1.0:
        raise MapError(
            f"{name}: free_thresh",
            f"free_thresh {free} and occupied_thresh {occupied}",
            "0 <= free_thresh < occupied_thresh <= 1",
        )
    return _Settings(image, _frame(name, document), mode, bool(negate), occupied, free)


def _frame(name: str, document: dict[str, object]) -> GridFrame:
    cell = _number(name, document, "resolution", None)
    if not cell > 0.0:
        raise MapError(f"{name}: resolution", f"{cell}", "metres a pixel, above 0")
    origin = document.get("origin")
    if (
        not isinstance(origin, list)
        or len(origin) != 3
        or not all(isinstance(part, int | float) and math.isfinite(part) for part in origin)
    ):
        raise MapError(f"{name}: origin", f"{origin!r}", "[x, y, yaw] of the lower left pixel")
    return GridFrame(float(origin[0]), float(origin[1]), float(origin[2]), cell)


def _number(name: str, document: dict[str, object], key: str, default: float | None) -> float:
    value = document.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise MapError(f"{name}: {key}", f"{value!r}", "a number")
    return float(value)


def _first_line(error: Exception) -> str:
    return str(error).splitlines()[0]
