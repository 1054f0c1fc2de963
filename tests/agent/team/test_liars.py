"""Whatever a robot said: when it is gone, the rest are one team again (docs/modes.md, seven periods)."""

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onehop.contracts.geometry import Pose
from onehop.contracts.sections import TeamSection
from onehop.contracts.serial_numbers import LIMIT
from robot_agent.core.team.roster import Roster
from robot_agent.core.team.team_messages import (
    MAX_COORDINATE,
    Ack,
    Beacon,
    Command,
    CommandKind,
    Join,
    MissionPhase,
    TeamMessage,
    encode,
)
from tests.agent.team.team_net import TeamNet

LIAR = 6
QUIET_S = 7 * 2.0
EXTREMES = (0, 1, 2**31 - 2, 2**31 - 1, 2**31, LIMIT - 2, LIMIT - 1)
FAR = Pose(MAX_COORDINATE, -MAX_COORDINATE, 3.0)


def lies(epoch: int) -> list[TeamMessage]:
    """Every kind of message, with this epoch and extreme contents."""
    found: list[TeamMessage] = [Join(epoch, FAR), Ack(epoch, LIMIT - 1, True, FAR)]
    for members in ((1, 5, 6), (1, 2, 3, 4, 5, 6), (6,), (2, 3, 4)):
        roster = Roster(epoch, members)
        found += [
            Beacon(roster, phase, narrow, FAR)
            for phase, narrow in itertools.product(MissionPhase, (False, True))
        ]
        found += [
            Command(
                kind,
                roster,
                LIMIT - 1,
                phase,
                True,
                FAR,
                (2, 3),
                ((1.0, 1.0),),
                ((0.0, 0.0), (1.0, 1.0)),
            )
            for kind, phase in itertools.product(CommandKind, MissionPhase)
        ]
    return found


def one_team_after(net: TeamNet) -> None:
    """The liar falls silent; the others have the bound to agree."""
    net.run(QUIET_S)
    assert net.agree(), net.describe()
    assert len(net.leaders()) == 1, net.describe()


def team() -> TeamNet:
    """A team on its way, whose robot 6 is a liar from now on."""
    net = TeamNet(TeamSection())
    net.run(20.0)
    net.kill(LIAR)
    return net


@pytest.mark.parametrize("epoch", EXTREMES)
def test_one_lie_of_each_kind_with_an_extreme_epoch_does_not_split_the_team(epoch: int) -> None:
    for message in lies(epoch):
        net = team()
        for robot in sorted(net.members):
            net.inject(LIAR, robot, encode(message))
        one_team_after(net)


@given(
    st.lists(
        st.tuples(st.integers(1, 5), st.sampled_from(EXTREMES), st.integers(0, 999), st.integers(0, 12)),
        min_size=1,
        max_size=12,
    )
)
@settings(max_examples=40, deadline=None)
def test_lies_that_differ_from_robot_to_robot_do_not_split_the_team(
    told: list[tuple[int, int, int, int]],
) -> None:
    net = team()
    for robot, epoch, which, wait in told:
        messages = lies(epoch)
        net.inject(LIAR, robot, encode(messages[which % len(messages)]))
        for _ in range(wait):
            net.step()
    one_team_after(net)
