"""The table of modes, and the diagram drawn from it."""

from pathlib import Path

import pytest

from onehop.contracts.team import Mode
from robot_agent.core.team.modes import RESTART, START, TABLE, ModeEvent, diagram, next_mode
from robot_agent.core.team.part import MODES


def test_every_mode_has_a_row_and_can_be_reached():
    assert set(TABLE) == set(Mode)
    reached, frontier = {START, RESTART}, [START, RESTART]
    while frontier:
        for target in TABLE[frontier.pop()].values():
            if target not in reached:
                reached.add(target)
                frontier.append(target)
    assert reached == set(Mode)


def test_every_event_means_something_somewhere():
    assert {event for row in TABLE.values() for event in row} == set(ModeEvent)


def test_an_obstacle_interrupts_algorithm_1_and_the_clear_resumes_it():
    """Thesis 3.3.4."""
    assert next_mode(Mode.FOLLOWING, ModeEvent.OBSTRUCTED) is Mode.BORDER
    assert next_mode(Mode.BORDER, ModeEvent.TOLD_NEXT) is Mode.BORDER
    assert next_mode(Mode.BORDER, ModeEvent.CLEARED) is Mode.FOLLOWING


@pytest.mark.parametrize("mode", [Mode.SETUP, Mode.FOLLOWING, Mode.NARROW, Mode.BORDER, Mode.STOPPED])
def test_a_silent_leader_is_lost_from_every_mode_of_a_follower(mode):
    assert next_mode(mode, ModeEvent.LEADER_SILENT) is Mode.LOST_LEADER


def test_every_mode_can_come_to_lead_and_to_follow():
    for mode in Mode:
        assert next_mode(mode, ModeEvent.ELECTED) is Mode.LEADING
        assert next_mode(mode, ModeEvent.TOLD_NEXT) in (Mode.FOLLOWING, Mode.BORDER)


def test_a_transition_that_the_table_lacks_is_an_error_that_names_it():
    with pytest.raises(LookupError, match="no transition from leading on obstructed"):
        next_mode(Mode.LEADING, ModeEvent.OBSTRUCTED)


def test_every_mode_belongs_to_a_part_and_every_part_can_reach_all_of_its_modes():
    assert frozenset.union(*MODES.values()) == frozenset(Mode)
    reached = {target for row in TABLE.values() for target in row.values()} | {START, RESTART}
    assert all(modes <= reached for modes in MODES.values())


def test_the_diagram_read_back_is_the_table():
    rows = {}
    for line in diagram().splitlines()[1:]:
        source, rest = line.strip().split(" --> ")
        target, _, events = rest.partition(": ")
        for event in events.split(", "):
            assert rows.setdefault(source, {}).setdefault(event, target) == target
    start = rows.pop("[*]")
    assert set(start.values()) == {START.value, RESTART.value}
    everywhere = rows.pop("any_mode")
    named = {mode.value.replace(" ", "_"): mode for mode in Mode}
    for mode, row in TABLE.items():
        own = rows.get(mode.value.replace(" ", "_"), {})
        assert set(own) <= {event.value for event in row}
        for event, target in row.items():
            shown = own.get(event.value, everywhere.get(event.value))
            assert (mode if shown is None else named[shown]) is target


def test_the_diagram_in_the_docs_is_the_one_of_the_table():
    text = (Path(__file__).parents[3] / "docs" / "modes.md").read_text()
    shown = text.split("```mermaid\n")[1].split("```")[0]
    assert shown == diagram(), (
        "put what robot_agent.core.team.modes.diagram() returns into docs/modes.md"
    )
