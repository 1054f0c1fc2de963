"""Robots that are processes of somebody else's making: the same bytes as the program that they port."""

import ast
import json
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from onehop.checking import judge
from onehop.drivers.replay import replay
from onehop.wire.log_reader import LogFile
from tests.onehop.command_line import in_shell as onehop

pytestmark = pytest.mark.live

EXAMPLES = Path(__file__).parents[2] / "examples"
SIMPLE = EXAMPLES / "simple.toml"
BARE = '["python", "bare_robot.py"]'

FAULTS = """faults=[
    {kind="stop", at_s=2.0, robots=[5], duration_s=1.0},
    {kind="restart", at_s=5.0, robots=[5]},
    {kind="kill", at_s=8.0, robots=[5]},
]""".replace("\n", " ")


def run(out: Path, *words: str) -> dict[str, Any]:
    """The summary of a mission."""
    done = onehop("run", SIMPLE, "--no-view", "--no-figure", "--json", "--out", out, *words)
    assert done.stdout, done.stderr
    summary: dict[str, Any] = json.loads(done.stdout)
    return summary


def digest_of(out: Path, *words: str) -> str:
    summary = run(out, *words)
    assert summary["outcome"] == "arrived"
    digest: str = summary["digest"]
    return digest


def robot_5(command: str) -> tuple[str, str]:
    return "--set", f"robots=[{{id=5, command={command}}}]"


@pytest.fixture(scope="module")
def digest(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Of the mission in which all robots run simple_robot.py."""
    return digest_of(tmp_path_factory.mktemp("simple"), "--driver", "inline")


def test_a_robot_that_knows_the_page_alone_takes_the_place_of_a_program(
    digest: str, tmp_path: Path
) -> None:
    assert digest_of(tmp_path, *robot_5(BARE)) == digest
    path = tmp_path / "mission.mcap"
    again = replay(LogFile(path))
    assert (again.same, again.robots, again.foreign) == (True, (1, 2, 3, 4), (5,))
    assert judge(LogFile(path)).violations == ()
    said = onehop("replay", path).stdout
    assert "no core to run here for robot 5: what they said is taken from the log\n" in said
    refused = onehop("replay", path, "--robot", "5")
    assert refused.returncode == 2
    assert "has no core to run here; another robot" in refused.stderr


def test_it_lives_through_what_is_done_to_it(tmp_path: Path) -> None:
    """Stopped, started again, killed: as the program that it ports."""
    words = ("--set", FAULTS)
    own = digest_of(tmp_path / "own", "--driver", "inline", *words)
    assert digest_of(tmp_path / "bare", *words, *robot_5(BARE)) == own


def test_one_that_does_not_die_makes_room_all_the_same(tmp_path: Path) -> None:
    stubborn = "import os, bare_robot; os.kill = print; raise SystemExit(bare_robot.main())"
    words = ("--set", 'faults=[{kind="restart", at_s=1.0, robots=[5]}]', "--set", "clock.limit_s=3")
    digests = [
        run(tmp_path / f"{n}", *words, *more)["digest"]
        for n, more in enumerate(
            [("--driver", "inline"), robot_5(json.dumps(["python", "-c", stubborn]))]
        )
    ]
    assert digests[0] == digests[1]


def test_they_know_nothing_of_onehop() -> None:
    tree = ast.parse((EXAMPLES / "bare_robot.py").read_text())
    names = [one.names[0].name for one in ast.walk(tree) if isinstance(one, ast.Import)]
    names += [one.module or "" for one in ast.walk(tree) if isinstance(one, ast.ImportFrom)]
    foreign = {name.partition(".")[0] for name in names} - sys.stdlib_module_names
    assert foreign == {"zenoh", "msgpack"}
    package = tomllib.loads((EXAMPLES / "rust_robot" / "Cargo.toml").read_text())
    assert package["dependencies"].keys() == {"zenoh", "rmp", "rmpv", "sha2", "libc"}


def test_a_robot_in_rust_takes_the_place_of_a_program(digest: str, tmp_path: Path) -> None:
    if not (EXAMPLES / "rust_robot" / "target" / "debug" / "rust_robot").exists():
        pytest.skip("the robot in Rust is not built: make rust, with cargo; it takes minutes")
    built = subprocess.run(
        ["make", "rust"], cwd=EXAMPLES.parent, capture_output=True, text=True, check=False
    )
    assert built.returncode == 0, built.stderr
    assert "warning" not in built.stderr
    assert digest_of(tmp_path, *robot_5('["rust_robot/target/debug/rust_robot"]')) == digest


def test_a_command_that_is_nowhere_is_one_line(tmp_path: Path) -> None:
    done = onehop("run", SIMPLE, "--out", tmp_path / "out", *robot_5('["./nowhere"]'))
    assert done.returncode == 2
    what = "robots: command of robot 5: './nowhere' cannot be started (No such file or directory)"
    assert done.stderr.splitlines()[-1].startswith(f"onehop: {what}; a program in PATH, or ./NAME")


def test_a_password_is_in_the_environment_and_not_on_the_command_line(tmp_path: Path) -> None:
    look = "import os, sys; print(len(os.environ['ONEHOP_PASSWORD']), *sys.argv[1:], os.getcwd())"
    words = robot_5(json.dumps(["python", "-c", look + "; sys.exit(7)", "mine"]))
    reason = run(tmp_path, *words)["reason"]
    assert reason.startswith("the robot-5 process died (exit status 7): 32 ")
    length, first, *rest = (tmp_path / "stderr" / "robot-5.txt").read_text().split()
    assert (length, first) == ("32", "mine")
    assert rest[0::2][:4] == ["--mission", "--lifeline", "--id", "--connect"]
    assert Path(rest[-1]) == EXAMPLES
    assert len(rest) == 9
