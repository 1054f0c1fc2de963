"""Programs of other people: found, given their parameters, run, judged, and fenced when they fail."""

import dataclasses
import json
from pathlib import Path

import pytest

from onehop.analysis.explanation import explain
from onehop.analysis.explanation_text import explanation_text
from onehop.analysis.log import open_log
from onehop.analysis.report.page import write_report
from onehop.analysis.view.layer import write_view
from onehop.checking import judge
from onehop.checking.invariants import WITHOUT_TEAM
from onehop.contracts.briefings import robot_briefing
from onehop.contracts.errors import InputError
from onehop.contracts.program_section import BUILT_IN
from onehop.drivers.replay import replay
from onehop.programs.find import check
from onehop.scenario import scenario_file
from onehop.scenario.as_toml import as_toml
from onehop.scenario.bundle import Bundle, bundle_from_json
from onehop.wire.log_reader import LogFile
from tests.onehop.programs.samples import FAILS_AT
from tests.onehop.scenes import field, log_of

SEEKER = "tests.onehop.programs.samples:Seeker"
UNREADY = "tests.onehop.programs.samples:Unready"
LIMIT = "clock.limit_s=60"
AROUND = "start.poses=[[20, 14, 0], [30, 4, 90], [38, 14, 180], [30, 24, -90]]"
"""Nobody is in another one's way to the goal."""


def seekers(folder: Path, *settings: str) -> Bundle:
    return field(folder, f"team.program='{SEEKER}'", LIMIT, *settings)


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four seekers, all the way."""
    folder = tmp_path_factory.mktemp("seekers")
    log_of(seekers(folder, AROUND), folder / "mission.mcap")
    return folder / "mission.mcap"


def test_a_program_drives_its_robots_to_the_goal_and_they_are_judged_by_where_they_are(
    mission: Path,
) -> None:
    summary = LogFile(mission).summary
    assert summary is not None
    assert (summary["outcome"], summary["reason"]) == ("arrived", "3 of 4 at the goal")
    assert summary["arrived"] == [1, 2, 3]  # robot 4 keeps 2.8 m away, and the room is 2.3 m
    assert summary["lost"][0]["why"] == "did not arrive"
    assert summary["leaders"] == []


def test_its_log_is_executed_again_and_checked_and_of_a_team_nothing_is_asked(mission: Path) -> None:
    log = LogFile(mission)
    assert replay(log).same
    report = judge(log)
    assert report.holds
    assert WITHOUT_TEAM.items() <= report.unexercised.items()
    assert report.checked["motion"] > 0


def test_what_it_shows_of_itself_is_a_table_a_figure_an_explanation_and_a_channel(
    mission: Path, tmp_path: Path
) -> None:
    log = open_log(mission)
    values = log.table("values")
    assert set(values["name"].tolist()) == {"to_goal", "heard"}
    own = values.of(2).where(values.of(2)["name"] == "to_goal")["value"]
    assert own[0] == 10.0
    assert 1.5 < own[-1] <= 1.6
    assert len(log.table("status")) == 0
    written = write_report(log, tmp_path)
    assert "values.png" in {path.name for path in written.figures}
    assert "followers.png" not in {path.name for path in written.figures}
    said = "\n".join(explanation_text(explain(log, 2, 5.0)))
    assert "shows    to_goal" in said
    assert "set out: distance" in said
    assert "100 bytes" in said
    assert explain(log, 2, 5.0).as_json()["mode"] is None
    copy = tmp_path / "viewed.mcap"
    copy.write_bytes(mission.read_bytes())
    write_view(open_log(copy), copy)
    topics = {channel.topic for channel in LogFile(copy).contents.channels}
    assert "/robot-2/values" in topics


FAILURES = {
    "raises": (
        "its program failed: LookupError: no map of "
        "<tests.onehop.programs.samples.Seeker object at 0x...> in tests.onehop.programs.samples:"
    ),
    "returns nothing": "its program failed: its step gave what is no Action that can be sent: NoneType",
    "says text": "put no action: Action: Expected `bytes`, got `str`",
    "exits": "its program failed: SystemExit: 0 in tests.onehop.programs.samples:",
    "recurses": "its program failed: RecursionError: maximum recursion depth exceeded",
}


@pytest.mark.parametrize("how", FAILURES)
def test_a_program_that_fails_takes_its_robot_out_and_nobody_elses(how: str, tmp_path: Path) -> None:
    entry = f"robots=[{{id=3, parameters={{how='{how}'}}}}]"
    log_of(seekers(tmp_path, entry, "clock.limit_s=3"), tmp_path / "failed.mcap")
    log = LogFile(tmp_path / "failed.mcap")
    assert log.summary is not None
    lost = {one["robot"]: one for one in log.summary["lost"]}
    assert lost[3]["at_s"] == pytest.approx(0.05 * (FAILS_AT + 1))
    why = lost[3]["why"]
    assert why.startswith(FAILURES[how])
    assert why.isprintable()
    assert len(why) <= 400
    assert str(Path(__file__).parents[3]) not in why
    assert log.summary["ticks"] == 60
    assert replay(log).same
    assert judge(log).holds
    left = explain(open_log(log.path), 3, 2.5).left
    assert left is not None
    assert left["why"] == why


def test_a_program_that_cannot_start_fails_at_its_first_tick(tmp_path: Path) -> None:
    bundle = seekers(tmp_path, f"robots=[{{id=2, program='{UNREADY}'}}]", "clock.limit_s=1")
    log_of(bundle, tmp_path / "unready.mcap")
    summary = LogFile(tmp_path / "unready.mcap").summary
    assert summary is not None
    why = {one["robot"]: (one["at_s"], one["why"]) for one in summary["lost"]}[2]
    place = "tests.onehop.programs.samples:"
    assert why[0] == 0.05
    assert why[1].startswith(f"its program failed: RuntimeError: robot 2 has no battery in {place}")


def test_five_of_the_team_and_one_of_ours_share_the_air(tmp_path: Path) -> None:
    """The team counts on its own alone: it does not wait for a robot that does not speak like it."""
    entry = f"robots=[{{id=4, program='{SEEKER}'}}]"
    bundle = field(tmp_path, entry, "team.size=4", "clock.limit_s=20")
    log_of(bundle, tmp_path / "mixed.mcap")
    log = LogFile(tmp_path / "mixed.mcap")
    assert log.summary is not None
    assert {tuple(one["members"]) for one in log.summary["leaders"]} == {(1, 2, 3)}
    assert replay(log).same
    report = judge(log)
    assert report.holds
    assert report.checked["median"] > 0
    status = open_log(log.path).table("status")
    assert set(status["robot"].tolist()) == {1, 2, 3}
    write_report(open_log(log.path), tmp_path / "report")


def test_a_robot_is_told_its_own_parameters_and_who_is_like_it(tmp_path: Path) -> None:
    entries = f"robots=[{{id=2, parameters={{speed=0.5}}}}, {{id=4, program='{BUILT_IN}'}}]"
    scenario = seekers(tmp_path, "team.parameters={speed=2.0, how=''}", entries).scenario
    briefings = {robot: robot_briefing(scenario, robot, 0) for robot in scenario.team.robots}
    assert briefings[1].parameters == {"speed": 2.0, "how": ""}
    assert briefings[2].parameters == {"speed": 0.5, "how": ""}
    assert (briefings[4].program, briefings[4].parameters) == (BUILT_IN, {})
    assert briefings[4].team.robots == (4,)
    assert briefings[1].team.robots == (1, 2, 3)
    assert briefings[1].robots == (1, 2, 3, 4)


MISTAKES = {
    "team.program='nowhere:Robot'": (
        "m: team.program: 'nowhere:Robot': No module named 'nowhere'; "
        '"package.module:Class", installed or in the folder of the scenario'
    ),
    "team.program='tests.onehop.programs.samples:Nobody'": "is no onehop.robot.Program; ",
    "team.program='tests.onehop.programs.samples:NotOne'": "is no onehop.robot.Program; ",
    "team.parameters={sped=1.0}": "m: team.parameters.sped: unknown key; did you mean speed?",
    "team.parameters={speed='fast'}": (
        "m: team.parameters.speed: 'fast' is not a number; give a number"
    ),
    "team.parameters={speed=9}": ("m: team.parameters.speed: 9.0 is out of range; a number from 0 to 3"),
    "team.parameters={inner={gain=-1}}": (
        "m: team.parameters.inner.gain: -1.0 is out of range; a number from 0 to 10"
    ),
    "robots=[{id=2, parameters={how='slowly'}}]": "m: robots[0].parameters.how: 'slowly' is unknown; ",
    f"robots=[{{id=2, program='{BUILT_IN}', parameters={{speed=1}}}}]": (
        "m: robots[0].parameters.speed: unknown key; "
    ),
}


@pytest.mark.parametrize("setting", MISTAKES)
def test_a_mistake_is_one_line_with_its_key(setting: str, tmp_path: Path) -> None:
    scenario = seekers(tmp_path, setting).scenario
    with pytest.raises(InputError) as refused:
        check(scenario, "m")
    assert MISTAKES[setting] in str(refused.value)
    assert "\n" not in str(refused.value)


WRONG_ENTRIES = {
    "robots=[{id=9}]": "robots[0].id: robot 9 is not in the team; one of 1, 2, 3, 4",
    "robots=[{id=2}, {id=2}]": "robots[1].id: robot 2 stands twice; every id once",
    "robots=[{id=2, program='no name'}]": "robots[0].program: 'no name' names no program; ",
    "robots=[{id=2, colour='red'}]": "robots[0].colour: unknown key; known keys: id, ",
    "team.program=''": "team.program: '' names no program; ",
    "team.parameters={at=2026-01-01}": "team.parameters.at: datetime.date(2026, 1, 1) cannot be",
    "team.parameters={x=inf}": "team.parameters.x: inf is no finite number; a finite number",
    f"team.parameters={{x=[{2**70}]}}": "team.parameters.x[0]: a whole number beyond 64 bits; ",
}


@pytest.mark.parametrize("setting", WRONG_ENTRIES)
def test_an_entry_that_no_robot_can_have_is_refused_as_it_is_read(setting: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        field(tmp_path, setting)
    assert WRONG_ENTRIES[setting] in str(refused.value)


def test_programs_and_parameters_survive_json_and_toml(tmp_path: Path) -> None:
    entries = f"robots=[{{id=2, parameters={{inner={{gain=0.5}}}}}}, {{id=4, program='{BUILT_IN}'}}]"
    bundle = seekers(tmp_path, "team.parameters={speed=2.0, 'odd key'=['a', true, 1]}", entries)
    assert bundle_from_json(bundle.scenario_json(), {}, "log") == bundle
    (tmp_path / "again.toml").write_text(as_toml(bundle.scenario))
    assert scenario_file.load(tmp_path / "again.toml").scenario == bundle.scenario
    assert json.loads(bundle.scenario_json())["robots"][0]["parameters"] == {"inner": {"gain": 0.5}}


def test_a_log_says_where_its_programs_lay_if_they_are_not_ours(mission: Path, tmp_path: Path) -> None:
    log = LogFile(mission)
    assert log.bundle.folder == str(mission.parent)
    log_of(field(tmp_path, "clock.limit_s=1"), tmp_path / "team.mcap")
    assert LogFile(tmp_path / "team.mcap").bundle.folder == ""


def test_nobody_moves_for_half_a_minute_and_the_mission_has_failed(tmp_path: Path) -> None:
    log_of(seekers(tmp_path, "team.parameters={speed=0.0}"), tmp_path / "rest.mcap")
    summary = LogFile(tmp_path / "rest.mcap").summary
    assert summary is not None
    assert (summary["outcome"], summary["reason"]) == ("failed", "nobody has moved for 30 s")


def test_the_built_in_team_is_a_program_like_any_other(tmp_path: Path) -> None:
    """By its name or without one: the same bytes."""
    plain = field(tmp_path, "clock.limit_s=2")
    named = field(tmp_path, "clock.limit_s=2", f"team.program='{BUILT_IN}'")
    assert dataclasses.replace(named.scenario) == plain.scenario
    first, second = (log_of(one, tmp_path / "log.mcap") for one in (plain, named))
    assert first == second
