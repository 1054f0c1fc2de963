"""`onehop doctor`: is everything here that a run needs, what is missing, and how to get it.

What it vouches for it has tried: it writes a file, compiles a kernel, opens a bus, draws a figure.
"""

import importlib.metadata
import io
import os
import platform
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from onehop.commands.output import emit_json
from onehop.contracts.printable import printable
from onehop.wire.output_folder import require_writable

LIBRARIES = (
    "eclipse-zenoh",
    "numpy",
    "msgpack",
    "mcap",
    "cattrs",
    "msgspec",
    "typer",
    "rich",
    "numba",
    "matplotlib",
    "cryptography",
)
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
DOCKER_TIMEOUT_S = 10.0

ROOM_BYTES = 200_000_000
"""Free space below which a folder is too small for logs: ten missions of ten minutes [B]."""

USUAL_CLIENTS = 9
"""Processes beside the world in a mission of six robots."""


@dataclass(frozen=True, slots=True)
class Check:
    """One thing looked at. required: a run on this machine cannot do without it."""

    name: str
    ok: bool
    required: bool
    found: str
    remedy: str


def doctor(as_json: bool) -> int:
    """Look at everything; exit status 1 when something required is missing."""
    checks = list(_checks())
    healthy = all(check.ok for check in checks if check.required)
    if as_json:
        emit_json({"healthy": healthy, "checks": [asdict(check) for check in checks]})
    else:
        width = max(len(check.name) for check in checks)
        for check in checks:
            mark = "ok     " if check.ok else "MISSING" if check.required else "absent "
            print(f"{mark}  {check.name:<{width}}  {check.found}")
            if not check.ok:
                print(f"         {'':<{width}}  -> {check.remedy}")
        print("ready to run" if healthy else "a run needs what is MISSING")
    return 0 if healthy else 1


def _checks() -> Iterator[Check]:
    version = platform.python_version()
    yield Check("python", sys.version_info >= (3, 11), True, version, "install Python 3.11 or newer")
    for name in LIBRARIES:
        yield _library(name)
    yield _tried("bus on loopback", _bus, "allow TCP on 127.0.0.1")
    yield _tried("compiled kernels", _kernels, "make setup (or: pip install --force-reinstall numba)")
    yield _tried("figures", _figure, "make setup (or: pip install --force-reinstall matplotlib)")
    yield _tried("working folder", _folder, "a folder that can be written, with room for logs")
    yield _tried("open files", _open_files, "ulimit -n 1024")
    cores = os.cpu_count() or 1
    yield Check("cores", cores >= 2, False, str(cores), "works with one; two and more run faster")
    yield _docker()
    yield _browser()


def _library(name: str) -> Check:
    try:
        return Check(name, True, True, importlib.metadata.version(name), "")
    except importlib.metadata.PackageNotFoundError:
        return Check(name, False, True, "not installed", "make setup (or: pip install onehop)")


def _tried(name: str, attempt: Callable[[], str], remedy: str) -> Check:
    """A check by doing: whatever goes wrong is what was found."""
    try:
        return Check(name, True, True, attempt(), "")
    except Exception as error:
        return Check(name, False, True, printable(f"{error}"), remedy)


def _bus() -> str:
    """Open a router on loopback and reach it, as a mission does."""
    from onehop.mission.processes import free_endpoint
    from onehop.node.bus import open_client, open_router
    from onehop.node.identity import make_credentials

    endpoint, words = free_endpoint(), make_credentials(["doctor"])
    with (
        open_router("doctor", endpoint, words),
        open_client("doctor", endpoint, "doctor", words["doctor"], 3000),
    ):
        return endpoint


def _kernels() -> str:
    """Compile a kernel, or load it from where it was kept."""
    from world_server.core.turning import direction

    if direction(0.0) != (1.0, 0.0):
        raise ArithmeticError("a kernel gives a wrong result")
    kept_in = direction.stats.cache_path  # type: ignore[attr-defined]
    return f"kept in {kept_in}" if kept_in else "compiled anew by every run: no folder to keep them"


def _figure() -> str:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure()
    FigureCanvasAgg(figure)
    figure.add_subplot().set_title("onehop")
    drawing = io.BytesIO()
    figure.savefig(drawing, format="png")
    return f"drawn, {drawing.tell()} B"


def _folder() -> str:
    runs = Path("runs")
    require_writable((runs if runs.is_dir() else Path()) / "trial")
    free = shutil.disk_usage(".").free
    if free < ROOM_BYTES:
        raise OSError(f"{free / 1e9:.1f} GB free")
    return f"{free / 1e9:.1f} GB free"


def _open_files() -> str:
    from onehop.mission.processes import require_descriptors

    require_descriptors(USUAL_CLIENTS)
    return f"up to {resource.getrlimit(resource.RLIMIT_NOFILE)[1]} allowed"


def _docker() -> Check:
    remedy = "only for make compose-demo: install Docker Engine with Compose and start it"
    if shutil.which("docker") is None:
        return Check("docker", False, False, "not installed", remedy)
    try:
        asked = subprocess.run(
            ["docker", "info", "--format", "{{.ServerVersion}}"],
            capture_output=True,
            text=True,
            timeout=DOCKER_TIMEOUT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Check("docker", False, False, "does not answer", remedy)
    compose = shutil.which("docker-compose") is not None or _has_compose_plugin()
    answers = asked.returncode == 0 and bool(asked.stdout.strip())
    found = f"engine {asked.stdout.strip()}" if answers else "engine does not answer"
    return Check(
        "docker", answers and compose, False, found + ("" if compose else ", no Compose"), remedy
    )


def _has_compose_plugin() -> bool:
    asked = subprocess.run(
        ["docker", "compose", "version"], capture_output=True, timeout=DOCKER_TIMEOUT_S, check=False
    )
    return asked.returncode == 0


def _browser() -> Check:
    found = next((path for name in BROWSERS if (path := shutil.which(name))), None)
    remedy = "only to look at reports on this machine: install chromium"
    return Check("browser", found is not None, False, found or "none", remedy)
