"""`onehop new`: a small project with a robot program of one's own."""

import shutil
from pathlib import Path

from onehop.commands.output import emit_json
from onehop.contracts.errors import InputError
from onehop.wire.output_folder import explained

PROJECT = Path(__file__).with_name("project")
"""The project that is copied: a scenario, a program and its test."""


def new(folder: Path, as_json: bool) -> int:
    """Write the project into a folder that is not there yet, or empty. Raises InputError."""
    remedy = "give a folder that can be written"
    with explained(folder, remedy):
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise InputError(str(folder), "is not empty", "give a folder that is not there yet")
        sources = sorted(path for path in PROJECT.iterdir() if path.is_file())
        written = [shutil.copyfile(path, folder / path.name) for path in sources]
    if as_json:
        emit_json({"folder": str(folder), "files": [path.name for path in written]})
        return 0
    for path in written:
        print(path)
    print(f"\nnext: onehop run {folder / 'mission.toml'}, then change {folder / 'seeker.py'}")
    return 0
