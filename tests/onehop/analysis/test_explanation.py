"""Why a robot did what it did: its status, what it heard and missed, what was wrong around it."""

import json

import pytest

from onehop.analysis import Log
from onehop.analysis.explanation import explain
from onehop.analysis.explanation_text import explanation_text
from onehop.contracts.errors import InputError

from .conftest import HELD, HELD_S, KILLED_S, LEADER, SUCCESSOR


def test_a_follower_after_the_election_says_why_it_obeys_another(log: Log) -> None:
    assert log.summary is not None
    elected_s = next(r["at_s"] for r in log.summary["leaders"] if r["leader"] == SUCCESSOR)
    found = explain(log, 4, elected_s + 0.3)
    assert found.roster.value["leader"] == SUCCESSOR
    assert found.roster.value["members"] == [1, 3, 4]
    assert {"lost_leader"} <= {event["kind"] for event in found.events}
    assert found.next_s is not None
    assert found.next_s > KILLED_S
    assert any(f.source == SUCCESSOR and f.receiver == 4 and f.kind == "Next" for f in found.traces)


def test_silence_of_the_dead_leader_raises_k_rho(log: Log) -> None:
    found = explain(log, 4, KILLED_S + 0.5)
    assert found.status["throughput_bps"] == 0.0
    assert found.k_rho.value == log.scenario.gains.k_rho_max
    assert "a Next is missing" in "\n".join(explanation_text(found))


def test_status_is_that_of_the_tick_asked_for(log: Log) -> None:
    found = explain(log, 3, 2.5)
    (_, action), *_ = log.actions(3, 2.5, 2.5)
    assert found.tick == log.tick_at(2.5)
    assert found.status["error"] == action.status.error
    assert found.mode.value == action.status.mode.value


def test_a_dead_robot_is_explained_as_it_was_last(log: Log) -> None:
    found = explain(log, LEADER, KILLED_S + 2.0)
    assert found.left is not None
    assert "killed" in found.left["why"]
    assert found.at_s < KILLED_S
    assert "It left at" in "\n".join(explanation_text(found))


def test_before_its_death_a_robot_has_not_left(log: Log) -> None:
    assert explain(log, LEADER, KILLED_S - 1.0).left is None


def test_a_fault_in_force_is_named(log: Log) -> None:
    assert explain(log, HELD, HELD_S + 0.5).faults == (
        "it is held: it stands still whatever it commands",
    )
    assert explain(log, HELD, HELD_S - 0.5).faults == ()


def test_the_json_object_can_be_written_and_has_what_scripts_need(log: Log) -> None:
    plain = json.loads(json.dumps(explain(log, 4, 3.0).as_json(), allow_nan=False))
    assert {"robot", "at_s", "tick", "mode", "roster", "k_rho", "error", "messages", "events"} <= set(
        plain
    )
    assert plain["messages"]
    assert {"source", "receiver", "kind", "status", "says"} <= set(plain["messages"][0])


@pytest.mark.parametrize(("robot", "at_s"), [(9, 1.0), (1, -1.0), (1, 1e6)])
def test_a_question_that_the_log_cannot_answer_is_refused(log: Log, robot: int, at_s: float) -> None:
    with pytest.raises(InputError):
        explain(log, robot, at_s)
