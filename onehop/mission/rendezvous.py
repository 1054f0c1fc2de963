"""How a command finds a mission that runs, and the way in: a file in the folder of the mission's output.

Only its owner can read it: it holds the password of the injector, who may order faults and nothing else,
or says where the injector's certificate is.
A list of the missions of this user lies in their runtime folder (XDG_RUNTIME_DIR) or state folder
(XDG_STATE_HOME, ~/.local/state), with nothing in it but where each mission's output goes.
"""

import contextlib
import json
import os
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from onehop.contracts import topics
from onehop.contracts.errors import InputError
from onehop.mission.placement import Placement
from onehop.node.identity import Identity
from onehop.node.startup import certificate
from onehop.wire.output_folder import REMEDY, explained

FILE = "running.json"
"""The file in the output's folder, there while the mission runs."""


@dataclass(frozen=True, slots=True)
class Rendezvous:
    """The way into one mission. mission: prefix of its keys. pid: of its launcher.

    password: of the injector, or else keys: the folder of certificates.
    """

    mission: str
    endpoint: str
    password: str
    pid: int
    keys: str = ""

    @property
    def entry(self) -> str:
        """What the list of missions calls it."""
        return f"{self.mission}.{self.pid}"

    def identity(self) -> Identity:
        """The injector's. Raises InputError when its certificate is of no use."""
        return certificate(Path(self.keys), topics.INJECTOR) if self.keys else self.password


def entrance(placement: Placement, injector: Identity, pid: int) -> Rendezvous:
    """The way into a mission that this process runs."""
    password = injector if isinstance(injector, str) else ""
    keys = "" if placement.keys is None else str(placement.keys)
    return Rendezvous(placement.mission, placement.connect, password, pid, keys)


@contextlib.contextmanager
def published(folder: Path, way_in: Rendezvous) -> Iterator[None]:
    """Let commands find a mission meanwhile. Raises InputError when the folder cannot be written."""
    path = folder / FILE
    with explained(path, REMEDY):
        path.unlink(missing_ok=True)
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with open(descriptor, "w") as file:
            json.dump(asdict(way_in), file)
    entry = _list_folder() / way_in.entry
    with contextlib.suppress(OSError):  # without the list, `--mission` finds it
        entry.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        entry.write_text(str(folder.resolve()))
    try:
        yield
    finally:
        for name in (path, entry):
            with contextlib.suppress(OSError):
                name.unlink()


def way_into(folder: Path) -> Rendezvous:
    """The way into the mission whose output goes to a folder. Raises InputError if none runs there."""
    found = _read(folder)
    if found is None:
        remedy = "the --out folder of a mission that runs as processes"
        raise InputError(f"--mission {folder}", "no mission runs there", remedy)
    return found


def the_one_that_runs() -> Path:
    """The folder of the only mission of this user. Raises InputError if there is none, or several."""
    folders = running()
    if not folders:
        raise InputError("fault", "no mission runs", "start one with onehop run, or give --mission")
    if len(folders) > 1:
        which = ", ".join(map(str, folders))
        raise InputError("fault", f"{len(folders)} missions run", f"which one? --mission of {which}")
    return folders[0]


def running() -> list[Path]:
    """The folders of all missions of this user that run. Entries of those that died are taken away."""
    folders = []
    with contextlib.suppress(OSError):
        for entry in sorted(_list_folder().iterdir()):
            folder = Path(entry.read_text())
            way_in = _read(folder)
            if way_in is not None and way_in.entry == entry.name:
                folders.append(folder)
            else:
                entry.unlink()
    return folders


def _list_folder() -> Path:
    """XDG Base Directory Specification 0.8."""
    state = os.environ.get("XDG_STATE_HOME") or "~/.local/state"
    base = os.environ.get("XDG_RUNTIME_DIR") or os.path.expanduser(state)
    return Path(base) / "onehop" / "running"


def _read(folder: Path) -> Rendezvous | None:
    """The way into a mission, if its launcher lives."""
    try:
        way_in = Rendezvous(**json.loads((folder / FILE).read_text()))
        os.kill(way_in.pid, 0)
    except (OSError, ValueError, TypeError):
        return None
    return way_in
