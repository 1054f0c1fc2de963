"""Make a base image from this machine's own Python, for where no image registry is reached.

The root file system holds the interpreter that runs this program, its standard library, the packages of
the project's environment, every shared library that any of these need, and a shell. It is imported as an
image and passed to the build as BASE.
"""

import io
import re
import subprocess
import sys
import sysconfig
import tarfile
from collections.abc import Iterable, Iterator
from pathlib import Path

PACKAGES = "/opt/python-packages"
_SKIPPED = {"__pycache__", "test", "tests", "idlelib", "turtledemo", "ensurepip", "tkinter"}
_LIBRARY = re.compile(r"(/\S+) \(0x")


def main() -> None:
    image = sys.argv[1]
    interpreter = Path(sys.executable).resolve()
    standard = Path(sysconfig.get_path("stdlib"))
    packages = Path(sysconfig.get_path("purelib"))
    trees = [(path, str(path)) for path in _files(standard) if packages not in path.parents]
    trees += [(path, f"{PACKAGES}/{path.relative_to(packages)}") for path in _files(packages)]
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


def _files(top: Path) -> Iterator[Path]:
    for path in sorted(top.rglob("*")):
        inside = path.relative_to(top).parts
        hidden = _SKIPPED.intersection(inside) if top == Path(sysconfig.get_path("stdlib")) else ()
        if path.is_file() and "__pycache__" not in inside and not hidden:
            yield path


def _libraries(binaries: Iterable[Path]) -> set[str]:
    """Paths of all shared libraries that the binaries load, the dynamic linker included."""
    found: set[str] = set()
    for binary in binaries:
        told = subprocess.run(["ldd", str(binary)], capture_output=True, text=True, check=False)
        found.update(match.group(1) for match in _LIBRARY.finditer(told.stdout))
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
