"""A robot says no more in a tick than it may, however much the others make it say."""

from onehop.contracts.action_limits import NOTES, ActionLimits
from onehop.contracts.geometry import Pose
from robot_agent.core.team.outbox import Outbox
from robot_agent.core.team.team_messages import Ack

TEAM = (1, 2, 3)


def test_more_answers_than_may_be_sent_are_left_out():
    limits = ActionLimits(TEAM)
    outbox = Outbox(limits, 2_000)
    for sequence in range(200):
        outbox.send(2, Ack(1, sequence, True, Pose(0.0, 0.0, 0.0)), 60)
    assert len(outbox.take_outbox()) == limits.messages
    assert outbox.take_outbox() == ()


def test_messages_live_as_long_as_all_others_unless_they_say_so():
    outbox = Outbox(ActionLimits(TEAM), 2_000)
    for lifetime_ns in (None, 0, 7):
        outbox.send_to((2,), Ack(1, 1, True, Pose(0.0, 0.0, 0.0)), 60, lifetime_ns)
    assert [one.lifetime_ns for one in outbox.take_outbox()] == [2_000, 0, 7]


def test_more_notes_than_may_be_told_are_left_out():
    outbox = Outbox(ActionLimits(TEAM), 2_000)
    for epoch in range(200):
        outbox.note("joined", epoch=epoch)
    told = outbox.take_notes()
    assert len(told) < NOTES
    assert [note.data["epoch"] for note in told] == list(range(len(told)))
    assert outbox.take_notes() == ()
