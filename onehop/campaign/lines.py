"""The results of many missions as JSON lines: one line each, added as it ends, and gone on with later.

The first line says what the file is about: whoever goes on with it must be about the same. A line that a
killed program has left half written is dropped.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from onehop.contracts.errors import InputError
from onehop.contracts.printable import printable
from onehop.wire.output_folder import explained

Row = dict[str, Any]

REMEDY = "a file in a folder that can be written"


class Lines:
    """A file of results that is open to be added to. rows: what it has, in order."""

    def __init__(self, path: Path, about: Mapping[str, Any]) -> None:
        """Go on with a file, or begin it. about: as JSON, the same whenever it is gone on with.

        Raises InputError when it cannot be written, is no such file, or is about something else.
        """
        self._path = path
        with explained(path, REMEDY):
            whole = path.read_bytes() if path.exists() else b""
            whole = whole[: whole.rfind(b"\n") + 1]
            rows = _rows(path, whole)
            head, self.rows = (rows[0], rows[1:]) if rows else (None, [])
            if head is not None and head != about:
                differs = sorted(key for key in {*head, *about} if head.get(key) != about.get(key))
                raise InputError(
                    str(path),
                    f"holds results of something else ({printable(', '.join(differs), 80)} differ)",
                    "go on with the same options, or give another --out",
                )
            self._file = path.open("ab")
            self._file.truncate(len(whole))
        if head is None:
            self._write(about)

    def add(self, row: Row) -> None:
        """One more result; it is in the file when this returns."""
        self._write(row)
        self.rows.append(row)

    def _write(self, row: Mapping[str, Any]) -> None:
        with explained(self._path, REMEDY):
            self._file.write(json.dumps(row).encode() + b"\n")
            self._file.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()


def _rows(path: Path, whole: bytes) -> list[Row]:
    rows = []
    for number, line in enumerate(whole.splitlines(), 1):
        try:
            row = json.loads(line)
        except ValueError:
            row = None
        if not isinstance(row, dict):
            raise InputError(f"{path}: line {number}", "is no result", "give another --out")
        rows.append(row)
    return rows
