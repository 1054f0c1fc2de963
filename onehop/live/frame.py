"""One moment of a mission as the page shows it: the same from a log and from a mission that runs.

A frame is made of the messages of its tick, of the messages that were lost a moment before, and of what
the story knows of those who left. Plain values, as JSON has them.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from onehop.analysis.log import Log
from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.contracts.geometry import to_map
from onehop.contracts.messages import (
    Action,
    Observation,
    Presence,
    RadioRecord,
    Truth,
)
from onehop.contracts.printable import printable
from onehop.contracts.program_section import BUILT_IN
from onehop.contracts.team import Status
from onehop.live.now import now_in_words
from onehop.live.story import Lost, Story, lost_in
from onehop.wire.log_reader import forged
from onehop.wire.logged import TickMessage, decoded
from onehop.wire.selection import one_of
from robot_agent.core.team.formation import formation, shape_of

LOST_TICKS = 40
"""Lost messages are shown that were settled so many ticks before, at most: two seconds."""

MOST_LOST = 200
"""Lost messages that are shown at once."""

MOST_VALUES = 6
"""Values of a robot's program that find room on its card."""


class Moment:
    """The messages of one tick of a log. truth: None where the log has none of that tick."""

    def __init__(self, log: Log, story: Story, tick: int, since: int, robot: int) -> None:
        """since: tick of the frame that was shown before. robot: whose scan is wanted, 0 for nobody."""
        self.truth: Truth | None = None
        self.actions: dict[int, Action] = {}
        self.scan: Observation | None = None
        self.lost: Lost = []
        first = max(since + 1, tick - LOST_TICKS, 0) if since < tick else tick
        recent = story.recently_lost(first, tick)
        eye = topics.obs(robot)
        try:
            if recent is None:
                for message in log.file.wire.select(one_of(topics.RADIO_RECORD), first, tick):
                    self._take_lost(decoded(message))
            else:
                self.lost = recent
            for message in log.file.wire.select(one_of(topics.TRUTH, "out/", eye), tick, tick):
                self._take(message.key, decoded(message))
        except DecodeError as error:
            raise forged(log.path, error) from None

    def _take_lost(self, record: object) -> None:
        if isinstance(record, RadioRecord):
            self.lost += lost_in(record)

    def _take(self, key: str, value: TickMessage) -> None:
        if isinstance(value, Truth):
            self.truth = value
        elif isinstance(value, Action):
            self.actions[int(key.partition("/")[2])] = value
        elif isinstance(value, Observation):
            self.scan = value


def frame(moment: Moment, story: Story) -> dict[str, Any]:
    """The page's picture of a moment that has a truth."""
    truth = moment.truth
    assert truth is not None
    present = {one.robot for one in truth.present}
    time_s = truth.time_ns / 1e9
    return {
        "tick": truth.tick,
        "time_s": round(time_s, 3),
        "robots": [_robot(one, truth, moment.actions.get(one.robot)) for one in truth.present],
        "gone": [
            {"id": one.robot, "x": one.x, "y": one.y, "why": printable(one.why, 80)}
            for one in story.gone_at(truth.tick, present)
        ],
        "routes": list(_routes(moment.actions, present, story, truth.tick)),
        "lost": [lost for lost in moment.lost if present.issuperset(lost[:2])][-MOST_LOST:],
        "cuts": [[list(cut.side_a), list(cut.side_b), cut.one_way] for cut in truth.cuts],
        "jams": [[jam.x, jam.y, jam.radius] for jam in truth.jams],
        "slots": list(_slots(truth, moment.actions, story)),
        "now": now_in_words(truth, moment.actions),
    }


def _robot(one: Presence, truth: Truth, action: Action | None) -> dict[str, Any]:
    robot = one.robot
    state = [
        name
        for name, is_so in (
            ("held", one.held),
            ("stopped", robot in truth.stopped),
            ("blind", robot in truth.blind),
            ("slow", any(robot == slow.robot for slow in truth.slow)),
            ("corrupted", any(robot in corrupt.robots for corrupt in truth.corruptions)),
        )
        if is_so
    ]
    shown: dict[str, Any] = {
        "id": robot,
        "x": round(one.pose.x, 3),
        "y": round(one.pose.y, 3),
        "heading": round(one.pose.heading, 3),
        "speed": round(one.twist.v, 2),
        "incarnation": one.incarnation,
        "state": state,
    }
    if action is not None:
        if action.status is not None:
            shown["status"] = _status(action.status)
        values = list(action.values.items())[:MOST_VALUES]
        shown["values"] = {printable(name, 40): _finite(value) for name, value in values}
    return shown


def _status(status: Status) -> dict[str, Any]:
    return {
        "mode": status.mode.value,
        "epoch": status.epoch,
        "leader": status.leader,
        "members": list(status.members),
        "shape": status.shape.value,
        "throughput": _finite(status.throughput_bps),
        "threshold": _finite(status.threshold_bps),
        "k_rho": _finite(status.k_rho),
        "error": _finite(status.error),
        "target": [_finite(status.target_x), _finite(status.target_y)],
    }


def _finite(value: float) -> float | None:
    """A number that JSON has."""
    return round(value, 3) if math.isfinite(value) else None


def _routes(
    actions: Mapping[int, Action], present: set[int], story: Story, tick: int
) -> Iterator[list[int]]:
    """The way from its leader to each follower: through others if its messages came so last."""
    for robot, action in sorted(actions.items()):
        status = action.status
        if status is None or status.leader == robot or status.leader not in present:
            continue
        path = story.route_at(robot, tick) if robot in story.routes else ()
        if path[:1] != (status.leader,) or not present.issuperset(path):
            path = (status.leader, robot)
        yield list(path)


def _slots(truth: Truth, actions: Mapping[int, Action], story: Story) -> Iterator[list[float]]:
    """Where each follower of a leader belongs. In a column the slots lie on the leader's trail: none."""
    places = {one.robot: one.pose for one in truth.present}
    for robot, action in sorted(actions.items()):
        status = action.status
        if status is None or status.leader != robot or robot not in places:
            continue
        if story.scenario.program_of(robot)[0] != BUILT_IN or robot not in status.members:
            continue
        if status.shape is not shape_of(len(set(status.members))):
            continue
        made = formation(set(status.members), spacing=story.scenario.team.spacing)
        for slot in made.slots if made.leader == robot else ():
            x, y = to_map(places[robot], slot.x, slot.y)
            yield [slot.robot, robot, round(x, 2), round(y, 2)]


def scan(seen: Observation) -> dict[str, Any]:
    """What one robot's laser sees, [cm]; -1 where nothing is in range."""
    ranges = np.where(np.isfinite(seen.scan), np.rint(100.0 * seen.scan), -1.0)
    pose = seen.pose
    return {"x": pose.x, "y": pose.y, "heading": pose.heading, "ranges": ranges.astype(int).tolist()}
