"""The team under an adversarial network, as a Hypothesis state machine (docs/modes.md).

The adversary drops, delays, duplicates, reorders, cuts and heals, kills, restarts and pauses, and puts
in payloads that no robot sent. After every step the invariants of a tick hold; whenever the network has
been quiet for the bound, exactly one robot acts as leader of everyone. ONEHOP_SEQUENCES sets the number
of sequences (default: few, for CI). Large numbers are run in chunks of 1000 with seeds of their own
(make campaign): pytest says nothing before the one test ends, so a run that is cut short leaves nothing.
"""

import os

import hypothesis.strategies as st
from hypothesis import HealthCheck, settings
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from onehop.contracts.sections import TeamSection
from tests.agent.team.team_net import PERIOD_MS, TeamNet

SEQUENCES = int(os.environ.get("ONEHOP_SEQUENCES", "40"))
NEXT_PERIOD = 2.0
TEAM = TeamSection()
BOUND = 4 * NEXT_PERIOD + (TEAM.lost_after + 1) * NEXT_PERIOD
"""Quiet time after which one team is asked for [s]: B = 4 Next periods, and the time in which the dead
that were taken over from the other team's list are given up again (derived in docs/modes.md)."""

robots = st.integers(1, 6)


class AdversarialTeam(RuleBasedStateMachine):
    """Six robots and an adversary."""

    @initialize(size=st.sampled_from([2, 3, 4, 6, 6, 6]), settle=st.sampled_from([0, 20]))
    def begin(self, size, settle):
        self.net = TeamNet(TeamSection(size=size))
        self.net.run(settle)

    @rule(ticks=st.integers(1, 24))
    def time_passes(self, ticks):
        for _ in range(ticks):
            self.net.step()
            self.net.check()

    @rule(robot=robots)
    def kill(self, robot):
        if robot in self.net.members and len(self.net.members) > 1:
            self.net.kill(robot)

    @rule(robot=robots)
    def restart(self, robot):
        if robot in self.net.graveyard:
            self.net.restart(robot)

    @rule(robot=robots, ticks=st.integers(1, 60))
    def pause(self, robot, ticks):
        self.net.paused[robot] = self.net.tick + ticks

    @rule(side=st.sets(robots, min_size=1, max_size=3))
    def cut(self, side):
        self.net.cut(tuple(sorted(side & set(self.net.ids))))

    @rule(a=robots, b=robots)
    def lose_one_way(self, a, b):
        self.net.losing.add((a, b))

    @rule()
    def heal(self):
        self.net.heal()

    @rule(data=st.data())
    def drop(self, data):
        if self.net.frames:
            self.net.frames.pop(data.draw(st.integers(0, len(self.net.frames) - 1)))

    @rule(data=st.data(), ticks=st.integers(1, 40))
    def hold_back(self, data, ticks):
        if self.net.frames:
            frame = self.net.frames[data.draw(st.integers(0, len(self.net.frames) - 1))]
            frame.due = self.net.tick + ticks

    @rule(data=st.data(), ticks=st.integers(0, 40))
    def duplicate(self, data, ticks):
        if self.net.frames:
            frame = self.net.frames[data.draw(st.integers(0, len(self.net.frames) - 1))]
            self.net.repeat(frame, ticks)

    @rule(source=st.integers(0, 8), receiver=robots, payload=st.binary(max_size=60))
    def put_in(self, source, receiver, payload):
        self.net.inject(source, receiver, payload)

    @rule()
    @precondition(lambda self: hasattr(self, "net"))
    def quiet_brings_one_leader(self):
        net = self.net
        net.heal()
        net.frames.clear()
        net.paused.clear()
        for _ in range(round(BOUND * 1000 / PERIOD_MS)):
            net.step()
            net.check()
        assert len(net.leaders()) == 1, net.describe()
        assert net.agree(), net.describe()

    @invariant()
    def nothing_broke(self):
        if hasattr(self, "net"):
            self.net.check()


AdversarialTeam.TestCase.settings = settings(
    max_examples=SEQUENCES,
    stateful_step_count=30,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
TestAdversarialTeam = AdversarialTeam.TestCase
