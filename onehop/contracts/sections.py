"""The sections of a scenario but for radio and faults: values, defaults, units, source, conditions."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from onehop.contracts.plugin_names import PluginName, name_problems
from onehop.contracts.problems import Problem
from onehop.contracts.program_section import (
    BUILT_IN,
    RobotId,
    parameter_problems,
    program_problems,
)
from onehop.contracts.ranges import Range

Coordinate = Annotated[float, Range(-1e7, 1e7)]
"""x or y in the map frame [m]; UTM northings reach 1e7."""

Point = tuple[Coordinate, Coordinate]

Seconds = Annotated[float, Range(0.0, 1e6)]
"""A time of the mission [s]: up to eleven days."""

MOST_PATH_POINTS = 1000
"""Points of a path that a leader is given: 10 km at one every 10 m."""

MOST_ROBOTS = 300
"""Robots of a team: a leader names all of them in one frame of 2304 bytes, whatever their ids are."""


@dataclass(frozen=True, slots=True)
class MapSection:
    """The ground. Either `file` (ROS .yaml or MovingAI .map), or width, height and polygons.

    cell: metres a cell of a MovingAI grid. obstacles: polygons of (x, y) corners [m], filled.
    A polygon map has its origin at the lower left corner and a wall around it.
    """

    file: str = ""
    cell: Annotated[float, Range(1e-3, 1e3)] = 1.0
    width: Annotated[float, Range(0.0, 1e5)] = 0.0
    height: Annotated[float, Range(0.0, 1e5)] = 0.0
    obstacles: tuple[tuple[Point, ...], ...] = ()

    def problems(self) -> Iterator[Problem]:
        if self.file:
            if self.obstacles or self.width or self.height:
                yield Problem("file", "a map file and a polygon map at once", "keep one of them")
            return
        for key in ("width", "height"):
            if not getattr(self, key) > 0:
                yield Problem(key, "a map without extent", "its size in metres, or a map file")
        for number, polygon in enumerate(self.obstacles):
            if len(polygon) < 3:
                yield Problem(
                    f"obstacles[{number}]", f"{len(polygon)} corners", "a polygon has at least 3"
                )
            for x, y in polygon:
                if not (0 <= x <= self.width and 0 <= y <= self.height):
                    yield Problem(
                        f"obstacles[{number}]",
                        f"corner ({x}, {y}) is outside the map",
                        f"0 <= x <= {self.width} and 0 <= y <= {self.height}",
                    )


@dataclass(frozen=True, slots=True)
class StartSection:
    """Where the team starts: random poses in a disc (by seed), or `poses` as [x, y, heading_deg].

    x, y: centre of the disc [m]. radius: its radius [m]; 0 = as small as the team allows.
    """

    x: Coordinate = 0.0
    y: Coordinate = 0.0
    radius: Annotated[float, Range(0.0, 1e5)] = 0.0
    poses: tuple[tuple[Coordinate, Coordinate, Annotated[float, Range(-360.0, 360.0)]], ...] = ()


@dataclass(frozen=True, slots=True)
class GoalSection:
    """Where the team goes [m]; the leader has arrived within `tolerance` of it [m]."""

    x: Coordinate
    y: Coordinate
    tolerance: Annotated[float, Range(1e-3, 1e3)] = 0.5


Radius = Annotated[float, Range(0.01, 10.0)]
Speed = Annotated[float, Range(0.01, 100.0)]
TurnRate = Annotated[float, Range(0.01, 100.0)]
LaserRange = Annotated[float, Range(0.1, 1e3)]
LaserBeams = Annotated[int, Range(2, 10_000)]
Field = Annotated[float, Range(1.0, 270.0)]
Noise = Annotated[float, Range(0.0, 100.0)]
"""Numbers of a body: [m], [m/s], [rad/s], [m], beams, [degrees], [m] or [degrees]."""

NOISE_SIGMAS = 4.0
"""Noise of sensors is held within so many standard deviations: one draw in 16,000 would lie beyond."""


@dataclass(frozen=True, slots=True)
class RobotSection:
    """Body and sensors of all robots (thesis 3.1) but for what [[robots]] says of single ones.

    radius: of the disc that collides [m]. leader_speed: V_L [m/s]. max_speed: of followers [m/s].
    max_turn_rate [rad/s]. laser_*: 2-D range finder ahead (thesis 3.2, 3.4).
    pose_noise, heading_noise_deg, laser_noise: standard deviations of what a robot is told, drawn anew
    at every tick: of x and of y [m], of the heading [degrees], of each range that hits something [m].
    """

    radius: Radius = 0.2
    leader_speed: Speed = 1.0
    max_speed: Speed = 3.0
    max_turn_rate: TurnRate = 3.0
    laser_range: LaserRange = 10.0
    laser_beams: LaserBeams = 181
    laser_fov_deg: Field = 180.0
    pose_noise: Noise = 0.0
    heading_noise_deg: Noise = 0.0
    laser_noise: Noise = 0.0


GainPolicyName = Literal["throughput", "constant", "smooth", "predictive", "lambda2"]
"""Policies that are built in; packages may add others."""


@dataclass(frozen=True, slots=True)
class GainsSection:
    """Gains of the tracking controller (thesis eq. 3.11, 3.12) and the policy of k_rho.

    policy: "throughput" (thesis: k_rho_max below the threshold), "constant" (always k_rho_min), "smooth"
    (ours: rises in proportion to the deficit of a filtered throughput, and to its fall), "predictive"
    (ours: aims ahead, keeps pace, hurries early, and the leader minds the frontier), or "lambda2" (up
    the second eigenvalue of the rates' Laplacian); docs/policies.md.
    threshold: "thesis" (0.5333e6 bit/s for all), "ideal" (the same share of the ideal throughput at
    this rate and size of Next) or "slot" (of the ideal throughput over the distance of the robot's slot
    from the leader, thesis 3.8.3). reverse: drive backwards to a slot that lies behind (thesis eq.
    3.10), where the robot saw a moment ago that the way is free; the default is to turn to it first.
    """

    k_alpha: Annotated[float, Range(1e-3, 1e3)] = 8.0
    k_beta: Annotated[float, Range(-1e3, 1e3)] = -1.5
    k_rho_min: Annotated[float, Range(1e-3, 1e3)] = 1.0
    k_rho_max: Annotated[float, Range(1e-3, 1e3)] = 3.0
    policy: GainPolicyName | PluginName = "throughput"
    threshold: Literal["thesis", "ideal", "slot"] = "thesis"
    reverse: bool = False

    def problems(self) -> Iterator[Problem]:
        yield from name_problems("policy", self.policy)
        if not self.k_beta < 0:
            yield Problem("k_beta", f"{self.k_beta} is not negative", "k_beta < 0 (eq. 3.14)")
        if self.k_rho_max < self.k_rho_min:
            yield Problem("k_rho_max", f"{self.k_rho_max} < k_rho_min", f"at least {self.k_rho_min}")
        if not self.k_alpha - self.k_rho_max > 0:
            yield Problem(
                "k_alpha",
                f"{self.k_alpha} - k_rho_max {self.k_rho_max} is not positive",
                f"k_alpha > {self.k_rho_max} (eq. 3.14)",
            )


@dataclass(frozen=True, slots=True)
class TeamSection:
    """Who takes part, driven by which program, and the rules of the built-in team (thesis 3.3).

    program: "package.module:Class" (docs/own-robot.md). parameters: of that program, as its own class
    names them; the built-in team goes by the keys below and by [gains] and [planner].

    ids: robots, or empty for 1..size. spacing: s of the slot table [m]. next_period: T [s].
    lost_after: missing acknowledgements in a row until a follower is given up.
    leader_timeout: silence until a follower gives up its leader [s]. target_timeout: the same for one
    that stands in its slot, since it is there (thesis 4.3: T) [s]; 0: leader_timeout alone.
    setup_timeout [s]. next_msdu_bytes: size of Next on the air (thesis 3.7).

    profile: "thesis" (its rules alone) or "team" (epochs, yielding, joining; docs/modes.md).
    orphan: what a robot of profile "thesis" does that hears nobody any more: "stop", or go "solo"
    (thesis 3.8.1). successor_timeout: silence of an elected leader until it is given up too [s].
    narrow_spacing: distance between neighbours in the column of a narrow passage [m].
    straggler_speed: share of leader_speed while a follower is more than a spacing behind; 1 = the
    leader never waits (thesis 3.8.2).
    """

    program: str = BUILT_IN
    parameters: dict[str, Any] = field(default_factory=dict)
    size: Annotated[int, Range(1, MOST_ROBOTS)] = 6
    ids: tuple[RobotId, ...] = ()
    spacing: Annotated[float, Range(0.01, 1e3)] = 4.0
    next_period: Annotated[float, Range(0.01, 3600.0)] = 2.0
    lost_after: Annotated[int, Range(1, 1000)] = 2
    leader_timeout: Annotated[float, Range(0.01, 1e5)] = 5.0
    target_timeout: Annotated[float, Range(0.0, 1e5)] = 0.0
    setup_timeout: Annotated[float, Range(0.01, 1e5)] = 40.0
    next_msdu_bytes: Annotated[int, Range(1, 2304)] = 800
    profile: Literal["team", "thesis"] = "team"
    orphan: Literal["stop", "solo"] = "stop"
    successor_timeout: Annotated[float, Range(0.01, 1e5)] = 1.0
    narrow_spacing: Annotated[float, Range(0.01, 1e3)] = 1.5
    straggler_speed: Annotated[float, Range(1e-3, 1.0)] = 1.0

    @property
    def robots(self) -> tuple[int, ...]:
        return tuple(sorted(self.ids)) if self.ids else tuple(range(1, self.size + 1))

    def problems(self) -> Iterator[Problem]:
        if self.leader_timeout < self.next_period:
            yield Problem(
                "leader_timeout",
                f"{self.leader_timeout} s is less than next_period",
                f"at least {self.next_period} s",
            )
        if 0.0 < self.target_timeout < self.next_period:
            yield Problem(
                "target_timeout",
                f"{self.target_timeout} s is less than next_period",
                f"at least {self.next_period} s, or 0 for leader_timeout alone",
            )
        yield from program_problems(self.program)
        yield from parameter_problems(self.parameters)
        duplicates = sorted({i for i in self.ids if self.ids.count(i) > 1})
        if duplicates:
            yield Problem("ids", f"robot {duplicates[0]} stands twice", "every id once")
        if len(self.ids) > MOST_ROBOTS:
            yield Problem("ids", f"{len(self.ids)} robots", f"at most {MOST_ROBOTS}")


PlannerName = Literal["escape", "modified", "original", "path"]
"""Ways of way-finding that are built in; packages may add others."""


@dataclass(frozen=True, slots=True)
class PlannerSection:
    """Way-finding of the leader (thesis 3.4). inflation: clearance kept from obstacles [m].

    kind: "escape" (ours), "modified", "original" (thesis 3.4, 4.1), or "path": along `path`, points from
    the start to the goal [m] (thesis 4.2). samples: points a road map. classify_range: obstacles nearer
    than this turn the fan [m]. classify: whether `modified` looks for them at its virtual goals alone,
    or while it drives as well (Algorithm 2, 4 a 1). memory: way points that `escape` can remember.
    patience: distance that it may search without coming closer to the goal, in laser ranges.
    """

    kind: PlannerName | PluginName = "escape"
    path: tuple[Point, ...] = ()
    samples: Annotated[int, Range(1, 5000)] = 200
    inflation: Annotated[float, Range(0.01, 100.0)] = 0.5
    classify_range: Annotated[float, Range(0.01, 1e3)] = 3.0
    classify: Literal["virtual goals", "driving"] = "virtual goals"
    memory: Annotated[int, Range(1, 100_000)] = 1024
    patience: Annotated[float, Range(0.1, 1e6)] = 50.0

    def problems(self) -> Iterator[Problem]:
        yield from name_problems("kind", self.kind)
        if self.kind == "path" and len(self.path) < 2:
            yield Problem(
                "path", f"{len(self.path)} points to drive along", "at least two, [[x, y], [x, y]]"
            )
        if len(self.path) > MOST_PATH_POINTS:
            yield Problem("path", f"{len(self.path)} points", f"at most {MOST_PATH_POINTS}")


def beside_goal(goal: GoalSection, body: RobotSection, planner: PlannerSection) -> float:
    """Distance from the goal within which a leader is beside a robot that stands on it [m].

    The other one's middle is within the goal's tolerance, and a planner keeps a little more than the
    inflation from its hull.
    """
    return goal.tolerance + body.radius + 1.2 * planner.inflation


@dataclass(frozen=True, slots=True)
class ClockSection:
    """period_ms: length of a tick. mode: whether everyone waits in it for its inputs and for nothing
    else ("lockstep"), or nobody for anybody ("realtime", docs/realtime.md).

    limit_s: simulated time after which a mission has failed.
    silence_s: wall-clock time after which a process that says nothing is given up [s].
    speed: simulated seconds in one of the wall clock; in real time alone. hold_s: how long a robot that
    says nothing goes on with its last command, simulated [s]; in real time alone.
    """

    period_ms: Annotated[int, Range(1, 1000)] = 50
    limit_s: Annotated[float, Range(0.001, 1e6)] = 900.0
    silence_s: Annotated[float, Range(0.1, 3600.0)] = 10.0
    mode: Literal["lockstep", "realtime"] = "lockstep"
    speed: Annotated[float, Range(0.01, 100.0)] = 1.0
    hold_s: Annotated[float, Range(0.0, 60.0)] = 0.5

    @property
    def period_ns(self) -> int:
        return self.period_ms * 1_000_000

    @property
    def is_realtime(self) -> bool:
        return self.mode == "realtime"
