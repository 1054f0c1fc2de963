"""What a team is doing at a moment, in a few sentences, for somebody who has just begun to look."""

from collections.abc import Iterator, Mapping

from onehop.contracts.messages import Action, Truth
from onehop.contracts.team import Mode

MOST_SENTENCES = 5
"""Sentences that are read at a glance."""

MOST_NAMED = 12
"""Robots of one sentence that are named; of more it is told how many they are."""

_DOING = {
    Mode.LOST_LEADER: (
        "has not heard its leader for too long",
        "have not heard their leader for too long",
    ),
    Mode.JOINING: ("asks a team to take it in", "ask a team to take them in"),
    Mode.ALONE: ("is alone", "are alone"),
    Mode.BORDER: ("drives around an obstacle", "drive around an obstacle"),
    Mode.GIVING_WAY: ("gives way", "give way"),
    Mode.STOPPED: ("has stopped", "have stopped"),
}
"""Modes that are told, for one robot and for several."""


def now_in_words(truth: Truth, actions: Mapping[int, Action]) -> list[str]:
    """The sentences, what matters most first."""
    return [
        *_leaders(actions),
        *_weak_links(actions),
        *_modes(actions),
        *_faults(truth),
    ][:MOST_SENTENCES]


def _leaders(actions: Mapping[int, Action]) -> Iterator[str]:
    for robot, action in sorted(actions.items()):
        status = action.status
        if status is None or status.leader != robot or status.mode is Mode.ALONE:
            continue
        others = [one for one in status.members if one != robot]
        where = f"{status.error:.0f} m from the goal"
        if not others:
            yield f"Robot {robot} drives by itself, {where}."
        elif status.mode is Mode.SETUP:
            yield f"Robot {robot} gathers {_robots(others)} in a {status.shape}, {where}."
        else:
            yield f"Robot {robot} leads {_robots(others)} in a {status.shape}, {where}."


def _weak_links(actions: Mapping[int, Action]) -> Iterator[str]:
    weak, silent = [], []
    for robot, action in sorted(actions.items()):
        status = action.status
        if status is None or status.leader == robot or status.mode is Mode.SETUP:
            continue
        if status.throughput_bps <= 0:
            silent.append(robot)
        elif status.throughput_bps < status.threshold_bps:
            weak.append(robot)
    if silent:
        its = "its leader's last command: it hurries" if len(silent) == 1 else (
            "their leader's last command: they hurry"
        )  # fmt: skip
        yield f"{_robots(silent, True)} missed {its}."
    if weak:
        its = "hurries: its link is" if len(weak) == 1 else "hurry: their links are"
        yield f"{_robots(weak, True)} {its} below the threshold."


def _modes(actions: Mapping[int, Action]) -> Iterator[str]:
    for mode, (one, several) in _DOING.items():
        robots = [
            robot
            for robot, action in sorted(actions.items())
            if action.status is not None and action.status.mode is mode
        ]
        if robots:
            yield f"{_robots(robots, True)} {one if len(robots) == 1 else several}."


def _faults(truth: Truth) -> Iterator[str]:
    held = [one.robot for one in truth.present if one.held]
    for robots, what in (
        (held, "held: it cannot move"),
        (truth.stopped, "stopped: its process computes nothing"),
        (truth.blind, "blind: its laser sees nothing"),
    ):
        if robots:
            is_so = what if len(robots) == 1 else what.partition(":")[0]
            yield f"{_robots(robots, True)} {'is' if len(robots) == 1 else 'are'} {is_so}."


def _robots(robots: list[int] | tuple[int, ...], begins: bool = False) -> str:
    if len(robots) > MOST_NAMED:
        return f"{len(robots)} robots"
    word = "Robot" if begins else "robot"
    return f"{word}{'s' if len(robots) > 1 else ''} {' '.join(map(str, robots))}"
