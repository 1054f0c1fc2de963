"""Messages that no mission can have recorded: numbers that are none, robots that are not in the team.

World and router let none of them pass (docs/limits.md), so a log that holds one was altered. They are
told as flaws and left out, so that every check can rely on what it gets.
"""

import math

from onehop.contracts.hardware import Measured, Taken
from onehop.contracts.messages import Action, Inbox, Observation, Truth
from onehop.contracts.ranges import out_of_range
from onehop.wire.logged import TickMessage

MOST = 1e9
"""Beyond any metre, decibel or number of restarts that a mission has."""


def impossible(value: TickMessage, team: frozenset[int]) -> str | None:
    """Why a message cannot have been recorded; None if it can."""
    if isinstance(value, Action):
        return _wrong_action(value, team)
    if isinstance(value, Observation):
        return None if _are_sound(value.pose.x, value.pose.y, value.pose.heading) else "is nowhere"
    if isinstance(value, Inbox) and not all(one.robot in team for one in value.neighbours):
        return "has neighbours who are not in the team"
    if isinstance(value, Taken):
        return _wrong_measurement(value.measured)
    return _wrong_truth(value, team) if isinstance(value, Truth) else None


def _wrong_action(action: Action, team: frozenset[int]) -> str | None:
    if action.status is not None:
        members = action.status.members
        if not members or not team.issuperset(members):
            return "has members who are not in the team"
    return None if _are_sound(action.twist.v, action.twist.w) else "commands what is no motion"


def _wrong_measurement(measured: Measured) -> str | None:
    pose, twist = measured.pose, measured.twist
    if not _are_sound(pose.x, pose.y, pose.heading, twist.v, twist.w):
        return "has a base that is nowhere"
    return None if all(measured.scan >= 0.0) else "has a scan of ranges that are none"


def _wrong_truth(truth: Truth, team: frozenset[int]) -> str | None:
    for one in truth.present:
        if one.robot not in team:
            return f"has robot {one.robot}, which is not in the team"
        if not 0 <= one.incarnation <= MOST:
            return f"has robot {one.robot} for the {one.incarnation}th time"
        if not _are_sound(one.pose.x, one.pose.y, one.pose.heading):
            return f"has robot {one.robot} nowhere"
    for jam in truth.jams:
        if not _are_sound(jam.x, jam.y, jam.radius) or not abs(jam.noise_dbm) <= 1000.0:
            return "has a jam of no place or power"
    for fault in truth.faults:
        for problem in (*fault.problems(), *out_of_range(fault)):
            return f"has a fault that cannot be: {problem.key}, {problem.what}"
    return None


def _are_sound(*numbers: float) -> bool:
    return all(math.isfinite(number) and abs(number) <= MOST for number in numbers)
