"""Whole missions over the real world and radio: election, recovery and arrival (issue 4, must hold)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import groupby
from operator import itemgetter
from pathlib import Path

import pytest

from onehop.contracts.messages import Action, Carriage, Outcome
from onehop.contracts.team import Mode, Shape, Status
from onehop.drivers import inline
from onehop.scenario import scenario_file
from world_server.core.world import World

SCENARIOS = Path(__file__).parents[2] / "scenarios"
NEXT_PERIOD = 2.0
OPEN_FIELD = """
name = "open field"
seed = 5
[map]
width = 120
height = 60
[start]
x = 15
y = 30
[goal]
x = 100
y = 30
"""


@dataclass
class Diary:
    """What the robots said of themselves, tick by tick."""

    seconds: list[float] = field(default_factory=list)
    statuses: list[dict[int, Status]] = field(default_factory=list)

    def watch(self, world: World, actions: Mapping[int, Action], _: Carriage) -> None:
        """Called by the driver after every tick."""
        self.seconds.append(world.time_ns / 1e9)
        self.statuses.append({i: action.status for i, action in actions.items()})

    def at(self, seconds: float) -> dict[int, Status]:
        """Statuses at the first tick at or after a time."""
        return next(s for t, s in zip(self.seconds, self.statuses, strict=True) if t >= seconds)

    def leaders(self, seconds: float) -> list[int]:
        """Who acts as leader at a time."""
        return [i for i, status in self.at(seconds).items() if status.leader == i]


def fault(kind: str, at: float, *robots: int, **keys: object) -> str:
    """One fault as an inline table."""
    more = "".join(f", {key} = {value}" for key, value in keys.items())
    return f'{{kind = "{kind}", at_s = {at}, robots = {list(robots)}{more}}}'


def mission(path: Path, *settings: str, faults: tuple[str, ...] = ()) -> tuple[Outcome, Diary]:
    """Run a scenario in this process."""
    every = (*settings, f"faults=[{', '.join(faults)}]") if faults else settings
    diary = Diary()
    return inline.run(scenario_file.load(path, every), None, diary.watch), diary


@pytest.fixture
def open_field(tmp_path: Path) -> Path:
    """A field without obstacles, 85 m to go."""
    path = tmp_path / "field.toml"
    path.write_text(OPEN_FIELD)
    return path


def test_everyone_arrives_and_nobody_touches_anything(open_field):
    outcome, diary = mission(open_field)
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.arrived == (1, 2, 3, 4, 5, 6)
    assert outcome.collisions == 0
    assert {status.mode for status in diary.statuses[-1].values()} == {Mode.STOPPED}


def test_the_same_mission_twice_is_the_same(open_field):
    first, second = mission(open_field), mission(open_field)
    assert first[0] == second[0]
    assert first[1].statuses == second[1].statuses


def test_leader_after_leader_dies_and_the_rest_re_forms_and_arrives(open_field):
    faults = [fault("kill", 20, 3), fault("kill", 35, 4), fault("kill", 50, 2), fault("kill", 65, 5)]
    outcome, diary = mission(open_field, faults=tuple(faults))
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.arrived == (1, 6)
    for died, leader in ((20, 4), (35, 2), (50, 5), (65, 1)):
        assert diary.leaders(died + 5.0 + 2 * NEXT_PERIOD) == [leader]
    assert outcome.collisions == 0


def test_a_leader_that_is_held_while_it_turns_to_the_goal_still_says_so(open_field):
    """A silent one was given up, and the team had two leaders from then on."""
    held = fault("hold", 0.1, 3, duration_s=15)
    outcome, diary = mission(open_field, "clock.limit_s=25.0", faults=(held,))
    assert outcome.outcome == "failed", "the limit"
    for second in range(1, 25):
        assert diary.leaders(second) == [3]


@pytest.mark.parametrize("profile", ["team", "thesis"])
def test_a_leader_cut_off_for_good_stands_on_the_goal_and_the_others_arrive_beside_it(
    open_field, profile
):
    """It goes on alone (thesis 4.3) and gets there first; its place is never free again."""
    outcome, _ = mission(
        open_field, f"team.profile='{profile}'", "clock.limit_s=300.0", faults=(fault("cut", 20, 3),)
    )
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.arrived == (1, 2, 3, 4, 5, 6)
    assert outcome.sim_s < 200.0
    assert outcome.collisions == 0


def test_two_lost_followers_leave_a_diamond(open_field):
    """Thesis figure 4.21."""
    outcome, diary = mission(open_field, faults=(fault("kill", 20, 6, 1),))
    assert {status.shape.value for status in diary.at(35.0).values()} == {"diamond"}
    assert outcome.arrived == (2, 3, 4, 5)


def test_a_cut_makes_two_teams_and_healing_one_again_within_four_periods(open_field):
    cut = fault("cut", 20, 1, 2, 3, others=[4, 5, 6], duration_s=25)
    outcome, diary = mission(open_field, faults=(cut,))
    assert diary.leaders(44.0) == [2, 5]
    assert {status.members for status in diary.at(44.0).values()} == {(1, 2, 3), (4, 5, 6)}
    healed = diary.at(45.0 + 4 * NEXT_PERIOD)
    assert {status.members for status in healed.values()} == {(1, 2, 3, 4, 5, 6)}
    assert diary.leaders(45.0 + 4 * NEXT_PERIOD) == [3]
    assert outcome.outcome == "arrived"


def test_a_killed_robot_that_restarts_is_in_the_team_at_the_goal(open_field):
    faults = (fault("kill", 20, 5), fault("restart", 30, 5))
    outcome, diary = mission(open_field, faults=faults)
    assert 5 not in diary.at(29.0)
    assert outcome.arrived == (1, 2, 3, 4, 5, 6)


def test_profile_thesis_leader_3_stopped_makes_4_lead_a_wedge(open_field):
    """Thesis figure 4.22."""
    settings = ('team.profile="thesis"', "team.leader_timeout=6")
    outcome, diary = mission(open_field, *settings, faults=(fault("kill", 20, 3),))
    assert diary.leaders(30.0) == [4]
    assert {status.shape.value for status in diary.at(30.0).values()} == {"wedge"}
    assert outcome.arrived == (1, 2, 4, 5, 6)


def test_epochs_never_go_back_under_faults(open_field):
    cut = fault("cut", 20, 1, 2, 3, others=[4, 5, 6], duration_s=25)
    _, diary = mission(open_field, faults=(cut, fault("hold", 30, 6, duration_s=10)))
    for before, after in zip(diary.statuses, diary.statuses[1:], strict=False):
        assert all(after[i].epoch >= before[i].epoch for i in after if i in before)


def test_a_leader_slows_down_for_a_straggler_if_the_scenario_says_so(open_field):
    held = fault("hold", 30, 6, duration_s=10)

    def speed(share):
        """The leader's mean speed while robot 6 stands still, once its reports say so [m/s]."""
        _, diary = mission(open_field, f"team.straggler_speed={share}", faults=(held,))
        return (diary.at(35.0)[3].error - diary.at(39.0)[3].error) / 4.0

    assert speed(1.0) == pytest.approx(1.0, abs=0.05)
    assert speed(0.3) == pytest.approx(0.3, abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "seed"),
    [(3, 15), (3, 16), (3, 11), (2, 8)],
    ids=["a pocket", "a passage", "a corner with a follower behind it", "pinned beside a wall"],
)
def test_a_leader_that_meets_its_own_team_gets_everyone_out(number, seed):
    outcome, _ = mission(SCENARIOS / f"map{number}.toml", f"seed={seed}")
    assert outcome.arrived == (1, 2, 3, 4, 5, 6), outcome.reason
    assert outcome.collisions == 0


@pytest.mark.slow
@pytest.mark.parametrize("number", [1, 2, 3])
def test_a_study_map_is_crossed_without_a_contact(number):
    outcome, _ = mission(SCENARIOS / f"map{number}.toml", "seed=4")
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.collisions == 0


MAP3_PASSAGES = (
    ((37.0, 28.0), (40.5, 32.0)),
    ((53.0, 55.0), (55.0, 58.5)),
    ((88.0, 66.0), (91.5, 69.0)),
)
"""Two opposite corners of each, 3.5 m wide [m]."""


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5, 6, 7, 8])
def test_passages_are_crossed_in_column_and_the_shape_stands_again_behind_them(seed):
    """Robot 3 leads a column through each of map3's: from before it, or within its first half second, as
    long as a passage must be in view to count. Before the next one and at the goal every follower is in
    its slot of the hexagon again.
    """
    seen: list[tuple[Shape, int | None, float]] = []

    def watch(world: World, actions: Mapping[int, Action], _: Carriage) -> None:
        pose = next(one.pose for one in world.truth().present if one.robot == 3)
        inside = [
            number
            for number, ((x0, y0), (x1, y1)) in enumerate(MAP3_PASSAGES)
            if x0 <= pose.x <= x1 and y0 <= pose.y <= y1
        ]
        worst = max(action.status.error for i, action in actions.items() if i != 3)
        seen.append((actions[3].status.shape, inside[0] if inside else None, worst))

    scenario = scenario_file.load(SCENARIOS / "map3.toml", (f"seed={seed}",))
    outcome = inline.run(scenario, None, watch)
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.arrived == (1, 2, 3, 4, 5, 6)
    assert outcome.collisions == 0
    crossed = [(passage, shape) for shape, passage, _ in seen if passage is not None]
    assert [passage for passage, _ in groupby(passage for passage, _ in crossed)] == [0, 1, 2]
    assert sum(shape is not Shape.COLUMN for _, shape in crossed) <= 10
    shapes = [
        (shape, min(worst for _, _, worst in run)) for shape, run in groupby(seen, key=itemgetter(0))
    ]
    assert [shape for shape, _ in shapes] == [Shape.HEXAGON, Shape.COLUMN] * 3 + [Shape.HEXAGON]
    assert all(best < 0.5 for shape, best in shapes if shape is Shape.HEXAGON), shapes


@pytest.mark.slow
@pytest.mark.parametrize("number", [1, 2, 3])
def test_leaders_die_on_a_study_map_and_the_last_two_arrive(number):
    faults = [fault("kill", 40, 3), fault("kill", 60, 4), fault("kill", 80, 2), fault("kill", 100, 5)]
    outcome, diary = mission(SCENARIOS / f"map{number}.toml", "seed=4", faults=tuple(faults))
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.arrived == (1, 6)
    for died, leader in ((40, 4), (60, 2), (80, 5), (100, 1)):
        assert diary.leaders(died + 5.0 + 2 * NEXT_PERIOD) == [leader]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "spacing"), [(24, 1.0), pytest.param(50, 0.8, marks=pytest.mark.campaign)]
)
def test_large_teams_arrive(open_field, size, spacing):
    settings = (f"team.size={size}", f"team.spacing={spacing}", "team.narrow_spacing=0.6")
    outcome, _ = mission(open_field, *settings)
    assert outcome.outcome == "arrived", outcome.reason
    assert len(outcome.arrived) == size
    assert outcome.collisions == 0
