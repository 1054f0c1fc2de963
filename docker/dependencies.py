"""What the image installs: the run-time dependencies of pyproject.toml and of its bridge to ROS 2.

    python docker/dependencies.py pyproject.toml

prints them, one a line.
"""

import sys
import tomllib
from pathlib import Path

EXTRAS = ("ros2",)


def requirements(pyproject: Path) -> list[str]:
    """As they stand in a pyproject.toml."""
    project = tomllib.loads(pyproject.read_text())["project"]
    extras = project["optional-dependencies"]
    return [*project["dependencies"], *(one for extra in EXTRAS for one in extras[extra])]


if __name__ == "__main__":
    print("\n".join(requirements(Path(sys.argv[1]))))
