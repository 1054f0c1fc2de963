"""Print the run-time dependencies of a pyproject.toml, one a line: what the image installs."""

import sys
import tomllib
from pathlib import Path

for requirement in tomllib.loads(Path(sys.argv[1]).read_text())["project"]["dependencies"]:
    print(requirement)
