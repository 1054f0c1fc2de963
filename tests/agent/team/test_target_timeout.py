"""Thesis 4.3: who stands in its slot gives a silent leader up after T."""

import pytest

from onehop.contracts.geometry import Pose
from tests.agent.team.team_net import drive, thesis


@pytest.mark.parametrize(("keys", "most"), [({"target_timeout": 2.0}, 2.5), ({}, 6.0)])
def test_who_stands_in_its_slot_gives_a_silent_leader_up_t_later(keys, most):
    """Thesis 4.3: T after the target is reached; a quarter of a period is the grace of a Next."""
    net = drive(thesis(**keys))
    net.kill(3)
    killed = net.seconds
    while 4 not in net.leaders():
        net.step()
    assert most - 2.0 < net.seconds - killed <= most + 0.5


def test_who_has_not_reached_its_slot_waits_longer_for_its_leader_but_not_for_ever():
    net = drive(thesis(target_timeout=2.0))
    slot = net.members[5].pose
    held = Pose(slot.x - 3.0, slot.y, slot.heading)
    net.kill(3)
    killed, given_up = net.seconds, {}
    while net.seconds < killed + 8.0:
        net.members[5].pose = held
        net.step()
        for _, robot, note in net.notes:
            if note.kind == "lost_leader" and note.data["leader"] == 3:
                given_up.setdefault(robot, net.seconds - killed)
    assert max(given_up[i] for i in (1, 2, 4, 6)) <= 3.0
    assert 3.0 < given_up[5] <= 6.5
