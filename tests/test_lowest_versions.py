"""What `make lowest` installs is what pyproject.toml promises to work with."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def _version(text: str) -> str:
    return re.sub(r"(\.0)+$", "", text)


def _name(text: str) -> str:
    return re.sub(r"[-_.]+", "-", text).lower()


def _promised() -> dict[str, str]:
    """Lowest version of each requirement of the programs and their tests; "" where there is no bound."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    found = {}
    for requirement in project["dependencies"] + project["optional-dependencies"]["dev"]:
        name, _, bound = requirement.partition(">=")
        assert re.fullmatch(r"[\w.-]+", name), f"{requirement}: not of the form name>=version"
        found[_name(name)] = _version(bound)
    return found


def test_the_lowest_versions_are_those_of_pyproject() -> None:
    lines = (ROOT / "constraints-lowest.txt").read_text().split()
    pinned = {_name(name): _version(version) for name, version in (line.split("==") for line in lines)}
    promised = {name: bound for name, bound in _promised().items() if bound}
    assert {name: pinned.get(name) for name in promised} == promised, (
        "a bound has changed: make lowest-constraints"
    )


def test_every_requirement_of_the_programs_has_a_lowest_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert all(_promised()[_name(each.partition(">=")[0])] for each in project["dependencies"])
