"""A team drives the same with any laser and any control period that a scenario may ask for."""

import itertools
from pathlib import Path

import pytest

from onehop.contracts.messages import Action
from onehop.drivers import inline
from onehop.scenario import scenario_file
from world_server.core.world import World

SCENE = """
name = "a passage, and a block behind it"
[map]
width = 50
height = 30
obstacles = [
    [[20, 0], [22, 0], [22, 13], [20, 13]],
    [[20, 16.5], [22, 16.5], [22, 30], [20, 30]],
    [[30, 10], [36, 10], [36, 20], [30, 20]],
]
[start]
x = 8
y = 8
[goal]
x = 44
y = 15
[team]
size = 4
[clock]
limit_s = 200
"""
"""35 m to go: through 3.5 m between two walls, then around a block of 6 m by 10 m."""

LONGEST_S = 80.0
"""At 181 beams and 50 ms it takes 50 to 60 s, depending on the seed; the slowest of all settings here,
which waits for its column in the passage, takes 72 s."""


TURNS_TO_AND_FRO = pytest.mark.xfail(
    strict=True,
    reason="robot 1 turns to and fro at the block's corner: docs/team-figures.md, last section",
)


def settings():
    """Seeds, beams and periods, with the one in which a follower is left behind."""
    for seed, beams, period_ms in itertools.product([1, 5, 7], [90, 181, 361, 721], [20, 50, 100]):
        fails = (seed, beams, period_ms) == (5, 721, 50)
        yield pytest.param(seed, beams, period_ms, marks=[TURNS_TO_AND_FRO] if fails else [])


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "beams", "period_ms"), list(settings()))
def test_a_team_passes_a_narrow_passage_and_a_block(tmp_path: Path, seed, beams, period_ms):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    shapes = []

    def watch(world: World, actions: dict[int, Action]) -> None:
        del world
        shapes.append(actions[2].status.shape.value)

    changes = (f"robot.laser_beams={beams}", f"clock.period_ms={period_ms}", f"seed={seed}")
    outcome = inline.run(scenario_file.load(path, changes), None, watch)
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.arrived == (1, 2, 3, 4)
    assert outcome.collisions == 0
    assert outcome.sim_s < LONGEST_S
    assert "column" in shapes, "the passage was seen"
    assert shapes[-1] == "diamond"
