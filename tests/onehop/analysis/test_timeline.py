"""Who led whom: every roster that was acted on, and the one line of those who led most of the team."""

import numpy as np

from onehop.analysis.tables import Table
from onehop.analysis.timeline import main_line, reigns

Rows = list[tuple[int, int, int, tuple[int, ...], str]]
"""Tick, robot, leader that it obeys, members, shape; epoch 0."""


def status(rows: Rows) -> Table:
    tick, robot, leader, members, shape = zip(*rows, strict=True)
    packed = np.empty(len(rows), dtype=object)
    packed[:] = members
    ticks = np.array(tick)
    return Table(
        tick=ticks,
        time_s=ticks * 0.05,
        robot=np.array(robot),
        leader=np.array(leader),
        epoch=np.zeros(len(rows), dtype=np.int64),
        members=packed,
        shape=np.array(shape),
    )


TEAM, PART = (1, 2, 3), (1, 3)


def test_a_change_of_shape_is_a_new_reign_of_the_same_leader() -> None:
    table = status([(0, 2, 2, TEAM, "wedge"), (1, 2, 2, TEAM, "wedge"), (2, 2, 2, TEAM, "column")])
    assert [(r.at_s, r.leader, r.shape) for r in reigns(table)] == [
        (0.0, 2, "wedge"),
        (0.1, 2, "column"),
    ]


def test_a_leader_that_returns_reigns_anew() -> None:
    table = status([(0, 2, 2, TEAM, "wedge"), (1, 2, 3, TEAM, "wedge"), (2, 2, 2, TEAM, "wedge")])
    assert [r.at_s for r in reigns(table)] == [0.0, 0.1]


def test_a_follower_does_not_reign() -> None:
    assert reigns(status([(0, 1, 2, TEAM, "wedge"), (1, 1, 2, TEAM, "wedge")])) == []


def test_of_two_leaders_the_one_of_the_larger_roster_counts() -> None:
    table = status(
        [
            (0, 2, 2, TEAM, "wedge"),
            (1, 2, 2, (2,), "solo"),
            (1, 3, 3, PART, "column"),
            (2, 2, 2, TEAM, "wedge"),
        ]
    )
    assert [(r.at_s, r.leader) for r in main_line(table)] == [(0.0, 2), (0.05, 3), (0.1, 2)]
