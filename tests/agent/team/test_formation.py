"""Leader, shape and slots against the table and the examples of the thesis."""

import itertools
import math

import pytest

from onehop.contracts.team import Shape
from robot_agent.core.team.formation import formation, median_leader, shape_of, width

S = 4.0
HALF = S / math.sqrt(2.0)
WIDE = S * math.sqrt(3.0) / 2.0

SHAPES = {1: "solo", 2: "column", 3: "wedge", 4: "diamond", 5: "wedge", 6: "hexagon"}


def slots(ids, narrow=False):
    return {slot.robot: (slot.x, slot.y) for slot in formation(ids, narrow).slots}


def same(places, expected):
    """Whether two tables of slots are the same to within rounding."""
    assert places.keys() == expected.keys()
    return all(places[i] == pytest.approx(expected[i]) for i in expected)


@pytest.mark.parametrize(
    ("ids", "leader", "shape"),
    [
        ((1, 2, 3, 4, 5, 6), 3, "hexagon"),  # thesis 3.3.5: after setup the leader is 3
        ((1, 2, 3, 4, 6), 3, "wedge"),  # figure 3.3: 5 failed
        ((1, 2, 4, 5), 2, "diamond"),  # figure 3.4 (a): 3 failed among 1, 2, 4, 5
        ((1, 2, 3, 5), 2, "diamond"),  # figure 3.4 (b): 4 failed, the leader changes
        ((2, 3, 4, 5), 3, "diamond"),  # figure 4.21: 6 and 1 lost
        ((1, 2, 4, 5, 6), 4, "wedge"),  # figure 4.22: leader 3 stopped
        ((2, 3, 4), 3, "wedge"),  # map 2: 1, 5, 6 lost
        ((3, 4), 3, "column"),  # map 3: 1, 2, 5, 6 lost
    ],
)
def test_examples_of_the_thesis(ids, leader, shape):
    team = formation(ids)
    assert (team.leader, team.shape.value) == (leader, shape)


@pytest.mark.parametrize("ids", [c for n in range(1, 7) for c in itertools.combinations(range(1, 7), n)])
def test_all_63_subsets_have_the_median_leader_the_shape_of_their_size_and_sided_slots(ids):
    team = formation(ids)
    assert team.leader == sorted(ids)[(len(ids) - 1) // 2]
    assert team.shape.value == SHAPES[len(ids)]
    places = slots(ids)
    assert set(places) == set(ids) - {team.leader}
    assert len(set(places.values())) == len(places)
    for robot, (x, y) in places.items():
        assert x < 0.0, "the leader is at the front"
        assert math.hypot(x, y) <= 8.0 + 1e-9, "within 8 m of the leader"
        if robot < team.leader:
            assert y < 0.0, "lower ids go to the right"
        elif abs(y) > 1e-9:
            assert y > 0.0, "higher ids go to the left"
    for (ax, ay), (bx, by) in itertools.combinations([(0.0, 0.0), *places.values()], 2):
        assert math.hypot(ax - bx, ay - by) >= S - 1e-9


def test_hexagon_slots():
    expected = {
        1: (-1.5 * S, -WIDE), 2: (-0.5 * S, -WIDE),
        4: (-0.5 * S, WIDE), 5: (-1.5 * S, WIDE), 6: (-2 * S, 0.0),
    }  # fmt: skip
    assert same(slots(range(1, 7)), expected)


def test_wedge_after_5_failed_has_2_and_1_on_the_right_and_4_and_6_on_the_left():
    expected = {2: (-HALF, -HALF), 1: (-2 * HALF, -2 * HALF), 4: (-HALF, HALF), 6: (-2 * HALF, 2 * HALF)}
    assert same(slots((1, 2, 3, 4, 6)), expected)


def test_diamond_slots():
    assert same(slots((1, 2, 4, 5)), {1: (-HALF, -HALF), 4: (-HALF, HALF), 5: (-2 * HALF, 0.0)})


def test_narrow_column_alternates_right_and_left_nearest_first():
    expected = {2: (-S, 0.0), 4: (-2 * S, 0.0), 1: (-3 * S, 0.0), 5: (-4 * S, 0.0), 6: (-5 * S, 0.0)}
    assert same(slots(range(1, 7), narrow=True), expected)


@pytest.mark.parametrize("size", range(1, 101))
def test_any_size_has_one_slot_for_each_follower(size):
    team = formation(range(1, size + 1))
    assert len(team.slots) == size - 1
    assert len({(slot.x, slot.y) for slot in team.slots}) == size - 1
    assert team.shape is shape_of(size)
    if size > 6:
        assert team.shape is (Shape.WEDGE if size % 2 else Shape.HEXAGON)


def test_order_of_ids_does_not_matter():
    assert formation((5, 1, 4, 2)) == formation((1, 2, 4, 5))


def test_spacing_scales_all_slots():
    near, far = formation(range(1, 7), spacing=2.0), formation(range(1, 7), spacing=4.0)
    for small, large in zip(near.slots, far.slots, strict=True):
        assert (2 * small.x, 2 * small.y) == pytest.approx((large.x, large.y))


def test_width_of_a_hexagon_is_that_of_its_sides():
    assert width(formation(range(1, 7))) == pytest.approx(2 * WIDE)
    assert width(formation(range(1, 7), narrow=True)) == 0.0


def test_nobody_and_twins_are_refused():
    with pytest.raises(ValueError, match="nobody"):
        median_leader(())
    with pytest.raises(ValueError, match="twice"):
        formation((1, 2, 2))
