"""`onehop new`: what it writes runs as it is, and all that one does with a log works on its log."""

import ast
import json
from pathlib import Path

import pytest

from onehop.commands.new import new
from onehop.contracts.errors import InputError
from tests.onehop.command_line import in_shell as onehop


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("new") / "my_robots"
    assert onehop("new", folder).returncode == 0
    return folder


@pytest.fixture(scope="module")
def log(project: Path) -> Path:
    """Its mission, run from somewhere else."""
    out = project.parent / "out"
    done = onehop("run", project / "mission.toml", "--driver", "inline", "--json", "--out", out)
    assert json.loads(done.stdout)["arrived"] == [1, 2, 3, 4, 5], done.stderr
    return out / "mission.mcap"


def test_a_project_is_a_scenario_a_program_of_some_thirty_lines_and_a_test(project: Path) -> None:
    assert {path.name for path in project.iterdir()} >= {"mission.toml", "seeker.py", "test_seeker.py"}
    program = next(
        node
        for node in ast.parse((project / "seeker.py").read_text()).body
        if isinstance(node, ast.ClassDef) and node.name == "Seeker"
    )
    assert (program.end_lineno or 0) - program.lineno < 45


def test_a_folder_with_something_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("mine")
    with pytest.raises(InputError, match="is not empty; give a folder that is not there yet"):
        new(tmp_path, as_json=False)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_what_it_wrote_is_one_json_object(tmp_path: Path) -> None:
    answer = json.loads(onehop("new", tmp_path / "a" / "b", "--json").stdout)
    assert answer["files"] == ["mission.toml", "seeker.py", "test_seeker.py"]


@pytest.mark.parametrize("command", ["replay", "check", "report"])
def test_the_log_of_its_mission_is_like_any_other(command: str, log: Path, tmp_path: Path) -> None:
    options = ["--out", str(tmp_path / "page")] if command == "report" else []
    done = onehop(command, log, *options, cwd=tmp_path)
    assert done.returncode == 0, done.stderr


def test_a_log_whose_program_is_gone_is_read_but_not_executed(
    project: Path, log: Path, tmp_path: Path
) -> None:
    moved = project.rename(tmp_path / "elsewhere")
    try:
        assert onehop("check", log).returncode == 0
        refused = onehop("replay", log)
        assert refused.returncode == 2
        assert "team.program: 'seeker:Seeker': No module named 'seeker'; " in refused.stderr
        assert onehop("replay", log, PYTHONPATH=str(moved)).returncode == 0
    finally:
        moved.rename(project)


def test_its_program_can_be_put_into_another_scenario(project: Path, tmp_path: Path) -> None:
    scenario = Path(__file__).parents[3] / "scenarios" / "map1.toml"
    words = ("--program", "seeker:Seeker", "--driver", "inline", "--json", "--no-record")
    done = onehop("run", scenario, *words, "--set", "clock.limit_s=1", "--out", tmp_path, cwd=project)
    assert json.loads(done.stdout)["reason"] == "time limit of 1 s", done.stderr


def test_a_mistake_in_its_parameters_is_one_line_before_anything_starts(project: Path) -> None:
    done = onehop("run", project / "mission.toml", "--set", "team.parameters.sped=2")
    assert done.returncode == 2
    where = f"onehop: {project / 'mission.toml'}: team.parameters.sped"
    assert done.stderr == f"{where}: unknown key; did you mean speed?\n"
