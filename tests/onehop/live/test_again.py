"""The command and the lines that repeat a mission with what was done to it by hand."""

import shlex
from dataclasses import replace
from pathlib import Path

from onehop.analysis.log import open_log
from onehop.contracts.fault_section import FaultSection
from onehop.live.again import all_faults, by_hand, command, lines
from onehop.scenario import scenario_file
from tests.onehop.analysis.conftest import scenario

HELD, KILLED = scenario().faults
HAND = FaultSection("jam", 1.25, x=3.0, y=4.0, radius=2.0)


def test_what_the_scenario_has_caused_was_not_done_by_hand() -> None:
    begun = [HAND, HELD.begun(2.0), KILLED.begun(4.0)]
    assert by_hand(scenario(), begun) == [HAND]
    assert by_hand(scenario(), begun[1:]) == []


def test_a_line_that_has_not_begun_is_kept_and_one_between_two_ticks_begins_with_the_next() -> None:
    late = replace(scenario(), faults=(replace(HELD, at_s=2.01), replace(KILLED, at_s=99.0)))
    begun = [HAND, HELD.begun(2.05)]
    assert by_hand(late, begun) == [HAND]
    assert all_faults(late, begun) == [*late.faults, HAND]


def test_a_line_that_follows_an_event_has_caused_the_fault_of_its_kind_that_fits() -> None:
    follows = FaultSection("hold", on="leader elected", nth=2, duration_s=3.0)
    one = replace(scenario(), faults=(follows,))
    caused = FaultSection("hold", 7.5, robots=(3,), duration_s=3.0)
    other = FaultSection("hold", 7.5, robots=(3,), duration_s=4.0)
    assert by_hand(one, [other, caused]) == [other]


def test_the_command_is_that_of_the_mission_and_the_faults(tmp_path: Path) -> None:
    quiet = replace(scenario(), faults=())
    words = ("my map.toml", "--seed", "1", "--set", "team.size=4")
    assert shlex.split(command(words, quiet, [])) == ["onehop", "run", *words]
    typed = shlex.split(command(words, quiet, [HAND]))
    assert typed[-2] == "--set"
    file = tmp_path / "one.toml"
    file.write_text('name="one"\n[goal]\nx=1\ny=1\n[map]\nwidth=9\nheight=9\n[start]\nx=1\ny=1\n')
    assert scenario_file.load(file, [typed[-1]]).scenario.faults == (HAND,)
    file.write_text(lines(quiet, [HAND]) + "\n" + file.read_text())
    assert scenario_file.load(file, []).scenario.faults == (HAND,)
    assert lines(quiet, []) == ""


def test_the_faults_of_a_log_that_nobody_touched_are_those_of_its_scenario(log_path: Path) -> None:
    log = open_log(log_path)
    begun = [fault for _, truth in log.truths() for fault in truth.faults]
    assert len(begun) == 2
    assert all_faults(log.scenario, begun) == list(log.scenario.faults)
