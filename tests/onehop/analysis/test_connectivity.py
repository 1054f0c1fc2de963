"""Links and pieces of a team, as the radio weakens signals."""

import pytest

from onehop.analysis.connectivity import Connectivity, Pair, is_connected
from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Cut, Jam, Presence, Truth
from onehop.contracts.radio_section import RadioSection

REACH = 25.118864
"""Where 60 dB at 1 m have become 32 dB over free space [m] (thesis 3.7)."""


def links(xs: list[float], cuts=(), jams=(), walls=(), **keys: object) -> dict[tuple[int, int], bool]:
    robots = tuple(range(1, len(xs) + 1))
    present = tuple(
        Presence(i, 0, Pose(x, 0.0, 0.0), Twist(0.0, 0.0), False)
        for i, x in zip(robots, xs, strict=True)
    )
    found = Connectivity(RadioBriefing(1, 50_000_000, robots, RadioSection(**keys), walls), 800)
    pairs = found.pairs(Truth(0, 0, present, (), cuts, jams, (), ()))
    return {(pair.robot, pair.other): pair.linked for pair in pairs}


@pytest.mark.parametrize(("distance", "linked"), [(REACH - 0.01, True), (REACH + 0.01, False)])
def test_a_link_reaches_as_far_as_the_mean_snr_is_at_the_threshold(distance, linked) -> None:
    assert links([0.0, distance]) == {(1, 2): linked}


def test_bit_errors_end_a_link_where_the_threshold_does_not() -> None:
    """Preset `indoor` hears from 0 dB on; at 11 Mb/s a Next has an error there."""
    far = 600.0
    keys = {"preset": "indoor", "spatial_shadowing_db": 0.0}
    assert links([0.0, far], **keys) == {(1, 2): True}
    assert links([0.0, far], rate_mbps=11.0, **keys) == {(1, 2): False}


def test_cuts_jams_and_walls_count() -> None:
    assert links([0.0, 5.0], cuts=(Cut((1,), (2,), one_way=True),)) == {(1, 2): False}
    assert links([0.0, 5.0], jams=(Jam(5.0, 0.0, 1.0, -20.0),)) == {(1, 2): False}
    wall = ((2.0, -1.0, 2.0, 1.0),)
    assert links([0.0, 20.0], walls=wall) == {(1, 2): True}
    assert links([0.0, 20.0], walls=wall, wall_loss_db=10.0) == {(1, 2): False}


def test_places_differ_under_spatial_shadowing() -> None:
    found = [links([0.0, at], spatial_shadowing_db=9.0)[1, 2] for at in range(18, 34)]
    assert len(set(found)) == 2
    assert found != sorted(found, reverse=True)


def test_a_chain_is_connected_and_a_gap_parts_it() -> None:
    chain = [Pair(1, 2, 40.0, True), Pair(1, 3, 20.0, False), Pair(2, 3, 40.0, True)]
    assert is_connected([1, 2, 3], chain)
    assert not is_connected([1, 2, 3], chain[:2])
    assert is_connected([7], [])
    assert is_connected([], [])
