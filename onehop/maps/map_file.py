"""Which map a scenario means: polygons of its own, a ROS map or a MovingAI grid.

Works on bytes only: whoever has files asks `map_files` for the names of further files, and hands all
contents to `load_map`.
"""

from collections.abc import Mapping

from onehop.contracts.errors import MapError
from onehop.contracts.sections import MapSection
from onehop.maps.movingai import movingai_map
from onehop.maps.polygons import polygon_map
from onehop.maps.walls import WallMap

LARGEST_FILE = 1 << 28
"""Bytes of the largest file of a map that is read: a picture of the largest size as text."""


def map_files(name: str, content: bytes) -> tuple[str, ...]:
    """Names, as the map file itself writes them, of further files that the map `name` needs.

    Raises MapError when the file cannot be read that far.
    """
    if not _is_ros(name):
        return ()
    from onehop.maps.ros import (
        ros_image,
    )  # libraries of 40 ms that missions without pictures do not need

    return (ros_image(name, content),)


def load_map(section: MapSection, files: Mapping[str, bytes]) -> WallMap:
    """The ground truth of a scenario's map.

    files: contents by name: section.file and, under the names that map_files gave, what belongs to it.
    Raises MapError: file, what is wrong, what would be right.
    """
    if not section.file:
        return polygon_map(section)
    content = _content(files, section.file)
    if _is_ros(section.file):
        from onehop.maps.ros import ros_image, ros_map

        image = ros_image(section.file, content)
        return ros_map(section.file, content, _content(files, image))
    if section.file.endswith(".map"):
        return movingai_map(section.file, content, section.cell)
    raise MapError(
        section.file, "no known kind of map", "a ROS map ends in .yaml, a MovingAI grid in .map"
    )


def _content(files: Mapping[str, bytes], name: str) -> bytes:
    if name not in files:
        raise MapError(name, "missing", "a log or a scenario brings all files of its map")
    return files[name]


def _is_ros(name: str) -> bool:
    return name.endswith((".yaml", ".yml"))
