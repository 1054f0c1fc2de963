"""The commands that read a log, as a script sees them: status, one JSON object, one line of warning."""

import json
import sys
from pathlib import Path
from typing import Any

import msgpack
import pytest

from onehop.cli import main
from onehop.wire.log_reader import LogFile
from onehop.wire.log_writer import LogWriter
from tests.onehop.forgery import Forgery
from tests.onehop.log_forms import Form, chunks, ticks_of, write_form
from tests.onehop.scenes import field, log_of


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("log")
    log_of(field(folder, "clock.limit_s=4"), folder / "unflushed.mcap")
    source, path = LogFile(folder / "unflushed.mcap"), folder / "mission.mcap"
    writer = LogWriter(path, source.bundle, "inline")
    for tick in source.ticks():
        writer.write(tick.tick, tick.messages)
        if tick.tick % 10 == 0:
            writer.flush()
    writer.close(source.summary)
    return path


@pytest.fixture
def torn(recorded: Path, tmp_path: Path) -> Path:
    path = tmp_path / "torn.mcap"
    path.write_bytes(recorded.read_bytes()[: recorded.stat().st_size // 2])
    return path


class Answer:
    """What a command left behind."""

    def __init__(self, status: int, out: str, err: str) -> None:
        self.status, self.out, self.err = status, out, err

    @property
    def json(self) -> Any:
        return json.loads(self.out)


@pytest.fixture
def onehop(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Any:
    def call(*arguments: object) -> Answer:
        monkeypatch.setattr(sys, "argv", ["onehop", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        captured = capsys.readouterr()
        return Answer(int(left.value.code or 0), captured.out, captured.err)

    return call


def test_diff_of_a_log_with_itself_is_0(onehop: Any, recorded: Path) -> None:
    answer = onehop("diff", recorded, recorded, "--json")
    assert answer.status == 0
    assert answer.json["same"] is True
    assert answer.json["first"] is None


def test_diff_of_two_logs_is_1_and_names_the_end_of_the_shorter(
    onehop: Any, recorded: Path, torn: Path
) -> None:
    answer = onehop("diff", recorded, torn, "--json")
    assert answer.status == 1
    assert (answer.json["first"]["field"], answer.json["first"]["b"]) == ("tick", None)


def test_a_torn_log_is_read_with_one_line_of_warning(onehop: Any, torn: Path) -> None:
    answer = onehop("explain", torn, "--robot", 1, "--at", 1, "--json")
    assert answer.status == 0
    assert answer.json["robot"] == 1
    assert answer.err.count("\n") == 1
    assert "is torn" in answer.err


def test_replay_of_a_torn_log_warns_like_the_others(onehop: Any, torn: Path) -> None:
    answer = onehop("replay", torn, "--json")
    assert answer.status == 0
    assert answer.json["divergences"] == 0
    assert answer.json["ticks"] > 0
    assert answer.err.count("\n") == 1
    assert "warning" in answer.err


def test_explain_speaks_to_people(onehop: Any, recorded: Path) -> None:
    answer = onehop("explain", recorded, "--robot", 1, "--at", 2)
    assert answer.status == 0
    assert answer.out.startswith("Robot 1 at 2.00 s")
    assert "Messages to it and from it" in answer.out


def test_explain_of_a_stranger_is_2_in_one_line(onehop: Any, recorded: Path) -> None:
    answer = onehop("explain", recorded, "--robot", 99, "--at", 2)
    assert answer.status == 2
    assert answer.err.count("\n") == 1
    assert "not in the team" in answer.err


def test_salvage_says_what_was_lost(onehop: Any, torn: Path, tmp_path: Path) -> None:
    saved = tmp_path / "saved.mcap"
    answer = onehop("salvage", torn, "-o", saved)
    assert answer.status == 0
    assert "saved" in answer.out
    assert "no whole record" in answer.out
    again = onehop("diff", saved, torn, "--json")
    assert again.json["ticks"] > 0
    assert saved.name not in again.err


def test_salvage_overwrites_nothing(onehop: Any, torn: Path, recorded: Path) -> None:
    answer = onehop("salvage", torn, "-o", recorded)
    assert answer.status == 2
    assert "exists already" in answer.err


def test_view_does_not_overwrite_a_torn_log(onehop: Any, torn: Path) -> None:
    before = torn.read_bytes()
    assert onehop("view", torn).status == 2
    assert torn.read_bytes() == before


def test_view_writes_into_another_file(onehop: Any, recorded: Path, tmp_path: Path) -> None:
    before = recorded.read_bytes()
    answer = onehop("view", recorded, "-o", tmp_path / "view.mcap", "--json")
    assert answer.status == 0
    assert answer.json["topics"]["/tf"] > 10
    assert recorded.read_bytes() == before


@pytest.mark.slow
def test_report_lists_what_it_wrote(onehop: Any, recorded: Path, tmp_path: Path) -> None:
    answer = onehop("report", recorded, "--out", tmp_path, "--json")
    assert answer.status == 0
    assert Path(answer.json["report"]).read_text().startswith("<!doctype html>")
    assert {Path(figure).name for figure in answer.json["figures"]} >= {"timeline.png", "followers.png"}


@pytest.fixture
def short(recorded: Path, tmp_path: Path) -> Path:
    """The log without its last chunk."""
    head, *middle, tail = chunks(recorded.read_bytes(), tmp_path / "scratch")
    path = tmp_path / "short.mcap"
    path.write_bytes(b"".join((head, *middle[:-1], tail)))
    return path


MISSING = "ticks 71..79 are missing of 80"


def test_every_command_that_reads_all_of_a_log_says_what_is_missing_and_ends_with_1(
    onehop: Any, short: Path, recorded: Path, tmp_path: Path
) -> None:
    for command in (
        ("replay", short),
        ("diff", short, short),
        ("diff", recorded, short),
        ("view", short, "-o", tmp_path / "view.mcap"),
        ("salvage", short, "-o", tmp_path / "saved.mcap"),
    ):
        answer = onehop(*command)
        assert answer.status == 1, command
        assert MISSING in answer.out + answer.err, command


def test_explain_warns_of_what_is_missing(onehop: Any, short: Path) -> None:
    answer = onehop("explain", short, "--robot", 1, "--at", 2)
    assert answer.status == 0
    assert answer.err.count("\n") == 1
    assert MISSING in answer.err


@pytest.mark.slow
def test_a_report_says_what_is_missing(onehop: Any, short: Path, tmp_path: Path) -> None:
    answer = onehop("report", short, "--out", tmp_path / "report")
    assert answer.status == 1
    assert MISSING in answer.err
    assert MISSING in (tmp_path / "report" / "report.html").read_text()


def test_view_does_not_overwrite_a_log_that_lacks_something(onehop: Any, short: Path) -> None:
    before = short.read_bytes()
    answer = onehop("view", short)
    assert answer.status == 2
    assert MISSING in answer.err
    assert short.read_bytes() == before


def test_nothing_is_the_same_where_there_is_nothing(onehop: Any, recorded: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty.mcap"
    write_form(recorded, empty, Form(), [], outcome=False)
    for command in (("replay", empty), ("diff", empty, empty)):
        answer = onehop(*command)
        assert answer.status == 1
        assert "nothing was compared" in answer.out
        assert "it has not one tick" in answer.err


def test_replay_of_a_stretch_behind_the_end_is_1(onehop: Any, recorded: Path) -> None:
    answer = onehop("replay", recorded, "--from", 100)
    assert answer.status == 1
    assert "nothing was compared" in answer.out


@pytest.mark.parametrize(
    "arguments",
    [
        ("replay", "--to", "inf"),
        ("replay", "--to", "nan"),
        ("replay", "--from=-1"),
        ("replay", "--from", 5, "--to", 3),
        ("explain", "--robot", 1, "--at", "nan"),
        ("explain", "--robot", 1, "--at", "inf"),
        ("explain", "--robot", 1, "--at", 1, "--window", "nan"),
    ],
)
def test_a_time_that_is_none_is_refused_in_one_line(
    onehop: Any, recorded: Path, arguments: tuple[object, ...]
) -> None:
    command, *options = arguments
    answer = onehop(command, recorded, *options)
    assert answer.status == 2
    assert answer.err.count("\n") == 1
    assert "--" in answer.err


def test_the_json_of_a_divergence_is_json_whatever_was_said(
    onehop: Any, recorded: Path, tmp_path: Path
) -> None:
    ticks = ticks_of(recorded)
    fields = msgpack.unpackb(dict(ticks[3][1])["out/1"])
    fields["twist"]["v"] = float("nan")
    ticks[3] = 3, [(k, msgpack.packb(fields) if k == "out/1" else d) for k, d in ticks[3][1]]
    path = tmp_path / "nan.mcap"
    write_form(recorded, path, Form(), ticks)
    for command in (("replay", path, "--robot", 1), ("diff", path, recorded)):
        answer = onehop(*command, "--json")
        assert answer.status == 1
        first = json.loads(answer.out, parse_constant=pytest.fail)["first"]
        assert "nan" in (first.get("recorded"), first.get("a"))


def test_check_says_what_it_counted_and_what_was_never_exercised(onehop: Any, recorded: Path) -> None:
    answer = onehop("check", recorded)
    assert answer.status == 0
    assert answer.out.startswith("80 ticks (4.00 s) of 4 robots, profile team")
    assert "motion           held        316 ticks of robots" in answer.out
    assert "re-election      not asked   never exercised: no leader left" in answer.out
    assert answer.err == ""


def test_check_tells_a_script_every_promised_key(onehop: Any, recorded: Path) -> None:
    answer = onehop("check", recorded, "--json", "--only", "median", "--only", "silence")
    assert answer.status == 0
    assert answer.json["violations"] == []
    assert set(answer.json["checked"]) == {"median", "silence"}
    assert list(answer.json["unexercised"]) == ["silence"]


def test_check_names_a_violation_with_tick_robots_and_message(
    onehop: Any, recorded: Path, tmp_path: Path
) -> None:
    forgery, path = Forgery(recorded), tmp_path / "forged.mcap"
    forgery.say(range(50, 60), 4, shape="hexagon")
    forgery.write(path)
    answer = onehop("check", path)
    assert answer.status == 1
    assert "shape            BROKEN 1x" in answer.out
    assert "shape: tick 50 (2.50 s), robots 4: robot 4 drives as hexagon" in answer.out
    assert "tick 50 /wire/out/4: setup, epoch 0, leader 2 of 1 2 3 4, hexagon" in answer.out
    told = onehop("check", path, "--json").json["violations"]
    assert [(one["invariant"], one["tick"], one["robots"]) for one in told] == [("shape", 50, [4])]
    assert told[0]["evidence"][0]["topic"] == "/wire/out/4"


def test_check_of_a_torn_log_warns_and_judges_what_is_there(onehop: Any, torn: Path) -> None:
    answer = onehop("check", torn)
    assert answer.status == 0
    assert "is torn" in answer.err
    assert "digest           not asked" in answer.out


def test_check_of_a_log_that_lacks_ticks_is_1(onehop: Any, short: Path) -> None:
    answer = onehop("check", short)
    assert answer.status == 1
    assert "complete: tick" in answer.out
    assert "missing" in answer.out


def test_check_of_what_is_no_invariant_is_2_in_one_line(onehop: Any, recorded: Path) -> None:
    answer = onehop("check", recorded, "--only", "luck")
    assert answer.status == 2
    assert answer.err.count("\n") == 1
    assert "no-collision" in answer.err
