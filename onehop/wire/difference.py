"""The first difference of two contract values, by the name of the field."""

from typing import Any

import numpy as np


def first_difference(recorded: Any, replayed: Any, path: str = "") -> tuple[str, Any, Any] | None:
    """Path of the first field that differs with both values, e.g. ("twist.v", 1.0, 0.9); None if equal.

    Both are maps and lists as the wire carries them; "length" stands for lists of different length.
    """
    if isinstance(recorded, dict) and isinstance(replayed, dict):
        for key in [*recorded, *(key for key in replayed if key not in recorded)]:
            inner = f"{path}.{key}" if path else str(key)
            if key not in recorded or key not in replayed:
                return inner, recorded.get(key), replayed.get(key)
            found = first_difference(recorded[key], replayed[key], inner)
            if found:
                return found
        return None
    if isinstance(recorded, list | tuple) and isinstance(replayed, list | tuple):
        for number, (a, b) in enumerate(zip(recorded, replayed, strict=False)):
            found = first_difference(a, b, f"{path}[{number}]")
            if found:
                return found
        if len(recorded) != len(replayed):
            return f"{path}.length", len(recorded), len(replayed)
        return None
    if isinstance(recorded, np.ndarray):
        same = recorded.tobytes() == np.asarray(replayed).tobytes()
    else:
        both_nan = recorded != recorded and replayed != replayed
        same = type(recorded) is type(replayed) and (recorded == replayed or both_nan)
    return None if same else (path, recorded, replayed)
