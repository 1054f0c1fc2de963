"""What a follower holds of its leader."""

from onehop.contracts.geometry import Pose
from robot_agent.core.team.team_messages import MissionPhase


class LeaderView:
    """What a follower knows of its leader: the last command, and the throughput of the link."""

    __slots__ = ("heard_ns", "lane", "narrow", "next_ns", "phase", "pose", "throughput_bps", "trail")

    def __init__(self, now_ns: int) -> None:
        self.heard_ns = now_ns
        self.next_ns = now_ns
        self.phase = MissionPhase.SETUP
        self.narrow = False
        self.pose: Pose | None = None
        self.trail: tuple[tuple[float, float], ...] = ()
        self.lane: tuple[tuple[float, float], ...] = ()
        self.throughput_bps = 0.0
