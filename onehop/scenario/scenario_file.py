"""Read a scenario file: TOML and its map's files, into validated frozen values.

Every wrong key, type, value or unreachable file ends in one ScenarioError that names file and key and
says what would be right. The world's own checks (a start inside an obstacle) come when it is built.
"""

import errno
import math
import stat
import tomllib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from onehop.contracts.errors import ScenarioError
from onehop.maps.map_file import LARGEST_FILE, map_files
from onehop.plugins import check_names
from onehop.scenario.bundle import Bundle
from onehop.scenario.changes import Change, apply_change
from onehop.scenario.link_trace import link_trace
from onehop.scenario.structure import structure


def load(
    path: Path,
    settings: Iterable[str | Change] = (),
    seed: int | None = None,
    map_file: Path | None = None,
    start: tuple[float, float] | None = None,
    goal: tuple[float, float] | None = None,
) -> Bundle:
    """The mission in `path`, with what the command line changed.

    settings: "key.path=value", value as TOML, or the same as a Change. Raises ScenarioError.
    """
    table = _read_toml(path)
    directory = path.parent
    if map_file is not None:
        directory = map_file.parent
        if map_file.suffix == ".toml":
            table["map"] = _read_toml(map_file).get("map", {})
        else:
            kept = {"cell": table.get("map", {}).get("cell", 1.0)}
            table["map"] = {**kept, "file": map_file.name}
        table.pop("start", None)
    if start is not None:
        table["start"] = {"x": start[0], "y": start[1]}
    if goal is not None:
        table["goal"] = {**table.get("goal", {}), "x": goal[0], "y": goal[1]}
    if seed is not None:
        table["seed"] = seed
    for setting in settings:
        apply_change(table, setting)
    table.setdefault("name", path.stem)
    scenario = structure(table, str(path))
    check_names(scenario, str(path))
    files = _read_map_files(scenario.map.file, directory, str(path))
    bundle = Bundle(scenario, files, str((path.parent / scenario.programs).absolute()))
    return _with_links(bundle, path.parent, str(path))


@contextmanager
def in_file(path: Path) -> Iterator[None]:
    """Say the scenario's file with what the world finds wrong with its values."""
    try:
        yield
    except ScenarioError as error:
        if error.where.startswith(str(path)):
            raise
        raise ScenarioError(f"{path}: {error.where}", error.problem, error.remedy) from None


def point(text: str | None, option: str) -> tuple[float, float] | None:
    """The value of --start or --goal, "x,y" in metres. Raises ScenarioError."""
    if text is None:
        return None
    try:
        x, y = (float(part) for part in text.split(","))
        if not (abs(x) < math.inf and abs(y) < math.inf):
            raise ValueError
    except ValueError:
        raise ScenarioError(f"{option} {text}", "not a point", "x,y in metres, e.g. 10,12.5") from None
    return x, y


def load_map_mission(
    map_file: Path,
    start: tuple[float, float] | None,
    goal: tuple[float, float] | None,
    settings: Iterable[str],
    seed: int | None,
) -> Bundle:
    """A mission on a bare map, or on that of a scenario, with defaults for the rest.

    Raises ScenarioError; a bare map needs start and goal.
    """
    if map_file.suffix == ".toml":
        return load(map_file, settings, seed, None, start, goal)
    if start is None or goal is None:
        raise ScenarioError(str(map_file), "a bare map", "give --start x,y and --goal x,y")
    table: dict[str, Any] = {
        "name": map_file.stem,
        "map": {"file": map_file.name},
        "start": {"x": start[0], "y": start[1]},
        "goal": {"x": goal[0], "y": goal[1]},
    }
    if seed is not None:
        table["seed"] = seed
    for setting in settings:
        apply_change(table, setting)
    scenario = structure(table, str(map_file))
    check_names(scenario, str(map_file))
    files = _read_map_files(scenario.map.file, map_file.parent, str(map_file))
    return _with_links(Bundle(scenario, files), map_file.parent, str(map_file))


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise ScenarioError(
            str(path), error.strerror or "cannot be read", "name a scenario file that exists"
        ) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ScenarioError(str(path), f"not TOML ({error})", "see scenarios/map1.toml") from None
    except ValueError:  # Python's int() of thousands of digits
        raise ScenarioError(
            str(path), "holds a whole number of thousands of digits", "whole numbers below 2^63"
        ) from None
    except RecursionError:
        raise ScenarioError(str(path), "nested too deeply", "see scenarios/map1.toml") from None


def _with_links(bundle: Bundle, directory: Path, origin: str) -> Bundle:
    """The mission with its trace of measured links, which has been checked."""
    name = bundle.scenario.radio.links
    if not name:
        return bundle
    kinds = "a CSV file of measured links (docs/link-traces.md)"
    content = _read_file(directory / name, f"{origin}: radio.links", kinds)
    whole = replace(bundle, files={**bundle.files, name: content})
    link_trace(whole, origin)
    return whole


def _read_map_files(name: str, directory: Path, origin: str) -> dict[str, bytes]:
    """The map's file and those that it names, by their names; relative ones lie beside it."""
    if not name:
        return {}
    location = directory / name
    kinds = "a ROS map .yaml, a MovingAI .map, or polygons in the scenario"
    files = {name: _read_file(location, f"{origin}: map.file", kinds)}
    for further in map_files(name, files[name]):
        remedy = f"an image that exists, named absolutely or from the folder of {location.name}"
        files[further] = _read_file(location.parent / further, f"{location}: image", remedy)
    return files


def _read_file(location: Path, where: str, remedy: str) -> bytes:
    shown = str(location) if str(location).isprintable() else ascii(str(location))
    try:
        if not stat.S_ISREG(location.stat().st_mode):
            raise OSError(errno.EINVAL, "not a regular file")
        with location.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = (isinstance(error, OSError) and error.strerror) or "cannot be read"
        raise ScenarioError(where, f"{shown}: {reason}", remedy) from None
    if len(content) > LARGEST_FILE:
        raise ScenarioError(where, f"{shown}: larger than {LARGEST_FILE} bytes", "a smaller file")
    return content
