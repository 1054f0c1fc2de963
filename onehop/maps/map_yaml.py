"""The YAML of map_server files with its values as yaml-cpp converts them, which ROS uses.

PyYAML alone would read 25e-2 as text and `no` as false; yaml-cpp goes by the text of a scalar, quoted or
not, and by the type that the program asks for. Every refusal is a MapError with file and key.
"""

import re

import yaml

from onehop.contracts.errors import MapError
from onehop.contracts.ranges import Range

_LARGEST = 1 << 16
"""Bytes of the largest YAML file that is read; map_saver writes 150."""

_DEEPEST = 50
"""Lists in lists; yaml-cpp stops at 500, Python's stack a little below."""

_DOUBLE = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?[ \t\n\r\f\v]*")
"""What `stream >> double` reads to its end (libstdc++): neither hex nor inf, nan or grouped digits."""

_INT = re.compile(r"[+-]?(?:0[xX][0-9a-fA-F]+|0[oO]?[0-7]+|0|[1-9][0-9]*)[ \t\n\r\f\v]*")
"""What `stream >> int` reads to its end when the base is free, as yaml-cpp sets it."""

_TRUE, _FALSE = ("y", "yes", "true", "on"), ("n", "no", "false", "off")
"""Words for a bool, in lower case, upper case or capitalized (yaml-cpp, convert.cpp)."""

_NULL = ("", "~", "null", "Null", "NULL")
"""Unquoted, these are no value."""


class MapYaml:
    """A map_server file: a table of keys. Keys that nobody asks for may hold anything."""

    def __init__(self, name: str, content: bytes) -> None:
        self._name = name
        self._nodes = _table(name, content)

    def text(self, key: str, default: str | None = None) -> str:
        """A text as it stands there. With a default, the key may be missing."""
        if default is not None and key not in self._nodes:
            return default
        node = self._node(key, "a name")
        text = _scalar(node)
        if text is None:
            raise self.refusal(key, _shown(node), "a name")
        return text

    def number(self, key: str, limits: Range, meaning: str) -> float:
        """A number within its limits; meaning: what it is, for people."""
        node = self._node(key, meaning)
        value = _double(node)
        if value is None:
            raise self.refusal(key, f"{_shown(node)} is no number", meaning)
        if not limits.least <= value <= limits.most:
            raise self.refusal(key, f"{_shown(node)} is out of range", f"{meaning}, from {limits}")
        return value

    def numbers(self, key: str, limits: tuple[Range, ...], meaning: str) -> list[float]:
        """A list of as many numbers as there are limits."""
        node = self._node(key, meaning)
        parts = node.value if isinstance(node, yaml.SequenceNode) else []
        values = [_double(part) for part in parts]
        if len(values) != len(limits) or None in values:
            raise self.refusal(key, _shown(node), meaning)
        numbers = [value for value in values if value is not None]
        for value, (least, most) in zip(numbers, limits, strict=True):
            if not least <= value <= most:
                raise self.refusal(
                    key,
                    f"{_shown(node)}: {value:g} is out of range",
                    f"{meaning}, {least:g} to {most:g}",
                )
        return numbers

    def flag(self, key: str) -> bool:
        """A whole number, true unless 0, or a word for true or false."""
        node = self._node(key, "0 or 1")
        text = _scalar(node) or ""
        if _INT.fullmatch(text) and len(text) < 20:
            value = _int(text)
            if -(2**31) <= value < 2**31:
                return value != 0
        if text in (text.lower(), text.upper(), text.capitalize()) and text.lower() in _TRUE + _FALSE:
            return text.lower() in _TRUE
        raise self.refusal(key, _shown(node), "0 or 1")

    def refusal(self, key: str, problem: str, remedy: str) -> MapError:
        """The error that says what is wrong with a key."""
        return MapError(f"{self._name}: {key}", problem, remedy)

    def _node(self, key: str, meaning: str) -> yaml.Node:
        if key not in self._nodes:
            raise self.refusal(key, "missing", meaning)
        return self._nodes[key]


class _Loader(yaml.BaseLoader):
    """Nodes with their texts, bounded depth, and tabs where yaml-cpp takes them: not as indentation."""

    def __init__(self, content: bytes) -> None:
        super().__init__(content)
        self.depth = 0
        self.tab_line = -1

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        self.depth += 1
        if self.depth > _DEEPEST:
            raise yaml.MarkedYAMLError(
                problem=f"lists in lists, more than {_DEEPEST} deep", problem_mark=self.get_mark()
            )
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def scan_to_next_token(self) -> None:
        super().scan_to_next_token()
        while self.peek() == "\t":
            if not self.flow_level:
                self.allow_simple_key = False
                self.tab_line = self.line
            while self.peek() in " \t":
                self.forward()
            super().scan_to_next_token()


def _table(name: str, content: bytes) -> dict[str, yaml.Node]:
    if len(content) > _LARGEST:
        raise MapError(name, f"{len(content)} bytes", f"a map_server YAML file of at most {_LARGEST}")
    root = _first_document(name, content)
    if not isinstance(root, yaml.MappingNode):
        raise MapError(name, "not a table of keys", "keys image, resolution, origin, ...")
    nodes: dict[str, yaml.Node] = {}
    lines: dict[str, int] = {}
    for key_node, node in root.value:
        key = _scalar(key_node)
        if key is None:
            continue
        line = key_node.start_mark.line + 1
        if key in nodes:
            raise MapError(
                f"{name}: {ascii(key)[1:-1][:40]}",
                f"stands in line {lines[key]} and again in line {line}",
                "every key once",
            )
        nodes[key], lines[key] = node, line
    return nodes


def _first_document(name: str, content: bytes) -> yaml.Node | None:
    """Whatever follows the first document is not read, as by yaml-cpp."""
    try:
        loader = _Loader(content)
    except (yaml.YAMLError, ValueError) as error:
        raise MapError(name, f"not YAML ({_short(error)})", "a map_server YAML file") from None
    try:
        return loader.get_node() if loader.check_node() else None
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line if error.problem_mark else loader.line
        tab = f"a tab in line {line + 1}: " if line == loader.tab_line else ""
        problem = f"not YAML ({tab}{error.problem or _short(error)}, line {line + 1})"
        remedy = "indent with spaces" if tab else "a map_server YAML file"
        raise MapError(name, problem, remedy) from None
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        raise MapError(
            name, f"not YAML ({_short(error)}, line {loader.line + 1})", "a map_server YAML file"
        ) from None
    finally:
        loader.dispose()


def _scalar(node: yaml.Node) -> str | None:
    """The text of a scalar, None for a list, a table or no value."""
    if not isinstance(node, yaml.ScalarNode) or (node.style is None and node.value in _NULL):
        return None
    return str(node.value)


def _double(node: yaml.Node) -> float | None:
    text = _scalar(node) or ""
    return float(text) if _DOUBLE.fullmatch(text) else None


def _int(text: str) -> int:
    """Whole numbers with the prefixes of C: 0x is 16, 0 (and 0o) 8."""
    sign, digits = (-1, text[1:]) if text[0] == "-" else (1, text.removeprefix("+"))
    digits = digits.lower().rstrip()
    if digits.startswith("0x"):
        return sign * int(digits, 16)
    return sign * (int(digits.replace("o", ""), 8) if digits.startswith("0") else int(digits))


def _shown(node: yaml.Node) -> str:
    """What stands there, short and in one line."""
    if isinstance(node, yaml.ScalarNode):
        return ascii(node.value[:40]) if _scalar(node) is not None else "no value"
    if isinstance(node, yaml.SequenceNode):
        parts = [
            str(part.value) if isinstance(part, yaml.ScalarNode) else "..." for part in node.value[:5]
        ]
        return ascii(f"[{', '.join(parts)}]"[:60])[1:-1]
    return "a table"


def _short(error: Exception) -> str:
    return " ".join(str(error).split())[:100]
