"""Programs by name, and what in their modules looks as if they were fickle."""

import json

import pytest

from onehop.commands.suspects import suspects
from onehop.contracts.errors import InputError
from onehop.contracts.program_section import BUILT_IN
from onehop.plugins import PROGRAMS, installed
from onehop.programs.find import find
from robot_agent.core.robot import Robot
from tests.onehop.command_line import in_shell as onehop
from tests.onehop.programs.fickle import Fickle
from tests.onehop.programs.samples import Seeker


def test_the_built_in_team_is_offered_by_name_like_any_other_program() -> None:
    assert find("team") is find(BUILT_IN) is Robot
    assert ("team", BUILT_IN) in [(one.name, one.value) for one in installed(PROGRAMS)]


def test_a_name_that_no_package_offers_is_refused_with_those_that_are() -> None:
    with pytest.raises(InputError, match=r"'flock' is offered by no package; .*, or one of .*'team'"):
        find("flock")


def test_plugins_lists_what_is_installed() -> None:
    answer = onehop("plugins", "--json")
    rows = json.loads(answer.stdout)["onehop.programs"]
    assert [row["program"] for row in rows if row["name"] == "team"] == [BUILT_IN]
    assert answer.returncode == 0
    assert "robot_agent.core.robot:Robot" in onehop("plugins").stdout


def test_lines_that_may_make_a_program_fickle_are_named() -> None:
    found = {what for _, what in suspects(Fickle)}
    assert found == {
        "random: global randomness",
        "time: the wall clock",
        "a set that is iterated: its order",
        "global steps: shared by robots of one process",
    }
    assert [what for _, what in suspects(Robot)] == []
    assert [what for _, what in suspects(Seeker)] == ["time: the wall clock"]
