"""The sections of a scenario but for the radio: values, defaults with units and source, conditions."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from onehop.contracts.problems import Problem, positive

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class MapSection:
    """The ground. Either `file` (ROS .yaml or MovingAI .map), or width, height and polygons.

    cell: metres a cell of a MovingAI grid. obstacles: polygons of (x, y) corners [m], filled.
    A polygon map has its origin at the lower left corner and a wall around it.
    """

    file: str = ""
    cell: float = 1.0
    width: float = 0.0
    height: float = 0.0
    obstacles: tuple[tuple[Point, ...], ...] = ()

    def problems(self) -> Iterator[Problem]:
        yield from positive(self, "cell")
        if self.file:
            if self.obstacles or self.width or self.height:
                yield Problem("file", "a map file and a polygon map at once", "keep one of them")
            return
        yield from positive(self, "width", "height")
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

    x: float = 0.0
    y: float = 0.0
    radius: float = 0.0
    poses: tuple[tuple[float, float, float], ...] = ()

    def problems(self) -> Iterator[Problem]:
        if self.radius < 0:
            yield Problem("radius", f"{self.radius} is negative", "0 (automatic) or more metres")


@dataclass(frozen=True, slots=True)
class GoalSection:
    """Where the team goes [m]; the leader has arrived within `tolerance` of it [m]."""

    x: float
    y: float
    tolerance: float = 0.5

    def problems(self) -> Iterator[Problem]:
        yield from positive(self, "tolerance")


@dataclass(frozen=True, slots=True)
class RobotSection:
    """Body and sensors, the same for all robots (thesis 3.1).

    radius: of the disc that collides [m]. leader_speed: V_L [m/s]. max_speed: of followers [m/s].
    max_turn_rate [rad/s]. laser_*: 2-D range finder ahead (thesis 3.2, 3.4).
    """

    radius: float = 0.2
    leader_speed: float = 1.0
    max_speed: float = 3.0
    max_turn_rate: float = 3.0
    laser_range: float = 10.0
    laser_beams: int = 181
    laser_fov_deg: float = 180.0

    def problems(self) -> Iterator[Problem]:
        yield from positive(self, "radius", "leader_speed", "max_speed", "max_turn_rate", "laser_range")
        if self.laser_beams < 2:
            yield Problem("laser_beams", f"{self.laser_beams} beams", "at least 2")
        if not 0 < self.laser_fov_deg <= 270:
            yield Problem("laser_fov_deg", f"{self.laser_fov_deg} degrees", "0 < fov <= 270")


@dataclass(frozen=True, slots=True)
class GainsSection:
    """Gains of the tracking controller (thesis eq. 3.11, 3.12) and the policy of k_rho.

    policy: "throughput" (thesis: k_rho_max below the threshold), "constant" (always k_rho_min), or
    "smooth" (ours: rises in proportion to the deficit of a filtered throughput, and to its fall).
    threshold: "thesis" (0.5333e6 bit/s for all) or "ideal" (the same share of the ideal throughput at
    this rate and size of Next). reverse: drive backwards to a slot that lies behind (thesis eq. 3.10);
    that is blind, so the default is to turn on the spot first.
    """

    k_alpha: float = 8.0
    k_beta: float = -1.5
    k_rho_min: float = 1.0
    k_rho_max: float = 3.0
    policy: Literal["throughput", "constant", "smooth"] = "throughput"
    threshold: Literal["thesis", "ideal"] = "thesis"
    reverse: bool = False

    def problems(self) -> Iterator[Problem]:
        yield from positive(self, "k_rho_min")
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
    """Who takes part, and the rules of the team (thesis 3.3).

    ids: robots, or empty for 1..size. spacing: s of the slot table [m]. next_period: T [s].
    lost_after: missing acknowledgements in a row until a follower is given up.
    leader_timeout: silence until a follower gives up its leader [s]. setup_timeout [s].
    next_msdu_bytes: size of Next on the air (thesis 3.7).

    profile: "thesis" (its rules alone) or "team" (epochs, yielding, joining; team.md).
    orphan: what a robot of profile "thesis" does that hears nobody any more: "stop", or go "solo"
    (thesis 3.8.1). successor_timeout: silence of an elected leader until it is given up too [s].
    narrow_spacing: distance between neighbours in the column of a narrow passage [m].
    straggler_speed: share of leader_speed while a follower is more than a spacing behind; 1 = the
    leader never waits (thesis 3.8.2).
    """

    size: int = 6
    ids: tuple[int, ...] = ()
    spacing: float = 4.0
    next_period: float = 2.0
    lost_after: int = 2
    leader_timeout: float = 5.0
    setup_timeout: float = 40.0
    next_msdu_bytes: int = 800
    profile: Literal["team", "thesis"] = "team"
    orphan: Literal["stop", "solo"] = "stop"
    successor_timeout: float = 1.0
    narrow_spacing: float = 1.5
    straggler_speed: float = 1.0

    @property
    def robots(self) -> tuple[int, ...]:
        return tuple(sorted(self.ids)) if self.ids else tuple(range(1, self.size + 1))

    def problems(self) -> Iterator[Problem]:
        yield from positive(
            self, "size", "spacing", "next_period", "lost_after", "leader_timeout", "setup_timeout",
            "successor_timeout", "narrow_spacing", "straggler_speed",
        )  # fmt: skip
        if self.straggler_speed > 1:
            yield Problem("straggler_speed", f"{self.straggler_speed} is above 1", "a share, 0 < s <= 1")
        if self.leader_timeout < self.next_period:
            yield Problem(
                "leader_timeout",
                f"{self.leader_timeout} s is less than next_period",
                f"at least {self.next_period} s",
            )
        duplicates = sorted({i for i in self.ids if self.ids.count(i) > 1})
        if duplicates:
            yield Problem("ids", f"robot {duplicates[0]} stands twice", "every id once")
        if any(i < 1 for i in self.ids):
            yield Problem("ids", f"id {min(self.ids)}", "ids are 1 or more")
        if not 1 <= self.next_msdu_bytes <= 2304:
            yield Problem("next_msdu_bytes", f"{self.next_msdu_bytes} B", "1..2304 (802.11 MSDU limit)")


@dataclass(frozen=True, slots=True)
class PlannerSection:
    """Way-finding of the leader (thesis 3.4). inflation: clearance kept from obstacles [m].

    samples: points a road map. classify_range: obstacles nearer than this turn the fan [m].
    memory: way points that `escape` can remember. patience: distance that it may search without coming
    closer to the goal, in laser ranges.
    """

    kind: Literal["escape", "modified", "original"] = "escape"
    samples: int = 200
    inflation: float = 0.5
    classify_range: float = 3.0
    memory: int = 1024
    patience: float = 50.0

    def problems(self) -> Iterator[Problem]:
        yield from positive(self, "samples", "inflation", "classify_range", "memory", "patience")


@dataclass(frozen=True, slots=True)
class ClockSection:
    """period_ms: length of a tick, in which everyone waits for its inputs and for nothing else.

    limit_s: simulated time after which a mission has failed.
    silence_s: wall-clock time after which a process that says nothing is given up [s].
    """

    period_ms: int = 50
    limit_s: float = 900.0
    silence_s: float = 10.0

    @property
    def period_ns(self) -> int:
        return self.period_ms * 1_000_000

    def problems(self) -> Iterator[Problem]:
        yield from positive(self, "period_ms", "limit_s", "silence_s")


@dataclass(frozen=True, slots=True)
class FaultSection:
    """One scripted fault, carried out at the first tick at or after at_s.

    kill robots; restart robots; hold robots for duration_s (they stand still); cut robots from
    `others` (empty: from all the rest) for duration_s; jam a disc x, y, radius with noise_dbm for
    duration_s. A duration of 0 lasts to the end, or to the next `heal`.
    """

    kind: Literal["kill", "restart", "hold", "cut", "jam", "heal"]
    at_s: float
    robots: tuple[int, ...] = ()
    others: tuple[int, ...] = ()
    duration_s: float = 0.0
    x: float = 0.0
    y: float = 0.0
    radius: float = 0.0
    noise_dbm: float = -60.0

    def problems(self) -> Iterator[Problem]:
        if self.at_s < 0:
            yield Problem("at_s", f"{self.at_s} is negative", "seconds since the start")
        if self.duration_s < 0:
            yield Problem("duration_s", f"{self.duration_s} is negative", "0 or more seconds")
        if self.kind in ("kill", "restart", "hold", "cut") and not self.robots:
            yield Problem("robots", f"{self.kind} of nobody", "name at least one robot")
        if self.kind == "jam":
            yield from positive(self, "radius")
