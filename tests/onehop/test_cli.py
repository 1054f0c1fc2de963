"""The command line: exit status, one line for what was typed wrong, one JSON object for scripts."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.reader import make_reader

from onehop.wire.log_reader import LogFile, digest
from tests.onehop.scenes import FIELD, field, log_of


def onehop(*arguments: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "onehop", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, cwd=cwd)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("log")
    log_of(field(folder, "clock.limit_s=5"), folder / "mission.mcap")
    return folder / "mission.mcap"


def test_elect_gives_leader_shape_and_slots_as_json() -> None:
    answer = onehop("elect", "1,2,4,5", "--json")
    assert answer.returncode == 0
    assert json.loads(answer.stdout)["leader"] == 2  # thesis 3.3.5, figure 3.4 (a)
    assert json.loads(answer.stdout)["shape"] == "diamond"
    assert [slot["robot"] for slot in json.loads(answer.stdout)["slots"]] == [1, 4, 5]


@pytest.mark.parametrize(
    "arguments",
    [
        ("elect", "a,b"),
        ("elect", "1,1"),
        ("elect", "0"),
        ("elect",),
        ("elect", "1,2", "--spacing", "-1"),
        ("run", "nowhere.toml"),
        ("run", "nowhere.toml", "--driver", "magic"),
        ("replay", "nowhere.mcap"),
        ("bogus",),
    ],
)
def test_bad_input_is_one_line_on_stderr_and_status_2(arguments: tuple[str, ...]) -> None:
    answer = onehop(*arguments)
    assert answer.returncode == 2
    assert answer.stdout == ""
    assert answer.stderr.startswith("onehop: ")
    assert answer.stderr.count("\n") == 1


def test_without_a_command_the_help_comes_and_status_2() -> None:
    told, asked = onehop(), onehop("--help")
    assert (told.returncode, asked.returncode) == (2, 0)
    assert told.stdout == asked.stdout
    assert told.stderr == ""


@pytest.mark.parametrize("command", ["run", "replay", "elect", "link", "saturate", "plan", "doctor"])
def test_help_has_an_example(command: str) -> None:
    answer = onehop(command, "--help")
    assert answer.returncode == 0
    assert f"Example: onehop {command}" in answer.stdout


def test_a_start_in_an_obstacle_is_refused_with_the_nearest_free_point(tmp_path: Path) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    answer = onehop("run", tmp_path / "field.toml", "--driver", "inline", "--start", "20,26")
    assert answer.returncode == 2
    assert "field.toml: start" in answer.stderr
    assert "nearest free point" in answer.stderr


def test_an_inline_run_gives_the_promised_keys_and_files(tmp_path: Path) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    answer = onehop("run", "field.toml", "--driver", "inline", "--json", "--out", "here", cwd=tmp_path)
    summary = json.loads(answer.stdout)
    assert answer.returncode == 0
    assert summary["outcome"] == "arrived"
    assert set(summary) == {
        "outcome", "reason", "arrived", "lost", "leaders", "ticks", "sim_s", "wall_s", "ticks_per_s",
        "real_time_factor", "processes", "digest", "log", "collisions",
    }  # fmt: skip
    assert summary["processes"] == []
    assert json.loads((tmp_path / "here" / "summary.json").read_text()) == summary
    assert (tmp_path / "here" / "trajectory.png").stat().st_size > 10_000


@pytest.mark.parametrize(("option", "seen"), [("--view", True), ("--no-view", False)])
def test_the_log_of_a_run_has_the_viewer_layer_unless_told_otherwise(
    tmp_path: Path, option: str, seen: bool
) -> None:
    bundle = field(tmp_path, "clock.limit_s=2")
    printed = log_of(bundle, tmp_path / "plain.mcap")
    answer = onehop(
        "run", "field.toml", "--driver", "inline", "--json", "--out", "here", option,
        "--set", "clock.limit_s=2", cwd=tmp_path,
    )  # fmt: skip
    log = tmp_path / "here" / "mission.mcap"
    with log.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert ("/tf" in {channel.topic for channel in summary.channels.values()}) is seen
    assert json.loads(answer.stdout)["digest"] == digest(LogFile(log)) == printed


def test_a_run_that_does_not_arrive_has_status_1(tmp_path: Path) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    answer = onehop(
        "run",
        "field.toml",
        "--driver",
        "inline",
        "--no-record",
        "--set",
        "clock.limit_s=2",
        cwd=tmp_path,
    )
    assert answer.returncode == 1
    assert "failed: time limit of 2 s" in answer.stdout


def test_replay_of_a_sound_log_says_0_divergences(recorded: Path) -> None:
    answer = onehop("replay", recorded, "--json")
    assert answer.returncode == 0
    found = json.loads(answer.stdout)
    assert (found["ticks"], found["robots"], found["divergences"]) == (100, [1, 2, 3, 4], 0)
    assert found["first"] is None


def test_replay_refuses_a_robot_that_is_not_in_the_team(recorded: Path) -> None:
    answer = onehop("replay", recorded, "--robot", "9")
    assert answer.returncode == 2
    assert "one of 1, 2, 3, 4" in answer.stderr


def test_doctor_finds_everything_that_a_run_needs_here() -> None:
    answer = onehop("doctor", "--json")
    assert answer.returncode == 0
    assert json.loads(answer.stdout)["healthy"] is True
