"""A robot says no more in a tick than it may, however much the others make it say."""

from onehop.contracts.action_limits import NOTES, ActionLimits
from onehop.contracts.geometry import Pose
from robot_agent.core.team.outbox import Outbox
from robot_agent.core.team.team_messages import Ack

TEAM = (1, 2, 3)


def test_more_answers_than_may_be_sent_are_left_out():
    limits = ActionLimits(TEAM)
    outbox = Outbox(limits)
    for sequence in range(200):
        outbox.send(2, Ack(1, sequence, True, Pose(0.0, 0.0, 0.0)), 60)
    assert len(outbox.take_outbox()) == limits.messages
    assert outbox.take_outbox() == ()


def test_more_notes_than_may_be_told_are_left_out():
    outbox = Outbox(ActionLimits(TEAM))
    for epoch in range(200):
        outbox.note("joined", epoch=epoch)
    told = outbox.take_notes()
    assert len(told) < NOTES
    assert [note.data["epoch"] for note in told] == list(range(len(told)))
    assert outbox.take_notes() == ()
