"""The wire format: contract values as msgpack maps, decoded strictly.

Every message is a map whose first key is the schema version. Decoding refuses another version by name,
an unknown or missing key, and a value of another type; the one liberty is a whole number where a float
is due. Arrays of laser ranges travel as little-endian float32 bytes.
"""

import threading
from typing import Any, TypeVar

import msgpack
import msgspec
import numpy as np

from onehop.contracts.arrays import Ranges
from onehop.contracts.errors import DecodeError
from onehop.contracts.printable import printable
from onehop.contracts.values import WIRE_VERSION, Wire

M = TypeVar("M", bound=Wire)

_WIRE_FLOAT = np.dtype("<f4")
_VERSION_PREFIX = msgspec.msgpack.encode({"v": WIRE_VERSION})[1:]
"""What follows the first byte, the header of the map, in every message."""


def _to_wire(value: Any) -> bytes:
    if type(value) is np.ndarray:
        return value.astype(_WIRE_FLOAT, copy=False).tobytes()
    raise TypeError(f"{type(value).__name__} cannot travel on the wire")


def _from_wire(_: type, value: Any) -> Ranges:
    if type(value) is not bytes or len(value) % _WIRE_FLOAT.itemsize:
        raise TypeError("Expected a byte string of float32")
    return np.frombuffer(value, dtype=_WIRE_FLOAT)


REFUSALS = (msgspec.MsgspecError, UnicodeDecodeError, RecursionError)
"""What msgspec raises for bytes that are not the message they should be."""

UNPACK_REFUSALS = (ValueError, TypeError, msgpack.UnpackException, RecursionError)
"""What msgpack raises for bytes that are not msgpack, or not for Python: keys that are lists."""

_ENCODER = msgspec.msgpack.Encoder(enc_hook=_to_wire)
_DECODERS: dict[type, msgspec.msgpack.Decoder[Any]] = {}
_MAKING_ONE = threading.Lock()
"""msgspec fills in what it knows of a type while it makes the first decoder for it, and others run
meanwhile: a second decoder, for a message with the same type in it, would crash the process."""

encode = _ENCODER.encode
"""A contract value as wire bytes."""


def decode(kind: type[M], data: bytes) -> M:
    """Wire bytes as a contract value of type `kind`.

    Raises DecodeError, with the reason in one line, for anything that `encode` would not have made.
    """
    decoder = _DECODERS.get(kind) or _decoder(kind)
    try:
        if data[1:4] == _VERSION_PREFIX:
            message: M = decoder.decode(data)
            return message
    except REFUSALS as error:
        raise DecodeError(f"{kind.__name__}: {printable(str(error))}") from None
    raise DecodeError(f"{kind.__name__}: {_version_problem(data)}")


def _decoder(kind: type[Wire]) -> msgspec.msgpack.Decoder[Any]:
    """The decoder of a type, made once."""
    with _MAKING_ONE:
        if kind not in _DECODERS:
            _DECODERS[kind] = msgspec.msgpack.Decoder(kind, dec_hook=_from_wire)
        return _DECODERS[kind]


def _version_problem(data: bytes) -> str:
    """Why a message does not start with this program's schema version."""
    try:
        fields = msgspec.msgpack.decode(data)
    except REFUSALS as error:
        return f"not msgpack: {printable(str(error))}"
    if type(fields) is not dict or "v" not in fields:
        return "no schema version"
    if fields["v"] == WIRE_VERSION and fields["v"] is not True:
        return "the schema version is not its first key"
    return f"schema version {fields['v']!r:.20}; this program speaks {WIRE_VERSION}"


def as_map(value: Any) -> dict[str, Any]:
    """A contract value as nested maps and lists, as it goes on the wire but without the version."""
    fields: dict[str, Any] = msgspec.to_builtins(value, enc_hook=_to_wire, builtin_types=(bytes,))
    fields.pop("v", None)
    return fields
