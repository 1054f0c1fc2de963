"""One robot: everything that it knows in, everything that it does out (`Percept -> Action`).

CommandKind of a tick: hear (protocol), drive (planner when leading, tracking when following), speak.
"""

import math

from onehop.contracts.arrays import Ranges
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import Pose, Twist, to_map
from onehop.contracts.ideal_link import THESIS_THRESHOLD_BPS, threshold_bps
from onehop.contracts.messages import Action, Note, Percept
from onehop.contracts.randomness import generator
from onehop.contracts.team import Mode, Status
from robot_agent.core.motion.detour import SlotTask
from robot_agent.core.motion.follower import IN_POSITION
from robot_agent.core.motion.gains import make_policy
from robot_agent.core.motion.leader import LeaderDecision, PathfinderMaker, TeamView
from robot_agent.core.motion.robot_motion import RobotMotion
from robot_agent.core.motion.trail import behind
from robot_agent.core.planning import PlannerStatus, make_pathfinder
from robot_agent.core.team.formation import Formation, formation
from robot_agent.core.team.modes import ModeEvent
from robot_agent.core.team.protocol import TeamProtocol
from robot_agent.core.team.standing import NANOSECONDS
from robot_agent.core.team.team_messages import MissionPhase

SETTLING_TICKS = 100
"""Ticks without coming nearer to its last slot after which a follower stops where it is."""

FOLLOWER_MODES = (Mode.FOLLOWING, Mode.NARROW, Mode.BORDER)


def required_throughput_bps(briefing: Briefing) -> float:
    """Below this throughput a follower hurries [bit/s]."""
    if briefing.gains.threshold == "thesis":
        return THESIS_THRESHOLD_BPS
    return threshold_bps(briefing.radio.rate_mbps, briefing.team.next_msdu_bytes)


class Robot:
    """One incarnation of one robot."""

    def __init__(self, briefing: Briefing, make_pathfinder: PathfinderMaker = make_pathfinder) -> None:
        self._briefing = briefing
        rng = generator(briefing.seed, f"robot/{briefing.robot}/{briefing.incarnation}")
        self._motion = RobotMotion(briefing, make_pathfinder, rng)
        self._threshold = required_throughput_bps(briefing)
        self._policy = make_policy(briefing.gains, self._threshold)
        self._protocol: TeamProtocol | None = None
        self._formation: Formation | None = None
        self._formation_key: tuple[tuple[int, ...], bool] | None = None
        self._slot_key: tuple[Pose, tuple[int, ...], bool, bool] | None = None
        self._slot = Pose(0.0, 0.0, 0.0)
        self._period_ns = round(briefing.team.next_period * NANOSECONDS)
        self._in_position = False
        self._next_ns = 0
        self._k_rho = briefing.gains.k_rho_min
        self._throughput = 0.0
        self._error = 0.0
        self._target = (0.0, 0.0)
        self._remaining = 0.0
        self._best_error = math.inf
        self._settling = 0
        self._notes: list[Note] = []

    def step(self, percept: Percept) -> Action:
        """Everything that the robot does at this tick. Bad messages are counted, never raised."""
        protocol = self._protocol
        if protocol is None:
            protocol = self._protocol = TeamProtocol(self._briefing, percept.time_ns)
        now_ns, pose = percept.time_ns, percept.pose
        protocol.receive(now_ns, pose, self._in_position, percept.inbox)
        nearest = float(percept.scan.min())
        if protocol.leading:
            twist = self._lead(protocol, now_ns, pose, percept.scan, nearest)
        else:
            twist = self._follow(protocol, now_ns, pose, percept.scan, nearest)
        if not (protocol.leading and protocol.mode is Mode.SETUP and twist.w):
            protocol.speak(now_ns, self._told_pose(protocol, pose), self._motion.trail.points)
        notes = (*self._notes, *protocol.take_notes())
        self._notes = []
        return Action(
            tick=percept.tick,
            incarnation=self._briefing.incarnation,
            twist=twist,
            outbox=protocol.take_outbox(),
            speed=abs(twist.v),
            remaining_distance=self._remaining,
            status=self._status(protocol),
            notes=notes,
        )

    @property
    def ignored(self) -> dict[str, int]:
        """How many messages were ignored so far, by why: garbled, stale, foreign."""
        return dict(self._protocol.counters) if self._protocol is not None else {}

    def _status(self, protocol: TeamProtocol) -> Status:
        leading = protocol.leading
        return Status(
            mode=protocol.mode,
            epoch=protocol.epoch,
            leader=protocol.leader,
            members=protocol.members,
            shape=self._shape(protocol).shape,
            throughput_bps=-1.0 if leading else self._throughput,
            threshold_bps=self._threshold,
            k_rho=self._k_rho,
            error=self._error,
            target_x=self._target[0],
            target_y=self._target[1],
        )

    def _shape(self, protocol: TeamProtocol) -> Formation:
        """Formation of the roster in force."""
        key = (protocol.members, protocol.narrow)
        if self._formation is None or key != self._formation_key:
            team = self._briefing.team
            spacing = team.narrow_spacing if protocol.narrow else team.spacing
            self._formation = formation(protocol.members, protocol.narrow, spacing)
            self._formation_key = key
        return self._formation

    def _lead(
        self, protocol: TeamProtocol, now_ns: int, pose: Pose, scan: Ranges, nearest: float
    ) -> Twist:
        goal = self._briefing.goal
        self._target = (goal.x, goal.y)
        self._error = self._remaining = math.hypot(goal.x - pose.x, goal.y - pose.y)
        self._in_position = True
        team = self._team_view(protocol, now_ns)
        twist, decision = self._motion.lead(pose, scan, nearest, team)
        if decision.remaining > 0.0:
            self._remaining = decision.remaining
        if protocol.mode not in (Mode.SETUP, Mode.STOPPED):
            self._tell_team(protocol, decision)
        return twist

    def _team_view(self, protocol: TeamProtocol, now_ns: int) -> TeamView:
        """What this robot, as leader, knows of its team."""
        leadership = protocol.leadership
        reports = leadership.reports if leadership is not None else {}
        asked_ns = leadership.opened_ns if leadership is not None else now_ns
        return TeamView(
            gathering=protocol.mode is Mode.SETUP,
            members=protocol.members,
            column=protocol.narrow,
            reports={robot: (report.pose.x, report.pose.y) for robot, report in reports.items()},
            reports_age=(now_ns - asked_ns) / NANOSECONDS,
            announced=protocol.link.pose,
            may_ask_for_room=protocol.open,
        )

    def _tell_team(self, protocol: TeamProtocol, decision: LeaderDecision) -> None:
        """Hand the protocol what the leader wants of its team, and people what there is to know."""
        self._notes.extend(decision.notes)
        protocol.keep_clear(decision.lane, decision.lane_is_news)
        if decision.column is not protocol.narrow:
            protocol.narrow = decision.column
            if decision.passage is not None:
                protocol.note("narrow" if decision.column else "wide", passage=decision.passage)
        if decision.status is not PlannerStatus.DRIVING:
            protocol.phase = MissionPhase.FINAL
            protocol.fire(ModeEvent.ARRIVED)
            protocol.note("arrived" if decision.status is PlannerStatus.ARRIVED else "no_way")

    def _follow(
        self, protocol: TeamProtocol, now_ns: int, pose: Pose, scan: Ranges, nearest: float
    ) -> Twist:
        self._measure(protocol, now_ns)
        link = protocol.link
        leader = link.pose
        if leader is None:
            self._in_position = False
            self._target = (pose.x, pose.y)
            return self._motion.follow(pose, scan, nearest, None)
        target = self._slot_pose(protocol, leader)
        self._target = (target.x, target.y)
        self._error = math.hypot(target.x - pose.x, target.y - pose.y)
        goal = self._briefing.goal
        self._remaining = math.hypot(goal.x - pose.x, goal.y - pose.y)
        self._settle(protocol)
        if self._at_rest(protocol):
            return self._motion.follow(pose, scan, nearest, None)
        makes_room = protocol.mode is Mode.GIVING_WAY
        task = SlotTask(
            slot=target,
            trail=link.trail,
            standoff=math.hypot(target.x - leader.x, target.y - leader.y),
            leader_moves=protocol.phase is MissionPhase.DRIVING,
            k_rho=self._k_rho,
            lane=link.lane if makes_room else (),
        )
        twist = self._motion.follow(pose, scan, nearest, task)
        if not makes_room:
            self._tell_border(protocol)
        return twist

    def _told_pose(self, protocol: TeamProtocol, pose: Pose) -> Pose:
        """What followers form up on: in profile `team` the course instead of the heading (trail.py)."""
        if not protocol.open or not protocol.leading or protocol.mode is Mode.SETUP:
            return pose
        return Pose(pose.x, pose.y, self._motion.trail.course(pose))

    def _slot_pose(self, protocol: TeamProtocol, leader: Pose) -> Pose:
        """This robot's slot in the map frame, from the leader's last pose."""
        key = (leader, protocol.members, protocol.narrow, protocol.mode is Mode.JOINING)
        if key != self._slot_key:
            self._slot_key, self._slot = key, self._placed(protocol, leader)
            self._best_error = math.inf
        return self._slot

    def _placed(self, protocol: TeamProtocol, leader: Pose) -> Pose:
        shape = self._shape(protocol)
        if protocol.mode is Mode.JOINING or shape.leader == self._briefing.robot:
            x, y = to_map(leader, -self._briefing.team.spacing, 0.0)
        else:
            slot = shape.slot(self._briefing.robot)
            if protocol.narrow and len(protocol.link.trail) > 1:
                return behind(leader, protocol.link.trail, -slot.x)
            x, y = to_map(leader, slot.x, slot.y)
        return Pose(x, y, leader.heading)

    def _measure(self, protocol: TeamProtocol, now_ns: int) -> None:
        """Throughput of each Next, 0 for a missing one, and the gain that follows (thesis 3.5)."""
        link = protocol.link
        if link.next_ns > self._next_ns:
            self._next_ns = link.next_ns
            self._throughput = link.throughput_bps
            self._k_rho = self._policy.heard(link.throughput_bps)
        elif now_ns - self._next_ns > self._period_ns * 5 // 4:
            self._next_ns += self._period_ns
            self._throughput = 0.0
            self._k_rho = self._policy.heard(0.0)

    def _settle(self, protocol: TeamProtocol) -> None:
        """Whether the robot is in its slot, or, in profile `team`, as near to it as it can get.

        Differs: a slot may lie inside a wall; the thesis would wait for it until the setup timeout.
        """
        if protocol.phase is MissionPhase.DRIVING or self._error < self._best_error - 0.05:
            self._best_error, self._settling = self._error, 0
        else:
            self._settling += 1
        near = protocol.open and self._error < self._briefing.team.spacing / 2.0
        self._in_position = self._error <= IN_POSITION or (near and self._settling > SETTLING_TICKS)

    def _at_rest(self, protocol: TeamProtocol) -> bool:
        """At the end of the mission: stop in the slot, or where nothing more is gained."""
        if protocol.mode is Mode.STOPPED and protocol.phase is not MissionPhase.FINAL:
            return True
        if protocol.phase is not MissionPhase.FINAL:
            return False
        rest = self._in_position or self._settling > SETTLING_TICKS
        if protocol.mode in FOLLOWER_MODES and rest:
            protocol.fire(ModeEvent.ARRIVED)
        return protocol.mode is Mode.STOPPED

    def _tell_border(self, protocol: TeamProtocol) -> None:
        """Border following interrupts Algorithm 1 and resumes it (thesis 3.3.4)."""
        border = self._motion.border
        if border and protocol.mode in (Mode.FOLLOWING, Mode.NARROW):
            protocol.fire(ModeEvent.OBSTRUCTED)
        elif not border and protocol.mode is Mode.BORDER:
            protocol.fire(ModeEvent.CLEARED_NARROW if protocol.narrow else ModeEvent.CLEARED)
