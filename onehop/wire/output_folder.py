"""The folder of a mission's output: made, tried and locked before any work is done.

Two missions never write into one folder at a time. The lock is the kernel's, on the folder itself: it
leaves nothing behind and goes with the last process that holds it, however that ends.
"""

import errno
import fcntl
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from onehop.contracts.errors import InputError

LOG, SUMMARY, FIGURE = "mission.mcap", "summary.json", "trajectory.png"

REMEDY = "a folder that can be written, with room for a log"

UNLOCKABLE = (errno.EBADF, errno.EINVAL, errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS)
"""What file systems say that know no locks, or none on folders (NFS): there the lock is left out."""

_TRIAL_BYTES = 4096
"""Written to see that there is room: one block of most file systems [B]."""


@contextmanager
def claimed(folder: Path) -> Iterator[int]:
    """Hold a folder for one mission; gives the descriptor that a child inherits to hold it as well.

    Summary and figure of an earlier mission go: they say nothing about this one. Raises InputError when
    the folder cannot be made or written, or somebody else holds it.
    """
    with held(folder) as descriptor:
        with explained(folder, REMEDY):
            _try_out(folder)
        yield descriptor


@contextmanager
def held(folder: Path) -> Iterator[int]:
    """Make a folder if need be, and hold it; what is in it stays. Gives its descriptor.

    Raises InputError when it cannot be made, or somebody else holds it.
    """
    with explained(folder, REMEDY):
        if folder.exists() and not folder.is_dir():
            raise OSError(errno.ENOTDIR, "Not a folder")
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        _lock(descriptor, folder)
        yield descriptor
    finally:
        os.close(descriptor)


@contextmanager
def explained(path: Path, remedy: str) -> Iterator[None]:
    """Turn what the system refuses about a file or folder into InputError."""
    try:
        yield
    except OSError as error:
        raise InputError(str(path), error.strerror or "cannot be written", remedy) from None


def require_writable(path: Path) -> None:
    """Raise InputError if a file of this name could not be written."""
    with explained(path, "a file in a folder that exists and can be written"):
        if path.exists():
            if not path.is_file():
                raise OSError(errno.EINVAL, "Not a regular file")
            path.open("ab").close()
        _write_something(path.parent)


def _lock(descriptor: int, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise InputError(
            str(folder),
            "another mission or campaign is writing there",
            "wait for its end, or give another --out",
        ) from None
    except OSError as error:
        if error.errno not in UNLOCKABLE:
            raise InputError(str(folder), f"cannot be locked: {error.strerror}", REMEDY) from None


def _try_out(folder: Path) -> None:
    _write_something(folder)
    if (folder / LOG).exists():
        require_writable(folder / LOG)
    for name in (SUMMARY, FIGURE):
        (folder / name).unlink(missing_ok=True)


def _write_something(folder: Path) -> None:
    with tempfile.TemporaryFile(dir=folder, buffering=0) as trial:
        trial.write(bytes(_TRIAL_BYTES))
