"""The command line: exit status, one line for what was typed wrong, one JSON object for scripts."""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.reader import make_reader

from onehop.analysis.log import open_log
from onehop.wire.log_reader import LogFile, digest
from tests.onehop.command_line import in_shell, onehop
from tests.onehop.scenes import FIELD, field, log_of

MAP1 = Path(__file__).parents[2] / "scenarios" / "map1.toml"


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
        ("live", "nowhere.mcap"),
        ("live", "a.mcap", "b.mcap", "c.mcap"),
        ("run", "nowhere.toml", "--live", "--driver", "inline"),
        ("run", "nowhere.toml", "--live", "--no-record"),
        ("run", str(MAP1), "--live", "127.0.0.1:x", "--out", "{folder}"),
        ("bogus",),
    ],
)
def test_bad_input_is_one_line_on_stderr_and_status_2(
    arguments: tuple[str, ...], tmp_path: Path
) -> None:
    answer = onehop(*(word.format(folder=tmp_path) for word in arguments))
    assert answer.returncode == 2
    assert answer.stdout == ""
    assert answer.stderr.startswith("onehop: ")
    assert answer.stderr.count("\n") == 1


def test_a_real_base_whose_driver_has_no_way_in_is_refused_before_the_mission(tmp_path: Path) -> None:
    settings = ("--set", 'robots=[{id=2, base="hardware"}]', "--clock", "realtime")
    answer = onehop("run", str(MAP1), *settings, "--out", str(tmp_path / "out"))
    assert answer.returncode == 2
    assert answer.stderr == (
        "onehop: --bus: robot 2 has a real base, and its driver comes to this mission from elsewhere; "
        "--bus tls/HOST:PORT --keys DIR (docs/hardware.md), or base_command for one here\n"
    )
    assert not (tmp_path / "out").exists()


def test_without_a_command_the_help_comes_and_status_2() -> None:
    told, asked = onehop(), onehop("--help")
    assert (told.returncode, asked.returncode) == (2, 0)
    assert told.stdout == asked.stdout
    assert told.stderr == ""


@pytest.mark.parametrize(
    "command", ["run", "live", "replay", "elect", "link", "saturate", "plan", "chaos", "sweep", "doctor"]
)
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
        "real_time_factor", "processes", "digest", "log", "collisions", "energy",
    }  # fmt: skip
    assert [entry["robot"] for entry in summary["energy"]] == [1, 2, 3, 4]
    spent = open_log(tmp_path / "here" / "mission.mcap").table("energy").of(2)
    assert summary["energy"][1]["drive_j"] == pytest.approx(spent["drive_j"].sum(), abs=0.1)
    assert summary["energy"][1]["radio_j"] == pytest.approx(spent["radio_j"].sum(), abs=0.1)
    assert summary["processes"] == []
    assert json.loads((tmp_path / "here" / "summary.json").read_text()) == summary
    assert (tmp_path / "here" / "trajectory.png").stat().st_size > 10_000


@pytest.mark.parametrize(("options", "seen"), [((), True), (("--no-view", "--no-figure"), False)])
def test_a_run_has_the_viewer_layer_and_its_figure_unless_told_otherwise(
    tmp_path: Path, options: tuple[str, ...], seen: bool
) -> None:
    bundle = field(tmp_path, "clock.limit_s=2")
    printed = log_of(bundle, tmp_path / "plain.mcap")
    answer = onehop(
        "run", "field.toml", "--driver", "inline", "--json", "--out", "here", *options,
        "--set", "clock.limit_s=2", cwd=tmp_path,
    )  # fmt: skip
    log = tmp_path / "here" / "mission.mcap"
    with log.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert ("/tf" in {channel.topic for channel in summary.channels.values()}) is seen
    assert (tmp_path / "here" / "trajectory.png").exists() is seen
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


@pytest.mark.parametrize(
    ("limit", "check"),
    [("ulimit -n 30", "open files"), ("ulimit -f 0", "working folder")],
)
def test_doctor_tries_what_it_vouches_for(tmp_path: Path, limit: str, check: str) -> None:
    answer = in_shell("doctor", "--json", cwd=tmp_path, shell=limit)
    assert answer.returncode == 1
    found = json.loads(answer.stdout)
    assert found["healthy"] is False
    assert check in [one["name"] for one in found["checks"] if one["required"] and not one["ok"]]


@pytest.mark.parametrize("place", ["FILE", "FILE/below", "/proc/x"])
@pytest.mark.parametrize("driver", ["inline", "processes"])
def test_a_folder_that_cannot_be_written_is_refused_before_the_mission(
    tmp_path: Path, place: str, driver: str
) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    (tmp_path / "FILE").touch()
    answer = onehop("run", "field.toml", "--driver", driver, "--out", place, cwd=tmp_path)
    assert answer.returncode == 2
    assert answer.stderr.startswith(f"onehop: {place}: No")
    assert answer.stderr.count("\n") == 1


def test_a_folder_in_the_place_of_the_log_is_refused_before_the_mission(tmp_path: Path) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    (tmp_path / "out" / "mission.mcap").mkdir(parents=True)
    answer = onehop("run", "field.toml", "--out", "out", cwd=tmp_path)
    assert answer.returncode == 2
    assert answer.stderr.startswith("onehop: out/mission.mcap: Not a regular file")


def test_a_disk_that_fills_up_is_one_line_and_the_log_stays_up_to_there(tmp_path: Path) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    answer = in_shell(
        "run", "field.toml", "--driver", "inline", "--out", "out", cwd=tmp_path, shell="ulimit -f 400"
    )
    assert answer.returncode == 2
    assert answer.stderr.splitlines()[-1].startswith("onehop: out/mission.mcap: File too large")
    assert "Traceback" not in answer.stderr
    log = LogFile(tmp_path / "out" / "mission.mcap")
    assert log.torn
    assert sum(1 for _ in log.ticks()) > 100


def test_what_the_world_refuses_leaves_an_older_log_alone(tmp_path: Path, recorded: Path) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    (tmp_path / "out").mkdir()
    shutil.copy(recorded, tmp_path / "out" / "mission.mcap")
    answer = onehop(
        "run", "field.toml", "--driver", "inline", "--start", "20,26", "--out", "out", cwd=tmp_path
    )
    assert answer.returncode == 2
    assert (tmp_path / "out" / "mission.mcap").read_bytes() == recorded.read_bytes()


@pytest.mark.parametrize("backend", ["module://matplotlib_inline.backend_inline", "garbage"])
def test_a_notebooks_environment_does_no_harm(tmp_path: Path, backend: str) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    environment = {"MPLBACKEND": backend, "ZENOH_RUNTIME": "garbage"}
    limit = ("--set", "clock.limit_s=1")
    answer = in_shell(
        "run", "field.toml", "--driver", "inline", *limit, "--out", "out", cwd=tmp_path, **environment
    )
    assert (answer.returncode, answer.stderr.count("\n")) == (1, 1)  # a line of progress
    assert (tmp_path / "out" / "trajectory.png").stat().st_size > 10_000
    assert in_shell("doctor", **environment).returncode == 0


PANIC = """
import sys
from onehop import cli
cli.keep_to_own_settings = lambda: None
sys.argv = ["onehop", "doctor"]
cli.main()
"""


def test_a_panic_of_a_library_is_one_line_and_status_2() -> None:
    """Zenoh panics over a variable that the command keeps from it; Rust has said so before."""
    answer = subprocess.run(
        [sys.executable, "-c", PANIC],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "ZENOH_RUNTIME": "garbage"},
    )
    assert answer.returncode == 2
    assert answer.stderr.splitlines()[-1].startswith("onehop: a library failed: ")
    assert "Traceback" not in answer.stderr


BARE = ("plan", "field.toml", "--start", "8,8", "--goal")


def test_a_goal_where_the_robot_stands_is_reached(tmp_path: Path) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    answer = onehop(*BARE, "8,8", "--json", cwd=tmp_path)
    found = json.loads(answer.stdout)
    assert answer.returncode == 0
    assert (found["reached"], found["path_length_m"], found["shortest_m"]) == (True, 0.0, 0.0)
    assert "shortest       0.0 m on the known map\n" in onehop(*BARE, "8,8", cwd=tmp_path).stdout


@pytest.mark.parametrize(
    ("ending", "beginning"), [("png", b"\x89PNG"), ("SVG", b"<?xml"), ("pdf", b"%PDF-")]
)
def test_a_figure_is_what_its_ending_says(tmp_path: Path, ending: str, beginning: bytes) -> None:
    (tmp_path / "field.toml").write_text(FIELD)
    written = []
    for number in (1, 2):
        figure = tmp_path / f"{number}.{ending}"
        assert onehop(*BARE, "10,8", "--figure", figure, cwd=tmp_path).returncode == 0
        written.append(figure.read_bytes())
    assert written[0].startswith(beginning)
    assert written[0] == written[1]


@pytest.mark.parametrize("figure", ["x.jpg", "x", "none/x.png", "FOLDER.png", "/proc/x.png"])
def test_a_figure_that_cannot_be_written_is_refused_before_the_way_is_driven(
    tmp_path: Path, figure: str
) -> None:
    """The start is refused too, but later."""
    (tmp_path / "field.toml").write_text(FIELD)
    (tmp_path / "FOLDER.png").mkdir()
    answer = onehop("plan", "field.toml", "--start", "20,26", "--figure", figure, cwd=tmp_path)
    assert answer.returncode == 2
    assert figure in answer.stderr
    assert answer.stderr.count("\n") == 1


def test_output_that_cannot_be_written_is_one_line_and_status_2() -> None:
    full = in_shell("elect", "1,2,4", shell="exec >/dev/full")
    assert (full.returncode, full.stderr) == (2, "onehop: No space left on device\n")
    assert in_shell("elect", "1,2,4", shell="exec >&-").returncode == 0


def test_a_name_that_does_not_print_is_shown_in_one_line(tmp_path: Path) -> None:
    answer = onehop("run", "no\n\x1b[31mwhere.toml", cwd=tmp_path)
    assert answer.returncode == 2
    assert answer.stderr.startswith("onehop: no\\n\\x1b[31mwhere.toml: ")
    assert answer.stderr.count("\n") == 1


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_inline_mission_that_is_asked_to_end_finishes_its_log(
    tmp_path: Path, number: signal.Signals
) -> None:
    """Its leader creeps: it would be over before a busy machine sends a signal."""
    (tmp_path / "field.toml").write_text(FIELD)
    creeping = ["--set", "robot.leader_speed=0.05", "--set", "clock.limit_s=600"]
    command = ["run", "field.toml", "--driver", "inline", "--out", "out", *creeping]
    child = subprocess.Popen(
        [sys.executable, "-m", "onehop", *command], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    assert child.stderr is not None
    assert child.stderr.readline().startswith("field ")
    child.send_signal(number)
    _, said = child.communicate(timeout=60)
    assert child.returncode == 128 + number
    assert said.splitlines()[-1] == f"onehop: ended by {number.name}"
    log = LogFile(tmp_path / "out" / "mission.mcap")
    assert not log.torn
    assert log.summary is not None
    assert log.summary["reason"] == "stopped by the operator"
    assert log.summary["digest"] == digest(log)
