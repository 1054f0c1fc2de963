"""The wire format: frozen contract values as msgpack maps, decoded strictly.

Every message is a map that starts with the schema version. Decoding refuses another version by name,
an unknown or missing key, and a value of another type: nothing is coerced. Arrays of laser ranges
travel as little-endian float32 bytes.
"""

import operator
import types
from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar, Union, cast, get_args, get_origin

import cattrs
import msgpack
import numpy as np
from cattrs.gen import make_dict_structure_fn, make_dict_unstructure_fn

from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import WIRE_VERSION, Fate, Ranges
from onehop.contracts.team import Mode, Shape

M = TypeVar("M")

_WIRE_FLOAT = np.dtype("<f4")


def _exactly(kind: type) -> Callable[[Any, Any], Any]:
    def structure(value: Any, _: Any) -> Any:
        if type(value) is not kind:
            raise TypeError(f"{value!r:.40} is not of type {kind.__name__}")
        return value

    return structure


def _structure_ranges(value: Any, _: Any) -> Ranges:
    if type(value) is not bytes or len(value) % _WIRE_FLOAT.itemsize:
        raise TypeError("ranges are not a byte string of float32")
    return np.frombuffer(value, dtype=_WIRE_FLOAT)


def _unstructure_ranges(value: Ranges) -> bytes:
    return value.astype(_WIRE_FLOAT, copy=False).tobytes()


def _is_array(kind: Any) -> bool:
    return kind is np.ndarray or get_origin(kind) is np.ndarray


def _is_tuple(kind: Any) -> bool:
    return get_origin(kind) is tuple


def _is_note_value(kind: Any) -> bool:
    return get_origin(kind) in (Union, types.UnionType) and set(get_args(kind)) == {
        int,
        float,
        str,
        tuple[int, ...],
    }


def _structure_note_value(value: Any, _: Any) -> Any:
    if type(value) in (int, float, str):
        return value
    if type(value) is list and all(type(item) is int for item in value):
        return tuple(value)
    raise TypeError(f"{value!r:.40} is not a note's value")


def _structure_list_as_tuple(converter: cattrs.Converter, kind: Any) -> Callable[[Any, Any], Any]:
    """Fixed and open tuples come from msgpack lists and from nothing else."""
    arguments = get_args(kind)
    if len(arguments) == 2 and arguments[1] is Ellipsis:
        item_kind = arguments[0]
        item = converter.get_structure_hook(item_kind)

        def structure_open(value: Any, _: Any) -> Any:
            if type(value) is not list:
                raise TypeError(f"{value!r:.40} is not a list")
            return tuple([item(element, item_kind) for element in value])

        return structure_open
    items = [(converter.get_structure_hook(a), a) for a in arguments]

    def structure_fixed(value: Any, _: Any) -> Any:
        if type(value) is not list or len(value) != len(items):
            raise TypeError(f"{value!r:.40} is not a list of {len(items)}")
        return tuple([hook(element, a) for (hook, a), element in zip(items, value, strict=True)])

    return structure_fixed


def _structure_enum(value: Any, kind: Any) -> Any:
    if type(value) is not str:
        raise TypeError(f"{value!r:.40} is not of type str")
    return kind(value)


def _make_converter(detailed: bool) -> cattrs.Converter:
    converter = cattrs.Converter(forbid_extra_keys=True, detailed_validation=detailed)
    for kind in (int, float, str, bytes, bool):
        converter.register_structure_hook(kind, _exactly(kind))
    for enum in (Mode, Shape, Fate):
        converter.register_structure_hook(enum, _structure_enum)
        converter.register_unstructure_hook(enum, operator.attrgetter("value"))
    converter.register_structure_hook_func(_is_array, _structure_ranges)
    converter.register_unstructure_hook_func(_is_array, _unstructure_ranges)
    converter.register_structure_hook_func(_is_note_value, _structure_note_value)
    converter.register_unstructure_hook_func(_is_note_value, lambda value: value)
    converter.register_structure_hook_factory(_is_tuple, partial(_structure_list_as_tuple, converter))
    return converter


_CONVERTER = _make_converter(detailed=False)
_DETAILED = _make_converter(detailed=True)
_PACKER = msgpack.Packer(use_bin_type=True)


_UNSTRUCTURERS: dict[type, Callable[[Any], dict[str, Any]]] = {}
_STRUCTURERS: dict[type, Callable[[Any, Any], Any]] = {}


def _unstructurer(kind: type) -> Callable[[Any], dict[str, Any]]:
    if kind not in _UNSTRUCTURERS:
        _UNSTRUCTURERS[kind] = make_dict_unstructure_fn(kind, _CONVERTER)
    return _UNSTRUCTURERS[kind]


def _structurer(kind: type) -> Callable[[Any, Any], Any]:
    if kind not in _STRUCTURERS:
        _STRUCTURERS[kind] = make_dict_structure_fn(
            kind, _CONVERTER, _cattrs_forbid_extra_keys=True, _cattrs_detailed_validation=False
        )
    return _STRUCTURERS[kind]


def as_map(message: Any) -> dict[str, Any]:
    """A contract value as nested maps and lists, as it goes on the wire but without the version."""
    return _unstructurer(type(message))(message)


def encode(message: Any) -> bytes:
    """A contract value as wire bytes."""
    packed: bytes = _PACKER.pack({"v": WIRE_VERSION, **_unstructurer(type(message))(message)})
    return packed


def decode(kind: type[M], data: bytes) -> M:
    """Wire bytes as a contract value of type `kind`.

    Raises DecodeError, with the reason in one line, for anything that `encode` would not have made.
    """
    try:
        fields = msgpack.unpackb(data, raw=False, strict_map_key=True)
    except (ValueError, TypeError, RecursionError, msgpack.UnpackException) as error:
        raise DecodeError(f"{kind.__name__}: not msgpack: {error or type(error).__name__}") from None
    if type(fields) is not dict or "v" not in fields:
        raise DecodeError(f"{kind.__name__}: no schema version")
    version = fields.pop("v")
    if version != WIRE_VERSION or type(version) is not int:
        raise DecodeError(
            f"{kind.__name__}: schema version {version!r:.20}; this program speaks {WIRE_VERSION}"
        )
    try:
        return cast(M, _structurer(kind)(fields, kind))
    except Exception:  # the generated code raises whatever the peer's bytes provoke
        raise DecodeError(f"{kind.__name__}: {_reason(fields, kind)}") from None


def _reason(fields: Any, kind: type) -> str:
    """Decode once more, slowly, to say which field is wrong."""
    try:
        _DETAILED.structure(fields, kind)
    except Exception as error:
        lines = cattrs.transform_error(error, format_exception=_describe)
        return "; ".join(lines[:2])
    return "malformed"


def _describe(error: BaseException, kind: type | None) -> str:
    if isinstance(error, KeyError):
        return f"{error.args[0]} is missing"
    if isinstance(error, cattrs.errors.ForbiddenExtraKeysError):
        return f"unknown key {', '.join(sorted(map(str, error.extra_fields)))}"
    if isinstance(error, ValueError | TypeError):
        return str(error)
    return f"{type(error).__name__} in {getattr(kind, '__name__', kind)}"
