"""A package with a plugin of each kind, as it lies where packages are installed."""

from pathlib import Path

MODULE = '''
from onehop.contracts.geometry import Twist
from onehop.contracts.messages import DeliveryStatus, Note
from onehop.robot import atan2, to_local
from radio_proxy.core.routing.direct import DirectRouter
from robot_agent.core.planning.guidance import Guidance, PlannerStatus


class Beeline:
    """Straight to the goal, whatever stands there."""

    def __init__(self, briefing, pose, rng):
        self.goal = briefing.goal
        self.news = (Note("beeline", {}),)

    def step(self, pose, scan):
        x, y = to_local(pose, self.goal.x, self.goal.y)
        away = (x * x + y * y) ** 0.5
        status = PlannerStatus.ARRIVED if away < 0.3 else PlannerStatus.DRIVING
        news, self.news = self.news, ()
        twist = Twist(0.8 if x > 0 else 0.0, atan2(y, x))
        return Guidance(twist, status, away, float("inf"), (self.goal.x, self.goal.y), news)


class Steady:
    """Always the same gain."""

    def __init__(self, briefing):
        self.k_rho = 0.5 * (briefing.gains.k_rho_min + briefing.gains.k_rho_max)

    def heard(self, throughput_bps, threshold_bps):
        return self.k_rho


class Deaf(DirectRouter):
    """Takes no message of its own robot but commands of full size."""

    def submit(self, data, now):
        if data.message.msdu_bytes < 800:
            self._nic.drop(data, DeliveryStatus.NO_ROUTE)
        else:
            super().submit(data, now)


def deaf(nic, section, now):
    return Deaf(nic)


class Flat:
    """Everybody hears everybody at 50 dB."""

    def __init__(self, briefing):
        self.places = ()

    def place(self, places):
        self.places = places

    def row_db(self, sender):
        return [50.0] * len(self.places)


class Shapeless:
    """Of no kind."""

    def __init__(self, briefing):
        pass


def nothing_to_take():
    return None
'''

ENTRY_POINTS = """
[onehop.planners]
beeline = spare_parts:Beeline
broken = spare_broken:Anything

[onehop.gain_policies]
steady = spare_parts:Steady
shapeless = spare_parts:Shapeless
absent = spare_parts:NotThere
smooth = spare_parts:Steady

[onehop.routing]
deaf = spare_parts:deaf
narrow = spare_parts:nothing_to_take

[onehop.propagation]
flat = spare_parts:Flat
twice = spare_parts:Flat
"""

OTHER = """
[onehop.propagation]
twice = spare_parts:Shapeless
"""


def install(folder: Path) -> Path:
    """Put the package, and another one that takes a name of its, into a folder of sys.path."""
    (folder / "spare_parts.py").write_text(MODULE)
    (folder / "spare_broken.py").write_text("1 / 0\n")
    for name, points in (("spare_parts", ENTRY_POINTS), ("other_parts", OTHER)):
        about = folder / f"{name}-1.2.dist-info"
        about.mkdir()
        (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n")
        (about / "entry_points.txt").write_text(points)
    return folder
