"""`onehop doctor`: is everything here that a run needs, what is missing, and how to get it."""

import importlib.metadata
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass

from onehop.commands.output import emit_json

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
)
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
DOCKER_TIMEOUT_S = 10.0


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
    yield _bus()
    yield _folder()
    cores = os.cpu_count() or 1
    yield Check("cores", cores >= 2, False, str(cores), "works with one; two and more run faster")
    yield _docker()
    yield _browser()


def _library(name: str) -> Check:
    try:
        return Check(name, True, True, importlib.metadata.version(name), "")
    except importlib.metadata.PackageNotFoundError:
        return Check(name, False, True, "not installed", "make setup (or: pip install onehop)")


def _bus() -> Check:
    """Open a router on loopback and reach it, as a mission does."""
    from onehop.contracts.errors import MissionError
    from onehop.mission.processes import free_endpoint
    from onehop.node.bus import open_client, open_router

    try:
        endpoint = free_endpoint()
        with open_router("doctor", endpoint), open_client("doctor", endpoint, "doctor", None, 3000):
            return Check("bus on loopback", True, True, endpoint, "")
    except (MissionError, OSError) as error:
        return Check("bus on loopback", False, True, str(error), "allow TCP on 127.0.0.1")


def _folder() -> Check:
    free_gb = shutil.disk_usage(".").free / 1e9
    writable = os.access(".", os.W_OK)
    found = f"{free_gb:.1f} GB free{'' if writable else ', not writable'}"
    return Check(
        "working folder", writable and free_gb > 0.2, True, found, "a folder with room for logs"
    )


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
