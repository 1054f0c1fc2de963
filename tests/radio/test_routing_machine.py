"""Both routing protocols on random nets that change, lose packets and restart robots."""

import random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    rule,
    run_state_machine_as_test,
)

from radio_proxy.core.routing.mrdv import MrdvRouter
from radio_proxy.core.routing.mrdv_limits import BUFFER_MESSAGES
from radio_proxy.core.routing.mrdv_packets import Rreq
from radio_proxy.core.routing.mrsr import REQUEST_IDS, SEND_BUFFER, MrsrRouter
from radio_proxy.core.routing.mrsr_cache import PATHS_PER_DESTINATION
from tests.radio.net import MS, Net

ROBOTS = 6
robots = st.integers(1, ROBOTS)
PAIRS = [(a, b) for a in range(1, ROBOTS + 1) for b in range(a + 1, ROBOTS + 1)]
QUIET_NS = 90_000 * MS
"""Longer than any discovery, timer or buffer lasts."""


class RoutingMachine(RuleBasedStateMachine):
    """Robots submit messages while links come and go; what must hold is in the invariants."""

    protocol = ""

    @initialize(links=st.sets(st.sampled_from(PAIRS)), seed=st.integers(0, 1000))
    def begin(self, links: set[tuple[int, int]], seed: int) -> None:
        self.net = Net(self.protocol, range(1, ROBOTS + 1), sorted(links))
        self.net.dice = random.Random(seed)
        self.incarnations = dict.fromkeys(range(1, ROBOTS + 1), 0)
        self.offered = 0
        self.net.watch = self.routes_are_free_of_loops

    def routes_are_free_of_loops(self) -> None:
        """Called after every single event."""
        raise NotImplementedError

    @rule(
        source=robots,
        destination=robots,
        count=st.integers(1, 4),
        lifetime=st.sampled_from([0, 0, 1, 50, 2000]),
    )
    def submit(self, source: int, destination: int, count: int, lifetime: int = 0) -> None:
        if source in self.net.nics and source != destination:
            for _ in range(count):
                self.net.submit(source, destination, lifetime * MS)
                self.offered += 1

    @rule(seed=st.integers(0, 1000))
    def everybody_talks(self, seed: int) -> None:
        dice = random.Random(seed)
        for source in sorted(self.net.nics):
            self.submit(source, dice.randint(1, ROBOTS), 1)

    @rule(duration=st.sampled_from([1, 3, 8, 40, 300, 300, 2500, 16000]))
    def wait(self, duration: int) -> None:
        self.net.run(duration * MS)

    @rule(pair=st.sampled_from(PAIRS))
    def change_link(self, pair: tuple[int, int]) -> None:
        self.net.links ^= {frozenset(pair)}

    @rule(links=st.sets(st.sampled_from(PAIRS)))
    def move_everybody(self, links: set[tuple[int, int]]) -> None:
        self.net.links = {frozenset(link) for link in links}

    @rule(share=st.sampled_from([0.0, 0.0, 0.1, 0.5]))
    def lose(self, share: float) -> None:
        dice = self.net.dice
        self.net.loss = lambda _sender, _receiver: dice.random() < share

    @rule(speed=st.sampled_from([0.0, 1.0, 2.0, 3.0]), remaining=st.sampled_from([0.0, 20.0, 100.0]))
    def drive(self, speed: float, remaining: float) -> None:
        self.net.speed, self.net.remaining = speed, remaining

    @rule(robot=robots)
    def stop_or_restart(self, robot: int) -> None:
        if robot in self.net.nics:
            self.net.stop(robot)
        else:
            self.incarnations[robot] += 1
            self.net.start(robot, self.incarnations[robot])

    @invariant()
    def nothing_is_delivered_that_was_not_sent(self) -> None:
        for _, data in self.net.delivered:
            assert data.message in self.net.messages
            assert (data.path[0], data.path[-1]) == (data.message.source, data.message.destination)
            assert len(data.attempts) == len(data.path) - 1

    @invariant()
    def no_message_is_both_lost_and_delivered(self) -> None:
        lost = [message.number for message, _ in self.net.lost]
        arrived = {data.message.number for _, data in self.net.delivered}
        assert len(lost) == len(set(lost))
        assert not arrived & set(lost)

    @invariant()
    def nothing_waits_for_a_route_beyond_its_lifetime(self) -> None:
        for message in self.net.messages:
            waits = message.discovering_since >= 0 and not message.has_verdict
            assert not waits or message.expires >= self.net.now

    @invariant()
    def nobody_asks_more_than_ten_times_a_second(self) -> None:
        times: dict[int, list[int]] = {}
        for sent in self.net.of(Rreq):
            if isinstance(sent.packet, Rreq) and sent.packet.origin == sent.sender:
                times.setdefault(sent.sender, []).append(sent.time_ns)
        for robot, asked in times.items():
            if self.incarnations[robot] == 0:
                assert all(b - a >= 1000 * MS for a, b in zip(asked, asked[10:], strict=False))

    def teardown(self) -> None:
        self.net.run(QUIET_NS)
        assert len(self.net.messages) == self.offered
        assert all(message.has_verdict for message in self.net.messages), "no message may hang"
        before = len(self.net.sent)
        self.net.run(QUIET_NS)
        assert len(self.net.sent) == before, "an idle net is silent"


class MrdvMachine(RoutingMachine):
    """AODV: following next hops never leads back, whatever the destination."""

    protocol = "mrdv"

    def routes_are_free_of_loops(self) -> None:
        for destination in range(1, ROBOTS + 1):
            for start in sorted(self.net.nics):
                visited = [start]
                while (here := visited[-1]) in self.net.nics and here != destination:
                    router = self.net.nics[here].router
                    assert isinstance(router, MrdvRouter)
                    route = router.table.usable(destination, self.net.now)
                    if route is None:
                        break
                    assert route.next_hop not in visited, (destination, [*visited, route.next_hop])
                    visited.append(route.next_hop)

    @invariant()
    def tables_and_buffers_are_bounded(self) -> None:
        for nic in self.net.nics.values():
            assert isinstance(nic.router, MrdvRouter)
            assert len(nic.router.table.destinations()) <= ROBOTS
            assert 0 <= nic.router.buffered <= BUFFER_MESSAGES


class MrsrMachine(RoutingMachine):
    """DSR: whatever is cached begins here, visits nobody twice, and stays bounded."""

    protocol = "mrsr"

    def routes_are_free_of_loops(self) -> None:
        for robot, nic in self.net.nics.items():
            assert isinstance(nic.router, MrsrRouter)
            for path in nic.router.cache.paths():
                assert path[0] == robot
                assert len(set(path)) == len(path) > 1

    @invariant()
    def tables_and_buffers_are_bounded(self) -> None:
        for nic in self.net.nics.values():
            assert isinstance(nic.router, MrsrRouter)
            assert len(nic.router.cache.paths()) <= PATHS_PER_DESTINATION * (ROBOTS - 1)
            assert 0 <= nic.router.buffered <= SEND_BUFFER
            assert nic.router.remembered_requests() <= REQUEST_IDS * ROBOTS


def explore(machine: type[RoutingMachine], examples: int) -> None:
    run_state_machine_as_test(
        machine,
        settings=settings(
            max_examples=examples,
            stateful_step_count=30,
            deadline=None,
            derandomize=True,
            suppress_health_check=list(HealthCheck),
        ),
    )


@pytest.mark.parametrize("machine", [MrdvMachine, MrsrMachine])
def test_routing_holds_on_changing_nets(machine: type[RoutingMachine]) -> None:
    explore(machine, 15)


@pytest.mark.parametrize("protocol", ["mrdv", "mrsr"])
@given(
    parents=st.lists(st.integers(0, 100), min_size=1, max_size=ROBOTS - 1),
    extra=st.sets(st.sampled_from(PAIRS), max_size=3),
    flows=st.lists(st.tuples(robots, robots), min_size=1, max_size=12),
)
def test_everything_arrives_on_a_net_that_holds_together(
    protocol: str, parents: list[int], extra: set[tuple[int, int]], flows: list[tuple[int, int]]
) -> None:
    """A random connected net without losses, and messages from anyone to anyone."""
    count = len(parents) + 1
    tree = [(1 + parent % child, child + 1) for child, parent in enumerate(parents, 1)]
    net = Net(protocol, range(1, count + 1), [*tree, *(pair for pair in extra if max(pair) <= count)])
    for source, destination in flows:
        if source != destination and max(source, destination) <= count:
            net.submit(source, destination)
            net.submit(source, destination)
    net.run(QUIET_NS)
    assert not net.lost
    assert all(message.has_verdict for message in net.messages)
    assert all(message.discovery_time < 2_000 * MS for message in net.messages)


@pytest.mark.slow
@pytest.mark.parametrize("machine", [MrdvMachine, MrsrMachine])
def test_routing_holds_on_many_changing_nets(machine: type[RoutingMachine]) -> None:
    explore(machine, 300)
