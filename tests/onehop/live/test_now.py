"""What a team is doing, in sentences that somebody reads at a glance."""

from dataclasses import dataclass

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Action, Presence, Truth
from onehop.contracts.team import Mode, Shape, Status
from onehop.live.now import MOST_NAMED, MOST_SENTENCES, now_in_words


@dataclass
class Team:
    """Robots 1 to `size`; the leader is robot 1."""

    size: int = 3

    def said(self, modes: dict[int, Mode], throughputs: dict[int, float]) -> list[str]:
        robots = range(1, self.size + 1)
        actions = {robot: self._action(robot, modes, throughputs) for robot in robots}
        return now_in_words(self.truth(), actions)

    def truth(self, held: tuple[int, ...] = (), stopped: tuple[int, ...] = ()) -> Truth:
        at = Pose(0.0, 0.0, 0.0), Twist(0.0, 0.0)
        present = tuple(Presence(i, 0, *at, i in held) for i in range(1, self.size + 1))
        return Truth(5, 250, present, (), (), (), (), (), stopped=stopped)

    def _action(self, robot: int, modes: dict[int, Mode], throughputs: dict[int, float]) -> Action:
        mode = modes.get(robot, Mode.LEADING if robot == 1 else Mode.FOLLOWING)
        members = tuple(range(1, self.size + 1))
        bps = throughputs.get(robot, -1.0 if robot == 1 else 800e3)
        status = Status(mode, 0, 1, members, Shape.WEDGE, bps, 500e3, 1.0, 12.4, 0.0, 0.0)
        return Action(5, 0, Twist(0.0, 0.0), (), 0.0, 0.0, status, ())


def test_a_team_on_its_way_is_one_sentence() -> None:
    assert Team().said({}, {}) == ["Robot 1 leads robots 2 3 in a wedge, 12 m from the goal."]


def test_links_that_are_weak_or_silent_are_told_apart() -> None:
    said = Team().said({}, {2: 0.0, 3: 300e3})
    assert said[1:] == [
        "Robot 2 missed its leader's last command: it hurries.",
        "Robot 3 hurries: its link is below the threshold.",
    ]
    assert Team().said({}, {2: 0.0, 3: 0.0})[1] == (
        "Robots 2 3 missed their leader's last command: they hurry."
    )


def test_modes_that_are_no_following_are_told() -> None:
    said = Team().said({2: Mode.LOST_LEADER, 3: Mode.BORDER}, {})
    assert said[1:] == [
        "Robot 2 has not heard its leader for too long.",
        "Robot 3 drives around an obstacle.",
    ]


def test_faults_in_force_are_told() -> None:
    said = now_in_words(Team().truth(held=(2,), stopped=(1, 3)), {})
    assert said == ["Robot 2 is held: it cannot move.", "Robots 1 3 are stopped."]


def test_a_large_team_is_counted_and_no_more_is_told_than_is_read() -> None:
    size = MOST_NAMED + 2
    modes = {2: Mode.JOINING, 3: Mode.BORDER, 4: Mode.GIVING_WAY, 5: Mode.STOPPED, 6: Mode.ALONE}
    said = Team(size).said(modes, {7: 0.0})
    assert said[0].startswith(f"Robot 1 leads {size - 1} robots in a wedge")
    assert len(said) == MOST_SENTENCES
