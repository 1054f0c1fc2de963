"""A package of plugins that is installed as long as a test lasts."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.onehop.plugins.package import install


@pytest.fixture
def parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where the package lies."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(install(folder)))
    yield folder
    for name in ("spare_parts", "spare_broken"):
        sys.modules.pop(name, None)
