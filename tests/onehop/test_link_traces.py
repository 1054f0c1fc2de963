"""Links from measurements: read line by line, in force tick by tick, in the log, and judged by it."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.analysis import open_log
from onehop.campaign.process_mission import self_contained, write_scenario
from onehop.chaos.swarm import draw_mission
from onehop.checking import judge
from onehop.checking.reach import Budget, measured
from onehop.contracts.errors import InputError
from onehop.contracts.link_trace import LinkSeries, LinkTrace
from onehop.contracts.radio_section import RadioSection
from onehop.drivers.replay import replay
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.scenario.link_trace import link_trace, parse
from onehop.wire.log_reader import LogFile
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.measured_links import MeasuredLinks, value_at
from radio_proxy.core.path_loss import OWN_DB
from tests.onehop.forgery import Forgery
from tests.onehop.scenes import field, log_of

ROBOTS = (1, 2, 3, 4)
GOOD = "# ours\ntime_s,from,to,snr_db\n\n0,1,2,40\n10,1,2,50\n20,1,2,\n30,1,2,45\n5,2,1,44\n"
REPOSITORY = Path(__file__).parents[2]


def traced(text: str, **radio: str) -> LinkTrace:
    section = RadioSection(links="t.csv", **radio)  # type: ignore[arg-type]
    return parse(text.encode(), "m: t.csv", ROBOTS, section)


def test_a_link_is_linear_between_rows_held_at_the_ends_and_lost_where_it_has_no_value() -> None:
    one, other = traced(GOOD).series
    said = {t: value_at(one, round(t * 1e9)) for t in (0, 5, 10, 15, 19.99, 20, 29, 30, 99)}
    assert said == {0: 40, 5: 45, 10: 50, 15: 50, 19.99: 50, 20: None, 29: None, 30: 45, 99: 45}
    assert (other.sender, other.receiver, value_at(other, 0)) == (2, 1, 44)


def test_power_and_loss_are_the_snr_that_they_leave() -> None:
    section = RadioSection(links="t.csv")
    budget = link_budget(section)
    for quantity, value in (
        ("snr_db", 40.0),
        ("rssi_dbm", 40.0 + budget.noise_dbm),
        ("loss_db", 10.0 * math.log10(200.0) - budget.noise_dbm - 40.0),
    ):
        trace = traced(f"time_s,from,to,{quantity}\n0,1,2,{value}\n")
        snr = MeasuredLinks(trace, section, budget).snr_db(1, 0)[2]
        assert snr == pytest.approx(40.0, abs=1e-3)


WRONG = {
    "": "m: t.csv:1: '' is no header; time_s,from,to,snr_db or time_s,",
    "time,from,to,snr_db\n": "m: t.csv:1: 'time,from,to,snr_db' is no header; ",
    "time_s,from,to,snr_db\n": "m: t.csv: no row below the header; ",
    "# x\ntime_s,from,to,snr_db\n1,2,3\n": "m: t.csv:3: 3 values in a row; 4, as in ",
    "time_s,from,to,snr_db\n1,2,3,x\n": "m: t.csv:2: snr_db 'x'; a number from -150 to 150",
    "time_s,from,to,snr_db\n1,2,3,nan\n": "m: t.csv:2: snr_db 'nan'; ",
    "time_s,from,to,rssi_dbm\n1,2,3,-151\n": "m: t.csv:2: rssi_dbm '-151'; ",
    "time_s,from,to,snr_db\n-1,2,3,5\n": "m: t.csv:2: time_s '-1'; a number from 0 to 1e+06",
    "time_s,from,to,snr_db\n1,9,3,5\n": "m: t.csv:2: from '9' is no robot of the team; one of 1, 2,",
    "time_s,from,to,snr_db\n1,3,3,5\n": "m: t.csv:2: a link of robot 3 to itself; two robots",
    "time_s,from,to,snr_db\n1,2,3,5\n1,3,2,5\n1,2,3,6\n": "m: t.csv:4: 1 s is not after the row before",
}


@pytest.mark.parametrize("text", WRONG)
def test_a_line_that_cannot_be_is_named_with_its_number(text: str) -> None:
    with pytest.raises(InputError) as refused:
        traced(text)
    assert WRONG[text] in str(refused.value)
    assert "\n" not in str(refused.value)


def test_an_snr_cannot_come_on_top_of_the_model() -> None:
    with pytest.raises(InputError, match=r'column loss_db, or links_use = "instead"'):
        traced(GOOD, links_use="on top")


cell = st.one_of(st.sampled_from(["", "1", "2", "3.5", "1e3", "nan", "-7", "#", "²", "\x00"]), st.text())


@given(st.lists(st.lists(cell, max_size=5), max_size=6), st.booleans())
def test_whatever_stands_in_a_file_is_a_trace_or_one_line(rows: list[list[str]], headed: bool) -> None:
    text = "time_s,from,to,loss_db\n" * headed + "\n".join(map(",".join, rows))
    said = ""
    series: tuple[LinkSeries, ...] = ()
    try:
        series = parse(text.encode("utf-8", "replace"), "m", ROBOTS, RadioSection()).series
    except InputError as error:
        said = str(error)
    assert said.isprintable()
    assert bool(said) != bool(series)
    assert all({one.sender, one.receiver} <= set(ROBOTS) for one in series)


levels = st.one_of(st.none(), st.floats(-150.0, 150.0))
course = st.lists(st.tuples(st.integers(1, 50), levels), min_size=1, max_size=6)


@given(course, st.integers(0, 300), st.sampled_from(["snr_db", "rssi_dbm", "loss_db"]))
def test_radio_and_checker_read_the_same_out_of_a_trace(
    steps: list[tuple[int, float | None]], time_s: int, quantity: str
) -> None:
    text, at = f"time_s,from,to,{quantity}\n", 0
    for step, value in steps:
        at += step
        text += f"{at},1,2,{'' if value is None else repr(value)}\n"
    trace, section = traced(text), RadioSection(links="t.csv")
    ours = MeasuredLinks(trace, section, link_budget(section)).snr_db(1, time_s * 10**9)[2]
    other = measured(trace, section, Budget(section))
    assert other is not None
    theirs = other.mean_db(1, 2, time_s * 10**9, 0.0)
    assert theirs == (-math.inf if ours is None else pytest.approx(ours, abs=0.01))
    matrix = other.matrix_db(ROBOTS, time_s * 10**9, np.zeros((4, 4)))
    assert matrix[0, 1] == theirs
    assert np.isneginf(matrix[1, 0])


def trial(folder: Path, rows: str, *settings: str) -> Bundle:
    (folder / "trial.csv").write_text(rows)
    return field(folder, "radio.links='trial.csv'", "radio.shadowing_db=0", *settings)


def everyone(quantity: str, value: float) -> str:
    pairs = [(a, b) for a in ROBOTS for b in ROBOTS if a != b]
    return f"time_s,from,to,{quantity}\n" + "".join(f"0,{a},{b},{value}\n" for a, b in pairs)


def test_every_frame_has_the_snr_that_was_measured_and_who_has_no_link_hears_nothing(
    tmp_path: Path,
) -> None:
    rows = everyone("snr_db", 41.0).replace("0,4,1,41.0\n", "").replace("0,1,4,41.0\n", "0,1,4,37.5\n")
    log_of(trial(tmp_path, rows, "clock.limit_s=12"), tmp_path / "mission.mcap")
    log = open_log(tmp_path / "mission.mcap")
    verdicts = log.table("verdicts")
    direct = np.array([len(path) == 2 for path in verdicts["path"].tolist()])
    levels = {
        (int(a), int(b)): round(float(snr), 6)
        for a, b, snr in verdicts.where(direct).rows("source", "receiver", "snr_db")
        if snr > -200.0
    }
    assert levels[2, 1] == 41.0
    assert set(levels.values()) <= {41.0, 37.5}
    assert levels.get((1, 4), 37.5) == 37.5
    reached = verdicts["status"] == "delivered"
    assert (4, 1) not in set(verdicts.where(direct & reached).rows("source", "receiver"))
    assert replay(LogFile(log.path)).same
    assert judge(LogFile(log.path)).holds


@pytest.mark.parametrize(
    ("quantity", "value", "use"),
    [("rssi_dbm", 150.0, "instead"), ("loss_db", -150.0, "instead"), ("loss_db", -150.0, "on top")],
)
def test_no_link_is_as_strong_as_an_emission_of_its_own(
    tmp_path: Path, quantity: str, value: float, use: str
) -> None:
    how = f"radio.links_use='{use}'"
    log_of(trial(tmp_path, everyone(quantity, value), how, "clock.limit_s=1"), tmp_path / "m.mcap")
    verdicts = open_log(tmp_path / "m.mcap").table("verdicts")
    assert len(verdicts)
    assert set(verdicts["status"].tolist()) == {"delivered"}
    assert verdicts["snr_db"].max() < OWN_DB


def test_on_top_of_the_model_a_loss_weakens_what_it_says(tmp_path: Path) -> None:
    levels = {}
    for name, loss in (("plain", 0.0), ("weaker", 6.0)):
        rows, use = everyone("loss_db", loss), "radio.links_use='on top'"
        log_of(trial(tmp_path, rows, use, "clock.limit_s=1"), tmp_path / f"{name}.mcap")
        levels[name] = open_log(tmp_path / f"{name}.mcap").table("verdicts")["snr_db"]
    assert levels["weaker"][:3] == pytest.approx(levels["plain"][:3] - 6.0)


@pytest.mark.slow
def test_a_trace_in_which_nobody_hears_anybody_makes_teams_of_one(tmp_path: Path) -> None:
    log_of(trial(tmp_path, everyone("snr_db", -50.0), "clock.limit_s=30"), tmp_path / "mission.mcap")
    log = LogFile(tmp_path / "mission.mcap")
    assert log.summary is not None
    assert {len(term["members"]) for term in log.summary["leaders"]} >= {1}
    assert judge(log).holds


def test_the_checker_goes_by_the_trace_of_the_log(tmp_path: Path) -> None:
    """In a jam: with a trace of weaker links, what arrived could not have had its SNR."""
    jam = "faults=[{kind='jam', at_s=0.5, x=8, y=8, radius=60, noise_dbm=-75, duration_s=5}]"
    bundle = trial(tmp_path, everyone("snr_db", 60.0), "clock.limit_s=5", jam)
    log_of(bundle, tmp_path / "mission.mcap")
    assert judge(LogFile(tmp_path / "mission.mcap")).holds
    forgery = Forgery(tmp_path / "mission.mcap")
    forgery.bundle.files["trial.csv"] = everyone("snr_db", 20.0).encode()
    assert set(judge(forgery.write(tmp_path / "forged.mcap")).broken) == {"fault-bit"}


def test_a_log_without_its_trace_is_refused(tmp_path: Path) -> None:
    bundle = trial(tmp_path, everyone("snr_db", 40.0), "clock.limit_s=1")
    log_of(bundle, tmp_path / "mission.mcap")
    forgery = Forgery(tmp_path / "mission.mcap")
    forgery.bundle.files.clear()
    with pytest.raises(InputError, match=r"radio\.links: trial\.csv: the file is not there"):
        replay(forgery.write(tmp_path / "forged.mcap"))


def test_a_missing_file_and_a_wrong_line_are_told_as_the_scenario_is_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"field.toml: radio.links: .*No such file"):
        field(tmp_path, "radio.links='nowhere.csv'")
    with pytest.raises(InputError, match=r"field.toml: radio.links: trial.csv:2: to '9' is no robot"):
        trial(tmp_path, "time_s,from,to,snr_db\n0,1,9,5\n")


@pytest.mark.parametrize("setting", ["radio.links='trial.csv'", "radio.neighbours=true"])
def test_what_only_a_modelled_radio_has_is_refused_beside_a_bound(tmp_path: Path, setting: str) -> None:
    with pytest.raises(InputError, match='set beside link = "perfect"; link = "modelled"'):
        field(tmp_path, setting, "radio.link='perfect'")


def test_a_mission_that_is_copied_takes_its_trace_along(tmp_path: Path) -> None:
    bundle = self_contained(trial(tmp_path, GOOD), "m")
    (tmp_path / "copy").mkdir()
    path = write_scenario(bundle, tmp_path / "copy" / "scenario.toml")
    assert link_trace(scenario_file.load(path)) == traced(GOOD)


def test_chaos_leaves_the_trace_of_another_team_away(tmp_path: Path) -> None:
    drawn = draw_mission(trial(tmp_path, GOOD), 1, budget=True)
    assert drawn.scenario.radio.links == ""


@pytest.mark.slow
def test_the_example_of_this_repository_loses_a_link_and_goes_around_it(tmp_path: Path) -> None:
    bundle = scenario_file.load(REPOSITORY / "scenarios" / "link-trace.toml")
    log_of(bundle, tmp_path / "mission.mcap")
    log = open_log(tmp_path / "mission.mcap")
    assert judge(LogFile(log.path)).holds
    verdicts = log.table("verdicts")
    between = (verdicts["source"] == 2) & (verdicts["receiver"] == 1) & (verdicts["destination"] == 1)
    hops = [
        (float(time), len(path) - 1) for time, path in verdicts.where(between).rows("time_s", "path")
    ]
    assert {count for time, count in hops if time < 25.0} == {1}
    assert {count for time, count in hops if 32.0 < time < 50.0} == {2}
    assert log.summary is not None
    assert log.summary["arrived"] == [1, 2, 3, 4]
