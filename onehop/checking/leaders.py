"""`one-leader`, `one-team`, `re-election`: what becomes of leadership where robots hear each other.

Bounds in Next periods T, as docs/modes.md derives them for profile `team`: B = 4 T, and 3 T more where a
roster still names robots that are gone or out of reach, since those have to be given up first.
"""

from dataclasses import dataclass

import numpy as np

from onehop.checking.findings import Exhibit, Findings
from onehop.checking.invariants import ONE_LEADER, ONE_TEAM, RE_ELECTION
from onehop.checking.reach import Links
from onehop.checking.snapshot import Snapshot
from onehop.contracts.link_trace import LinkTrace
from onehop.contracts.messages import Truth
from onehop.contracts.printable import ids_in_words
from onehop.contracts.scenario import Scenario
from onehop.contracts.team import Mode, Status

BOUND_PERIODS = 4
"""B: Next periods after which robots that hear each other have one leader."""

GIVING_UP_PERIODS = 3
"""Next periods more in which the dead are given up: lost_after of 2, and the first asking."""


_Group = tuple[tuple[int, int], ...]
"""Robots and their incarnations."""


@dataclass(frozen=True, slots=True)
class _Wait:
    """Something is not yet as it should be. since, deadline: ticks."""

    since: int
    deadline: int


@dataclass(slots=True)
class _Vacancy:
    """A leader has left. rest: who obeyed it. deadline: tick by which a new one acts."""

    leader: int
    rest: list[int]
    tick: int
    deadline: int
    last_word: Exhibit


class Leadership:
    """Watches who acts as leader, and who could hear it."""

    def __init__(self, findings: Findings, scenario: Scenario, trace: LinkTrace | None = None) -> None:
        team, period_ns = scenario.team, scenario.clock.period_ns
        self._findings = findings
        self._is_team_profile = team.profile == "team"
        self._orphans_stop = not self._is_team_profile and team.orphan == "stop"
        next_ns = round(team.next_period * 1e9)
        self._next_ticks = next_ns / period_ns
        self._bound = int(BOUND_PERIODS * self._next_ticks) + 1
        giving_up = max(GIVING_UP_PERIODS, team.lost_after + 1)
        self._long_bound = int((BOUND_PERIODS + giving_up) * self._next_ticks) + 1
        self._patience = team.leader_timeout * 1e9 / period_ns
        successor = team.successor_timeout if self._is_team_profile else team.leader_timeout
        self._successor_patience = successor * 1e9 / period_ns
        self._links = Links(team.robots, scenario.radio, next_ns, trace)
        self._statuses: dict[int, Status] = {}
        self._acting_since: dict[int, int] = {}
        self._sound_since: dict[int, int] = {}
        self._leaderless: dict[_Group, _Wait] = {}
        self._divided: dict[_Group, _Wait] = {}
        self._vacancies: list[_Vacancy] = []

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        if now.truth is None:
            self._forget()
            return
        if not now.follows:
            self._forget()
        before = self._statuses
        self._links.take(now, now.truth)
        self._statuses = {
            robot: action.status
            for robot, action in now.actions.items()
            if robot in now.present and action.status is not None
        }
        leaders = [robot for robot, status in self._statuses.items() if status.leader == robot]
        if self._is_team_profile:
            self._judge_two(now, leaders)
            self._judge_none(now, leaders)
            self._judge_groups(now)
        self._open_vacancies(now, now.truth, before)
        self._judge_vacancies(now, leaders)

    def _forget(self) -> None:
        self._statuses, self._acting_since, self._sound_since = {}, {}, {}
        self._leaderless, self._divided = {}, {}
        self._vacancies = []

    # one-leader

    def _judge_two(self, now: Snapshot, leaders: list[int]) -> None:
        """Of two that act as leader and hear each other one yields."""
        tick, links = now.tick, self._links
        self._acting_since = {robot: self._acting_since.get(robot, tick) for robot in leaders}
        self._sound_since = {
            robot: self._sound_since.get(robot, tick) if self._is_sound(robot, now) else tick + 1
            for robot in leaders
        }
        linked = np.array(links.since <= tick - self._bound)
        np.fill_diagonal(linked, val=False)
        if self._statuses and linked.any():
            self._findings.count(ONE_LEADER)
        for number, a in enumerate(leaders):
            for b in leaders[:number]:
                acting = max(self._acting_since[a], self._acting_since[b])
                since = max(int(links.since[links.row[a], links.row[b]]), acting)
                sound = max(since, self._sound_since[a], self._sound_since[b])
                if tick - since >= self._long_bound or tick - sound >= self._bound:
                    heard_s = (tick - since) / self._next_ticks
                    what = (
                        f"robots {b} and {a} have both acted as leader and heard each other for "
                        f"{heard_s:.1f} Next periods"
                    )
                    evidence = now.status_of(b), now.status_of(a)
                    self._findings.report_state(ONE_LEADER, tick, (a, b), what, *evidence)

    def _is_sound(self, robot: int, now: Snapshot) -> bool:
        """Whether everyone on the roster of a leader is there and linked with it."""
        members = [one for one in self._statuses[robot].members if one != robot]
        row, since = self._links.row, self._links.since[self._links.row[robot]]
        return all(one in now.present and since[row[one]] <= now.tick for one in members)

    def _judge_none(self, now: Snapshot, leaders: list[int]) -> None:
        """A group out of everyone's reach, all linked with each other, is not without a leader for B."""
        before, self._leaderless = self._leaderless, {}
        present = sorted(self._statuses)
        if not present or self._covers(leaders, present):
            return
        for group in self._links.groups(present):
            if set(group) & set(leaders) or not self._links.are_linked_since(group, now.tick):
                continue
            key, strangers = self._named(group, now), self._strangers(group)
            bound = self._bound_with(strangers) if strangers else self._bound
            wait = self._leaderless[key] = before.get(key, _Wait(now.tick, now.tick + bound))
            if now.tick >= wait.deadline:
                what = f"{_who(group)} without a leader since tick {wait.since}"
                evidence = [now.status_of(robot) for robot in group]
                self._findings.report_state(ONE_LEADER, now.tick, tuple(group), what, *evidence)

    def _covers(self, leaders: list[int], present: list[int]) -> bool:
        """Whether everyone is a leader or may hear one."""
        rows = [self._links.row[robot] for robot in present]
        mine = [self._links.row[robot] for robot in leaders]
        if not mine:
            return False
        out_of_reach = self._links.apart[np.ix_(rows, mine)].all(axis=1)
        return not out_of_reach.any()

    # one-team

    def _judge_groups(self, now: Snapshot) -> None:
        """A group out of everyone's reach, all linked with each other, is one team after the bound."""
        before, self._divided = self._divided, {}
        for group in self._links.groups(sorted(self._statuses)):
            if len(group) == 1:
                continue
            if self._links.are_linked_since(group, now.tick - self._long_bound):
                self._findings.count(ONE_TEAM)
            if self._is_one_team(group) or not self._links.are_linked_since(group, now.tick):
                continue
            key, bound = self._named(group, now), self._bound_with(self._strangers(group))
            wait = self._divided[key] = before.get(key, _Wait(now.tick, now.tick + bound))
            if now.tick >= wait.deadline and self._links.are_linked_since(group, wait.since):
                what = f"{_who(group)}, and have not been one team since tick {wait.since}"
                evidence = [now.status_of(robot) for robot in group]
                self._findings.report_state(ONE_TEAM, now.tick, tuple(group), what, *evidence)

    def _is_one_team(self, group: list[int]) -> bool:
        """Whether all obey one of them, which has all on its roster, and nobody else."""
        head = self._statuses[group[0]].leader
        return (
            head in group
            and all(self._statuses[robot].leader == head for robot in group)
            and tuple(group) == self._statuses[head].members
        )

    def _strangers(self, group: list[int]) -> int:
        """How many robots outside of a group its rosters name."""
        return len({one for robot in group for one in self._statuses[robot].members}.difference(group))

    def _bound_with(self, strangers: int) -> int:
        """Ticks until a group has a leader that has given up so many, each elected in turn at worst."""
        return self._long_bound + int(strangers * self._successor_patience)

    def _named(self, group: list[int], now: Snapshot) -> _Group:
        """A group of these processes: one that starts anew begins anew."""
        return tuple((robot, now.present[robot].incarnation) for robot in group)

    # re-election

    def _open_vacancies(self, now: Snapshot, truth: Truth, before: dict[int, Status]) -> None:
        for departure in truth.departures:
            leader = departure.robot
            status = before.get(leader)
            if status is None or status.leader != leader:
                continue
            rest = [
                robot
                for robot, one in before.items()
                if robot != leader and robot in now.present
                and one.leader == leader and one.mode is not Mode.JOINING
            ]  # fmt: skip
            if not rest or (self._orphans_stop and len(rest) == 1):
                continue
            named = {one for robot in rest for one in before[robot].members}
            missing = len(named - {leader, *rest})
            ticks = self._patience + 2 * self._next_ticks + missing * self._successor_patience
            says = f"robot {leader} left: {departure.why}"
            word = now.exhibit("truth", says)
            self._vacancies.append(_Vacancy(leader, rest, now.tick, now.tick + int(ticks) + 1, word))

    def _judge_vacancies(self, now: Snapshot, leaders: list[int]) -> None:
        open_still = []
        for vacancy in self._vacancies:
            rest = vacancy.rest
            if not self._links.are_linked_since(rest, vacancy.tick):
                continue
            heads = [self._statuses[robot].leader for robot in rest if robot in self._statuses]
            if any(head in leaders for head in heads):
                self._findings.count(RE_ELECTION)
            elif now.tick < vacancy.deadline:
                open_still.append(vacancy)
            else:
                self._findings.count(RE_ELECTION)
                ticks = now.tick - vacancy.tick
                what = (
                    f"{ticks} ticks after leader {vacancy.leader} left nobody leads those who obeyed it"
                )
                evidence = [vacancy.last_word, *(now.status_of(robot) for robot in rest)]
                self._findings.report(RE_ELECTION, now.tick, tuple(rest), what, *evidence)
        self._vacancies = open_still


def _who(group: list[int]) -> str:
    if len(group) == 1:
        return f"robot {group[0]} is alone"
    return f"robots {ids_in_words(group)} hear each other and nobody else"
