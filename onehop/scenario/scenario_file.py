"""Read a scenario file: TOML and its map's files, into validated frozen values.

Every wrong key, type, value or unreachable file ends in one ScenarioError that names file and key and
says what would be right. The world's own checks (a start inside an obstacle) come when it is built.
"""

import difflib
import json
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import cattrs
from cattrs import AttributeValidationNote, IterableValidationNote

from onehop.contracts.errors import ScenarioError
from onehop.contracts.scenario import Scenario
from onehop.maps.map_file import map_files


@dataclass(frozen=True, slots=True)
class Bundle:
    """Everything that a mission is made from: a scenario and the bytes of its map's files by name."""

    scenario: Scenario
    files: dict[str, bytes]

    def scenario_json(self) -> str:
        """The whole scenario with every default written out; `bundle_from_json` reads it back."""
        return json.dumps(asdict(self.scenario), indent=1)


class _MismatchError(ValueError):
    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(what)
        self.what = what
        self.remedy = remedy


_KIND_NAMES = {bool: "true or false", int: "a whole number", float: "a number", str: "a text in quotes"}


def _scalar(value: Any, kind: Any) -> Any:
    if kind is float and type(value) is int:
        return float(value)
    if type(value) is not kind:
        raise _MismatchError(f"{value!r:.60} is not {_KIND_NAMES[kind]}", f"give {_KIND_NAMES[kind]}")
    return value


def _is_literal(kind: Any) -> bool:
    return bool(get_origin(kind) == Literal)


def _choice(value: Any, kind: Any) -> Any:
    choices = get_args(kind)
    if value not in choices:
        raise _MismatchError(f"{value!r:.60} is unknown", f"one of {', '.join(map(repr, choices))}")
    return value


def _make_converter() -> cattrs.Converter:
    converter = cattrs.Converter(forbid_extra_keys=True)
    for kind in (bool, int, float, str):
        converter.register_structure_hook(kind, _scalar)
    converter.register_structure_hook_func(_is_literal, _choice)
    return converter


_CONVERTER = _make_converter()


def load(
    path: Path,
    settings: Iterable[str] = (),
    seed: int | None = None,
    map_file: Path | None = None,
    start: tuple[float, float] | None = None,
    goal: tuple[float, float] | None = None,
) -> Bundle:
    """The mission in `path`, with what the command line changed.

    settings: "key.path=value", value as TOML. Raises ScenarioError.
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
        _apply(table, setting)
    table.setdefault("name", path.stem)
    scenario = _structure(table, str(path))
    return Bundle(scenario, _read_map_files(scenario.map.file, directory, str(path)))


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
    except ValueError:
        raise ScenarioError(f"{option} {text}", "not a point", "x,y in metres, e.g. 10,12.5") from None
    return x, y


def bundle_from_json(text: str, files: Mapping[str, bytes], origin: str) -> Bundle:
    """The mission that a log carries as attachments. Raises ScenarioError."""
    try:
        table = json.loads(text)
    except ValueError as error:
        raise ScenarioError(origin, f"not JSON ({error})", "an attachment written by onehop") from None
    return Bundle(_structure(table, origin), dict(files))


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
        _apply(table, setting)
    scenario = _structure(table, str(map_file))
    return Bundle(scenario, _read_map_files(scenario.map.file, map_file.parent, str(map_file)))


def changed(scenario: Scenario, settings: Iterable[str]) -> Scenario:
    """The same scenario with some keys changed ("key.path=value"). Raises ScenarioError."""
    table = json.loads(json.dumps(asdict(scenario)))
    for setting in settings:
        _apply(table, setting)
    return _structure(table, "--set")


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_bytes().decode())
    except OSError as error:
        raise ScenarioError(
            str(path), error.strerror or "cannot be read", "name a scenario file that exists"
        ) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ScenarioError(str(path), f"not TOML ({error})", "see scenarios/map1.toml") from None


def _read_map_files(name: str, directory: Path, origin: str) -> dict[str, bytes]:
    files: dict[str, bytes] = {}
    wanted = [name] if name else []
    while wanted:
        current = wanted.pop()
        location = directory / current
        try:
            files[current] = location.read_bytes()
        except OSError as error:
            raise ScenarioError(
                f"{origin}: map.file",
                f"{location}: {error.strerror or 'cannot be read'}",
                "a ROS map .yaml, a MovingAI .map, or polygons in the scenario",
            ) from None
        wanted += [name for name in map_files(current, files[current]) if name not in files]
    return files


def _apply(table: dict[str, Any], setting: str) -> None:
    key, equals, text = setting.partition("=")
    path = key.strip().split(".")
    if not equals or not all(path):
        raise ScenarioError(f"--set {setting}", "not of the form key.path=value", "e.g. team.size=4")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text.strip()
    target: Any = table
    for step in path[:-1]:
        target = _child(target, step, setting)
    _child(target, path[-1], setting)
    target[int(path[-1]) if isinstance(target, list) else path[-1]] = value


def _child(target: Any, step: str, setting: str) -> Any:
    if isinstance(target, dict) and not step.isdigit():
        return target.setdefault(step, {})
    if isinstance(target, list) and step.isdigit() and int(step) < len(target):
        return target[int(step)]
    raise ScenarioError(f"--set {setting}", f"there is no key {step} to set", "see the scenario file")


def _structure(table: dict[str, Any], origin: str) -> Scenario:
    try:
        scenario = _CONVERTER.structure(table, Scenario)
    except cattrs.BaseValidationError as error:
        raise _first_mistake(error, origin, table) from None
    problem = next(scenario.problems(), None)
    if problem is not None:
        raise ScenarioError(f"{origin}: {problem.key}", problem.what, problem.remedy)
    return scenario


def _first_mistake(error: BaseException, origin: str, table: Any) -> ScenarioError:
    """The first leaf of cattrs' tree of errors, with its key path."""
    path: list[str] = []
    value = table
    while isinstance(error, cattrs.BaseValidationError):
        kind = error.cl
        error = error.exceptions[0]
        for note in getattr(error, "__notes__", ()):
            if isinstance(note, AttributeValidationNote):
                path.append(f".{note.name}")
                value = value.get(note.name) if isinstance(value, dict) else None
            elif isinstance(note, IterableValidationNote):
                path.append(f"[{note.index}]")
                value = value[int(note.index)] if isinstance(value, list) else None
        if isinstance(error, cattrs.ForbiddenExtraKeysError):
            unknown = sorted(error.extra_fields)[0]
            known = [f.name for f in fields(kind)]
            near = difflib.get_close_matches(unknown, known, 1)
            remedy = f"did you mean {near[0]}?" if near else f"known keys: {', '.join(known)}"
            return ScenarioError(_where(origin, [*path, f".{unknown}"]), "unknown key", remedy)
    where = _where(origin, path)
    if isinstance(error, _MismatchError):
        return ScenarioError(where, error.what, error.remedy)
    if isinstance(error, KeyError):
        return ScenarioError(where, "is missing", "every scenario has to give it")
    return ScenarioError(where, f"{value!r:.60} has the wrong form", "see scenarios/map1.toml")


def _where(origin: str, path: list[str]) -> str:
    key = "".join(path).lstrip(".")
    return f"{origin}: {key}" if key else origin
