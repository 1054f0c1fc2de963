"""One robot: everything that it knows in, everything that it does out (`Percept -> Action`).

Order of a tick: hear (team protocol), drive (as leader or as follower), speak.
"""

import math

from onehop.contracts.arrays import Ranges
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.ideal_link import THESIS_THRESHOLD_BPS, propagation_us, threshold_bps
from onehop.contracts.messages import Note, Percept
from onehop.contracts.randomness import generator
from onehop.contracts.team import Mode, Status
from onehop.contracts.units import NANOSECONDS
from onehop.robot import Action, Program
from robot_agent.core.motion.aim import AimingPolicy, PacingPolicy, Report, Situation
from robot_agent.core.motion.detour import SlotTask
from robot_agent.core.motion.gains import make_policy
from robot_agent.core.motion.leader import PathfinderMaker, TeamView
from robot_agent.core.motion.robot_motion import RobotMotion
from robot_agent.core.motion.slot import Settling, SlotFinder
from robot_agent.core.planning import PlannerStatus, make_pathfinder
from robot_agent.core.team.events import BecameFollower, BecameLeader, NextMeasured, TeamEvent
from robot_agent.core.team.leader_view import LeaderView
from robot_agent.core.team.part import Leading
from robot_agent.core.team.protocol import TeamProtocol
from robot_agent.core.team.team_messages import MissionPhase

FOLLOWER_MODES = (Mode.FOLLOWING, Mode.NARROW, Mode.BORDER)


def required_throughput_bps(briefing: Briefing, distance: float = 0.0) -> float:
    """Below this throughput a follower hurries [bit/s]. distance: of its slot from the leader [m]."""
    threshold = briefing.gains.threshold
    if threshold == "thesis":
        return THESIS_THRESHOLD_BPS
    delay_us = propagation_us(distance) if threshold == "slot" else 0.0
    return threshold_bps(briefing.radio.rate_mbps, briefing.team.next_msdu_bytes, delay_us)


class Robot(Program):
    """One incarnation of one robot of the built-in team."""

    def __init__(self, briefing: Briefing, make_pathfinder: PathfinderMaker = make_pathfinder) -> None:
        self._briefing = briefing
        rng = generator(briefing.seed, f"robot/{briefing.robot}/{briefing.incarnation}")
        self._motion = RobotMotion(briefing, make_pathfinder, rng)
        self._slots = SlotFinder(briefing.team)
        self._settling = Settling(briefing.period_ns / NANOSECONDS)
        self._threshold = required_throughput_bps(briefing)
        self._threshold_distance = math.nan
        self._protocol: TeamProtocol | None = None
        self._in_position = False
        self._error = 0.0
        self._target = (0.0, 0.0)
        self._remaining = 0.0
        self._heading = math.nan
        self._notes: tuple[Note, ...] = ()
        self._reset_gain()

    def step(self, percept: Percept) -> Action:
        """Everything that the robot does at this tick. Bad messages are counted, never raised."""
        now_ns, pose, scan = percept.time_ns, percept.pose, percept.scan
        protocol = self._protocol
        if protocol is None:
            protocol = self._protocol = TeamProtocol(self._briefing, now_ns, pose)
        protocol.receive(now_ns, pose, self._in_position, percept.inbox)
        for event in protocol.take_events():
            self._on_event(event)
        nearest = float(scan.min())
        part = protocol.state.part
        self._notes = ()
        if isinstance(part, Leading):
            twist = self._lead(protocol, part, now_ns, pose, scan, nearest)
        else:
            twist = self._follow(protocol, part.leader, now_ns, pose, scan, nearest)
        leads = isinstance(part, Leading)
        turns = twist.w != 0.0 and pose.heading != self._heading  # or is held, and has to speak
        self._heading = pose.heading
        if not (leads and protocol.state.mode is Mode.SETUP and turns):
            told = self._told_pose(protocol, pose) if leads else pose
            protocol.speak(now_ns, told, self._motion.trail.points)
        return Action(
            twist=twist,
            outbox=protocol.take_outbox(),
            notes=(*self._notes, *protocol.take_notes()),
            remaining_distance=self._remaining,
            status=self._status(protocol),
        )

    @property
    def ignored(self) -> dict[str, int]:
        """How many messages were ignored so far, by why: garbled, stale, foreign."""
        return dict(self._protocol.counters) if self._protocol is not None else {}

    def _status(self, protocol: TeamProtocol) -> Status:
        state = protocol.state
        return Status(
            mode=state.mode,
            epoch=state.roster.epoch,
            leader=state.leader,
            members=state.roster.members,
            shape=self._slots.shape(state).shape,
            throughput_bps=-1.0 if isinstance(state.part, Leading) else self._throughput,
            threshold_bps=self._threshold,
            k_rho=self._k_rho,
            error=self._error,
            target_x=self._target[0],
            target_y=self._target[1],
        )

    def _on_event(self, event: TeamEvent) -> None:
        """Each change of part starts afresh; each Next that was due counts for k_rho (thesis 3.5)."""
        if isinstance(event, BecameLeader | BecameFollower):
            self._motion.begin_part()
            self._reset_gain()
        else:
            self._throughput = event.throughput_bps if isinstance(event, NextMeasured) else 0.0
            self._k_rho = self._policy.heard(self._throughput, self._threshold)

    def _reset_gain(self) -> None:
        """A follower that has not heard a Next yet is in no hurry."""
        policy = make_policy(self._briefing)
        self._policy = policy
        self._aiming = policy if isinstance(policy, AimingPolicy) else None
        self._pacing = policy if isinstance(policy, PacingPolicy) else None
        self._k_rho = self._briefing.gains.k_rho_min
        self._throughput = 0.0

    def _lead(
        self,
        protocol: TeamProtocol,
        part: Leading,
        now_ns: int,
        pose: Pose,
        scan: Ranges,
        nearest: float,
    ) -> Twist:
        goal, mode = self._briefing.goal, protocol.state.mode
        self._target = (goal.x, goal.y)
        self._error = self._remaining = math.hypot(goal.x - pose.x, goal.y - pose.y)
        self._in_position = True
        team = self._team_view(protocol, part, now_ns, pose)
        twist, decision = self._motion.lead(pose, scan, nearest, team)
        if decision.remaining > 0.0:
            self._remaining = decision.remaining
        if mode not in (Mode.SETUP, Mode.STOPPED):
            self._notes = decision.notes
            protocol.order_column(decision.column, decision.passage)
            protocol.keep_clear(decision.lane, decision.lane_is_news)
            if decision.status is not PlannerStatus.DRIVING:
                protocol.end_mission(decision.status is PlannerStatus.ARRIVED)
        return twist

    def _team_view(self, protocol: TeamProtocol, part: Leading, now_ns: int, pose: Pose) -> TeamView:
        """What this robot, as leader, knows of its team."""
        state = protocol.state
        reports = part.ledger.reports
        pace = 1.0
        if self._pacing is not None and state.phase is MissionPhase.DRIVING:
            pace = self._pacing.pace((pose.x, pose.y), self._reports(part))
        return TeamView(
            gathering=state.mode is Mode.SETUP,
            members=state.roster.members,
            column=state.narrow,
            reports={robot: (report.pose.x, report.pose.y) for robot, report in reports.items()},
            reports_age=(now_ns - part.schedule.commanded_ns) / NANOSECONDS,
            announced=part.told,
            may_ask_for_room=protocol.rules.trail,
            pace=pace,
        )

    @staticmethod
    def _reports(part: Leading) -> dict[int, Report]:
        """Who answered from where, and how that was heard."""
        found = {}
        for robot, report in part.ledger.reports.items():
            answered = part.answered.get(robot)
            if answered is not None:
                place, told = (report.pose.x, report.pose.y), (answered.told.x, answered.told.y)
                found[robot] = Report(place, told, answered.snr_db, answered.hops)
        return found

    def _follow(
        self,
        protocol: TeamProtocol,
        view: LeaderView,
        now_ns: int,
        pose: Pose,
        scan: Ranges,
        nearest: float,
    ) -> Twist:
        state, leader = protocol.state, view.pose
        if leader is None:
            self._in_position = False
            self._target = (pose.x, pose.y)
            return self._motion.follow(pose, scan, nearest, None)
        target = self._slots.slot(state, view, leader)
        distance = self._slots.distance(state)
        if distance != self._threshold_distance:
            self._threshold_distance = distance
            self._threshold = required_throughput_bps(self._briefing, distance)
        goal = self._briefing.goal
        self._target = (target.x, target.y)
        self._remaining = math.hypot(goal.x - pose.x, goal.y - pose.y)
        self._settling.watch(pose, target, state.phase is MissionPhase.DRIVING)
        self._error = self._settling.error
        self._in_position = self._is_in_position()
        if self._is_at_rest(protocol):
            return self._motion.follow(pose, scan, nearest, None)
        makes_room = state.mode is Mode.GIVING_WAY
        k_rho = self._k_rho
        if self._aiming is not None:
            driving = state.phase is MissionPhase.DRIVING
            others = self._slots.others(state, leader)
            target, k_rho = self._aiming.aim(
                Situation(now_ns, pose, leader, view.silent_since_ns, target, others, driving)
            )
        task = SlotTask(
            slot=target,
            trail=view.trail,
            standoff=math.hypot(target.x - leader.x, target.y - leader.y),
            leader_moves=state.phase is MissionPhase.DRIVING,
            k_rho=k_rho,
            lane=view.lane if makes_room else (),
        )
        twist = self._motion.follow(pose, scan, nearest, task)
        if not makes_room:
            protocol.report_border(self._motion.border)
        return twist

    def _told_pose(self, protocol: TeamProtocol, pose: Pose) -> Pose:
        """What followers form up on: in profile `team` the course instead of the heading (trail.py)."""
        if not protocol.rules.trail or protocol.state.mode is Mode.SETUP:
            return pose
        return Pose(pose.x, pose.y, self._motion.trail.course(pose))

    def _is_in_position(self) -> bool:
        """Whether the robot is in its slot, or as near to it as it can get.

        Differs: a slot may lie inside a wall or beside one, where no robot can stand; the thesis would
        wait for it until the setup timeout, and lose the robot.
        """
        near = self._error < self._briefing.team.spacing / 2.0
        return self._settling.in_slot or (near and self._settling.settled)

    def _is_at_rest(self, protocol: TeamProtocol) -> bool:
        """At the end of the mission: stop in the slot, or where nothing more is gained."""
        state = protocol.state
        if state.phase is not MissionPhase.FINAL:
            return state.mode is Mode.STOPPED
        rest = self._in_position or self._settling.settled
        if state.mode in FOLLOWER_MODES and rest:
            protocol.rest()
        return state.mode is Mode.STOPPED
