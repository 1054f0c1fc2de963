"""A robot that says nothing goes on for a moment."""

from pathlib import Path

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Action, Note, Presence, Truth
from tests.onehop.scenes import field
from world_server.core.command_hold import CommandHold


def truth(tick: int, incarnation: int = 0, stopped: tuple[int, ...] = ()) -> Truth:
    present = (Presence(1, incarnation, Pose(0.0, 0.0, 0.0), Twist(0.0, 0.0), False),)
    return Truth(tick, tick * 50_000_000, present, (), (), (), (), (), stopped=stopped)


SAID = Action(3, 0, Twist(0.7, 0.1), (), 0.7, 9.0, None, (Note("turned", {}),), {"x": 1.0})


def hold(folder: Path, *settings: str) -> CommandHold:
    return CommandHold(field(folder, 'clock.mode="realtime"', "clock.hold_s=0.2", *settings).scenario)


def test_its_last_command_holds_for_as_long_as_the_scenario_says_and_no_longer(tmp_path: Path) -> None:
    rule = hold(tmp_path)
    assert rule.filled(truth(2), {}) == {}
    assert rule.filled(truth(3), {1: SAID}) == {1: SAID}
    held = [rule.filled(truth(tick), {}) for tick in range(4, 9)]
    assert [1 in one for one in held] == [True, True, True, True, False]
    assert (held[0][1].twist, held[0][1].notes, held[0][1].values) == (SAID.twist, (), {})
    assert [one[1].tick for one in held[:4]] == [4, 5, 6, 7]


def test_a_command_of_another_process_does_not_hold(tmp_path: Path) -> None:
    rule = hold(tmp_path)
    rule.filled(truth(3), {1: SAID})
    assert rule.filled(truth(4, incarnation=1), {}) == {}


def test_a_robot_that_is_stopped_does_not_go_on(tmp_path: Path) -> None:
    rule = hold(tmp_path)
    rule.filled(truth(3), {1: SAID})
    assert rule.filled(truth(4, stopped=(1,)), {}) == {}


def test_in_lock_step_nothing_is_filled_in(tmp_path: Path) -> None:
    rule = hold(tmp_path, 'clock.mode="lockstep"')
    rule.filled(truth(3), {1: SAID})
    assert rule.filled(truth(4), {}) == {}
