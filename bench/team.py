"""What one step of a robot costs, without its planner: JSON on stdout. Run from the repository's root.

    python bench/team.py

Bounds: a follower 40 us, a leader 60 us on average, so that six robots, world and radio together can do
2000 ticks a second in one process. Best of many short runs, because the machine is shared.
"""

import json
import math
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from onehop.contracts.arrays import Ranges
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Percept
from onehop.contracts.sections import TeamSection
from tests.agent.team.team_net import NOTHING_NEAR, PERIOD_MS, TeamNet

ROUNDS, STEPS = 300, 20


def step_us(net: TeamNet, robot: int, scan: Ranges, away: float) -> float:
    """Least mean time of STEPS steps of a robot that is `away` from its slot [us]."""
    member = net.members[robot]
    pose = Pose(member.pose.x - away, member.pose.y, member.pose.heading)
    percept = Percept(net.tick, net.tick * PERIOD_MS * 1_000_000, pose, Twist(0.0, 0.0), scan, ())
    best = math.inf
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for _ in range(STEPS):
            member.robot.step(percept)
        best = min(best, (time.perf_counter() - start) / STEPS)
    return round(best * 1e6, 1)


def main() -> None:
    """Print the table."""
    net = TeamNet(TeamSection())
    net.run(30.0)
    beside, blocked = NOTHING_NEAR.copy(), NOTHING_NEAR.copy()
    beside[:40] = 2.0
    blocked[70:110] = np.float32(1.0)
    figures = {
        "follower_open_us": step_us(net, 1, NOTHING_NEAR, 3.0),
        "follower_beside_a_wall_us": step_us(net, 2, beside, 3.0),
        "follower_border_us": step_us(net, 4, blocked, 3.0),
        "leader_without_planner_us": step_us(net, 3, NOTHING_NEAR, 0.0),
        "bounds_us": {"follower": 40, "leader": 60},
    }
    print(json.dumps(figures, indent=2))


if __name__ == "__main__":
    main()
