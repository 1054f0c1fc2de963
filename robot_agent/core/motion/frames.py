"""Many points in the frame of one pose: one sine and one cosine for all of them."""

from collections.abc import Callable

from onehop.contracts import elementary
from onehop.contracts.geometry import Pose
from robot_agent.core.motion.trail import Point


def frame_of(pose: Pose) -> Callable[[Point], Point]:
    """What turns a place in the map frame into one in the frame of `pose` [m]; see geometry.to_local."""
    c, s = elementary.cos(pose.heading), elementary.sin(pose.heading)
    x, y = pose.x, pose.y

    def local(point: Point) -> Point:
        dx, dy = point[0] - x, point[1] - y
        return c * dx + s * dy, c * dy - s * dx

    return local
