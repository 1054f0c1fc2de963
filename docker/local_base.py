"""Make a base image from this machine's own Python, for where no image registry is reached.

The root file system holds the interpreter that runs this program, its standard library, the packages
that the project needs at run time, pip, every shared library that any of these need, and a shell. It is
imported as an image and passed to the build as BASE. What nothing needs stays out: storage drivers are
slow on many small files.
"""

import importlib.metadata
import io
import re
import subprocess
import sys
import sysconfig
import tarfile
from collections.abc import Iterable, Iterator
from pathlib import Path

from dependencies import requirements

PACKAGES = "/opt/python-packages"
_SKIPPED = {
    "__pycache__", "test", "tests", "idlelib", "turtledemo", "ensurepip", "tkinter", "lib2to3",
    "site-packages", "dist-packages", "sample_data", "include",
}  # fmt: skip
_LIBRARY = re.compile(r"(/\S+) \(0x")


def main() -> None:
    image = sys.argv[1]
    interpreter = Path(sys.executable).resolve()
    standard = Path(sysconfig.get_path("stdlib"))
    trees = [(path, str(path)) for path in _standard_library(standard)]
    trees += [(path, f"{PACKAGES}/{name}") for path, name in _packages()]
    binaries = [path for path, _ in trees if ".so" in path.name]
    programs = [interpreter, Path("/bin/sh").resolve()]
    command = ["docker", "import", "--change", f"ENV PYTHONPATH={PACKAGES}"]
    with subprocess.Popen([*command, "-", image], stdin=subprocess.PIPE) as importing:
        assert importing.stdin is not None
        with tarfile.open(fileobj=importing.stdin, mode="w|") as root:
            for path, name in trees:
                root.add(path.resolve(), name, recursive=False)
            for library in sorted(_libraries([*programs, *binaries])):
                root.add(Path(library).resolve(), library, recursive=False)
            for path in programs:
                root.add(path, str(path), recursive=False)
            _link(root, "/bin/sh", str(programs[1]))
            _link(root, "/usr/local/bin/python", str(interpreter))
            _add_text(root, "/etc/passwd", "root:x:0:0:root:/root:/bin/sh\n")
            for folder in ("/tmp", "/root"):
                entry = tarfile.TarInfo(folder)
                entry.type, entry.mode = tarfile.DIRTYPE, 0o1777
                root.addfile(entry)
        importing.stdin.close()
    sys.exit(importing.returncode)


def _standard_library(top: Path) -> Iterator[Path]:
    for path in sorted(top.rglob("*")):
        inside = path.relative_to(top).parts
        if path.is_file() and not _SKIPPED.intersection(inside):
            yield path


def _packages() -> Iterator[tuple[Path, str]]:
    """Files of pip and of everything that the image installs, with their names below PACKAGES."""
    wanted = ["pip", *map(_name, requirements(Path("pyproject.toml")))]
    seen: set[str] = set()
    while wanted:
        name = wanted.pop()
        if name in seen:
            continue
        seen.add(name)
        try:
            distribution = importlib.metadata.distribution(name)
        except importlib.metadata.PackageNotFoundError:
            continue  # required on other platforms only
        wanted += [_name(text) for text in distribution.requires or () if "extra ==" not in text]
        for file in distribution.files or ():
            path = Path(str(distribution.locate_file(file)))
            if path.is_file() and ".." not in file.parts and not _SKIPPED.intersection(file.parts):
                yield path, str(file)


def _name(requirement: str) -> str:
    """The name of a package in the one spelling of PEP 503: packages spell each other freely."""
    match = re.match(r"[A-Za-z0-9._-]+", requirement)
    assert match is not None, requirement
    return re.sub(r"[-_.]+", "-", match.group(0)).lower()


def _libraries(binaries: Iterable[Path]) -> set[str]:
    """Paths of all shared libraries that the binaries load, the dynamic linker included."""
    found: set[str] = set()
    for binary in binaries:
        asked = subprocess.run(["ldd", str(binary)], capture_output=True, text=True, check=False)
        found.update(match.group(1) for match in _LIBRARY.finditer(asked.stdout))
    return {path for path in found if PACKAGES not in path and "site-packages" not in path}


def _link(root: tarfile.TarFile, name: str, target: str) -> None:
    if name != target:
        entry = tarfile.TarInfo(name)
        entry.type, entry.linkname = tarfile.SYMTYPE, target
        root.addfile(entry)


def _add_text(root: tarfile.TarFile, name: str, text: str) -> None:
    entry = tarfile.TarInfo(name)
    entry.size = len(text)
    root.addfile(entry, io.BytesIO(text.encode()))


main()
