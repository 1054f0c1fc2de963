"""What left the field of view a moment ago."""

import math

from onehop.contracts.geometry import Pose
from robot_agent.core.planning.recent_obstacles import RecentObstacles
from tests.agent.planning.fields import box, field, look


def test_recent_obstacles_are_bounded_and_are_those_out_of_view() -> None:
    ground = field(box(16, 6, 18, 12), box(14, 14, 15, 20), box(20, 13, 24, 15), size=30.0)
    view = look(ground, 15.0, 9.0, 0.0)
    recent = RecentObstacles(3.0, capacity=32)
    recent.keep(view)
    assert len(recent.points) == 32
    turned = Pose(15.0, 9.0, math.pi)
    assert len(recent.hidden(turned, math.pi / 2)) > 0
    assert len(recent.hidden(view.pose, math.pi / 2)) == 0
