"""Robots with a command: what is a process alone runs nowhere else, and a wrong command is one line."""

import json
from pathlib import Path

import pytest

from onehop.contracts.briefings import robot_briefing
from onehop.contracts.errors import ScenarioError
from onehop.drivers import inline
from onehop.drivers.replay import replay
from onehop.scenario.as_toml import as_toml
from onehop.scenario.scenario_file import load
from onehop.wire.log_reader import LogFile
from tests.onehop.command_line import in_shell as onehop
from tests.onehop.scenes import field, log_of

COMMAND = "robots=[{id=3, command=['./mine', '-v'], parameters={how='x'}}]"


@pytest.mark.parametrize("words", [("run", "--driver", "inline"), ("chaos",), ("sweep",)])
def test_it_is_refused_where_there_are_no_processes(words: tuple[str, ...], tmp_path: Path) -> None:
    field(tmp_path)
    command, *options = words
    done = onehop(command, "field.toml", *options, "--set", COMMAND, "--out", "out", cwd=tmp_path)
    assert done.returncode == 2
    what = "robot 3 is a process of its own, and has no program to run in this one"
    assert done.stderr.startswith(f"onehop: field.toml: robots[0].command: {what}; onehop run with ")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_nobody_runs_it_in_one_process_by_mistake(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="robot 3 is a process of its own"):
        inline.run(field(tmp_path, COMMAND), None)


def test_its_program_is_its_own_business_and_its_briefing_that_of_the_team(tmp_path: Path) -> None:
    scenario = field(tmp_path, COMMAND).scenario
    assert scenario.commands == {3: ("./mine", "-v")}
    assert scenario.has_own_programs()
    ours, briefing = robot_briefing(scenario, 1, 0), robot_briefing(scenario, 3, 0)
    assert (briefing.program, briefing.team) == (ours.program, ours.team)
    assert briefing.parameters == {"how": "x"}


def test_it_stands_in_a_file_as_it_was(tmp_path: Path) -> None:
    scenario = field(tmp_path, COMMAND).scenario
    path = tmp_path / "again.toml"
    path.write_text(as_toml(scenario))
    assert load(path).scenario == scenario


@pytest.mark.parametrize("command", ["['']", "['./mine', 'a\\u0000b']"])
def test_a_command_that_names_nothing_is_refused(command: str, tmp_path: Path) -> None:
    setting = f"robots=[{{id=3, command={json.dumps(eval(command))}}}]"
    with pytest.raises(ScenarioError, match=r"robots\[0\].command: names no program; a program and its"):
        field(tmp_path, setting)


def test_of_a_log_all_but_what_it_said_is_executed_again(tmp_path: Path) -> None:
    """Here its words are those of our program, and the log says that they were not."""
    log = tmp_path / "mission.mcap"
    bundle = field(tmp_path, "clock.limit_s=2")
    log_of(bundle, log)
    assert replay(LogFile(log)).foreign == ()
    told = LogFile(log)
    object.__setattr__(told, "bundle", field(tmp_path, "clock.limit_s=2", COMMAND))
    again = replay(told)
    assert (again.robots, again.foreign, again.divergences) == ((1, 2, 4), (3,), 0)
    assert again.same
