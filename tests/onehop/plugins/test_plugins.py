"""Plugins by name: found, of the right shape, used by every driver, and told from what is built in."""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from onehop.analysis import Log, open_log
from onehop.checking import judge
from onehop.checking.invariants import ONE_LEADER
from onehop.contracts.errors import InputError
from onehop.contracts.scenario import BUILT_IN
from onehop.drivers.replay import replay
from onehop.drivers.trial import run_trial
from onehop.maps.map_file import load_map
from onehop.plugins import KINDS, check, installed, load, misshapen
from onehop.programs.find import check as check_all
from onehop.scenario.bundle import changed
from onehop.wire.log_reader import LogFile
from radio_proxy.core import path_loss
from radio_proxy.core.path_loss import OWN_DB, SILENT_DB, HeldToRange
from radio_proxy.core.routing import built_in as routing
from robot_agent.core.motion import gains
from robot_agent.core.planning import pathfinder
from tests.onehop.command_line import in_shell as onehop
from tests.onehop.scenes import field, log_of

pytestmark = pytest.mark.usefixtures("parts")


def notes_beeline(log: Log) -> bool:
    return "beeline" in set(log.table("notes")["kind"].tolist())


def has_a_steady_gain(log: Log) -> bool:
    status = log.table("status")
    following = status["throughput_bps"] > 0.0
    return set(status["k_rho"][following].tolist()) == {2.0}


def drops_what_is_short(log: Log) -> bool:
    verdicts = log.table("verdicts")
    short = (verdicts["msdu_bytes"] < 800) & (verdicts["destination"] != 0)
    return set(verdicts["status"][short].tolist()) == {"no route"}


def is_heard_at_50_db(log: Log) -> bool:
    return set(np.round(log.table("verdicts")["snr_db"], 6).tolist()) == {50.0}


@pytest.mark.parametrize(
    ("settings", "shows"),
    [
        (("planner.kind=beeline", "clock.limit_s=12"), notes_beeline),
        (("gains.policy=steady", "clock.limit_s=8"), has_a_steady_gain),
        (("radio.routing=deaf", "clock.limit_s=3"), drops_what_is_short),
        (("radio.propagation=flat", "radio.shadowing_db=0", "clock.limit_s=3"), is_heard_at_50_db),
    ],
)
def test_a_mission_goes_by_the_plugin_that_it_names(
    tmp_path: Path, settings: tuple[str, ...], shows: Callable[[Log], bool]
) -> None:
    log_of(field(tmp_path, *settings), tmp_path / "mission.mcap")
    assert shows(open_log(tmp_path / "mission.mcap"))
    log = LogFile(tmp_path / "mission.mcap")
    assert replay(log).same
    assert judge(log).holds


def test_a_module_beside_the_scenario_need_not_be_installed(tmp_path: Path) -> None:
    bundle = field(tmp_path, "gains.policy=spare_parts:Steady", "clock.limit_s=1")
    log_of(bundle, tmp_path / "mission.mcap")
    log = LogFile(tmp_path / "mission.mcap")
    assert log.bundle.folder == str(tmp_path)
    assert replay(log).same


def test_a_planner_alone_is_tried_with_plan(tmp_path: Path) -> None:
    scenario = field(tmp_path, "planner.kind=beeline").scenario
    trial = run_trial(scenario, load_map(scenario.map, {}))
    assert trial.summary()["reached"]
    assert trial.snapshots == ()


@pytest.mark.slow
def test_the_checker_does_not_guess_who_hears_whom_by_a_plugin(tmp_path: Path) -> None:
    log_of(field(tmp_path, "radio.propagation=flat", "clock.limit_s=30"), tmp_path / "mission.mcap")
    report = judge(LogFile(tmp_path / "mission.mcap"))
    assert report.holds
    assert "radio.propagation" in report.unexercised[ONE_LEADER]


def test_cores_and_entry_points_offer_the_same() -> None:
    cores = {
        "onehop.planners": pathfinder.BUILT_IN,
        "onehop.gain_policies": gains.BUILT_IN,
        "onehop.routing": routing.BUILT_IN,
        "onehop.propagation": path_loss.BUILT_IN,
    }
    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())["project"]
    for group, own in cores.items():
        assert set(own) == set(BUILT_IN[group]) == set(project["entry-points"][group])
        for name, value in project["entry-points"][group].items():
            assert load(group, value, name) is own[name]
            assert misshapen(KINDS[group], own[name]) is None
            assert value in [one.value for one in installed(group)]


UNKNOWN = {
    "planner.kind=beline": "field.toml: planner.kind: 'beline' is unknown; did you mean beeline?",
    "gains.policy=stedy": "field.toml: gains.policy: 'stedy' is unknown; did you mean steady?",
    "radio.routing=olsr": "radio.routing: 'olsr' is unknown; one of 'direct', 'mrsr', 'mrdv', 'deaf',",
    "radio.propagation=two": "radio.propagation: 'two' is unknown; one of 'log-distance', 'flat',",
    "planner.kind='no name'": "planner.kind: 'no name' is no name; letters and digits, or ",
    "planner.kind=3": "planner.kind: 3 is not a text in quotes; give a text in quotes",
}


@pytest.mark.parametrize("setting", UNKNOWN)
def test_a_name_that_nobody_offers_is_told_as_the_file_is_read(tmp_path: Path, setting: str) -> None:
    with pytest.raises(InputError) as refused:
        field(tmp_path, setting)
    assert UNKNOWN[setting] in str(refused.value)
    assert "\n" not in str(refused.value)


WRONG = {
    "planner.kind=broken": "m: planner.kind: 'broken' cannot be imported: ZeroDivisionError: ",
    "planner.kind=nowhere:Planner": "m: planner.kind: 'nowhere:Planner': No module named 'nowhere'; ",
    "gains.policy=absent": "m: gains.policy: 'absent' is not there; one as docs/plugins.md says of ",
    "gains.policy=shapeless": "m: gains.policy: 'shapeless' has no method heard; ",
    "radio.routing=narrow": "m: radio.routing: 'narrow' cannot be called with (nic, section, now); ",
    "radio.propagation=twice": (
        "m: radio.propagation: 'twice' is offered by several packages; one of spare_parts:Flat, "
    ),
}


@pytest.mark.parametrize("setting", WRONG)
def test_a_plugin_that_cannot_be_one_is_one_line_before_anything_starts(
    tmp_path: Path, setting: str
) -> None:
    scenario = field(tmp_path, setting).scenario
    for asked in (check, check_all):
        with pytest.raises(InputError) as refused:
            asked(scenario, "m")
        assert WRONG[setting] in str(refused.value)
        assert "\n" not in str(refused.value)


def test_a_log_can_be_read_where_its_plugins_are_not(tmp_path: Path) -> None:
    scenario = field(tmp_path).scenario
    away = changed(scenario, ["gains.policy=from_elsewhere"])
    with pytest.raises(InputError, match="'from_elsewhere' is offered by no package"):
        check(away, "m")


def test_plugins_lists_all_with_where_they_come_from_and_what_is_wrong(parts: Path) -> None:
    done = onehop("plugins", "--json", PYTHONPATH=str(parts))
    groups = json.loads(done.stdout)
    assert done.returncode == 1
    rows = {(group, row["name"], row["package"]): row for group, own in groups.items() for row in own}
    assert rows["onehop.planners", "beeline", "spare_parts 1.2"]["problem"] is None
    assert rows["onehop.planners", "beeline", "spare_parts 1.2"]["value"] == "spare_parts:Beeline"
    problems = {name: row["problem"] for (_, name, package), row in rows.items() if "1.2" in package}
    assert "ZeroDivisionError" in problems["broken"]
    assert "name of a built-in one" in problems["smooth"]
    assert "several packages" in problems["twice"]
    ours = [row for row in rows.values() if row["package"].startswith("onehop ")]
    assert all(row["problem"] is None for row in ours)


def test_a_row_of_another_length_or_no_number_is_not_taken_over() -> None:
    class Odd:
        def place(self, places: object) -> None:
            self.places = places

        def row_db(self, sender: int) -> list[float]:
            return [float("nan"), 1e9, -1e9, float(sender)]

    held = HeldToRange(Odd())
    held.place([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), None])
    assert held.row_db(0) == [SILENT_DB, OWN_DB - 1.0, SILENT_DB, SILENT_DB]
    held.place([(0.0, 0.0)])
    with pytest.raises(ValueError, match="gave 4 values for 1 stations"):
        held.row_db(0)
