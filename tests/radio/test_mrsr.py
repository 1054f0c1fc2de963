"""MRSR does what RFC 4728 says, rule by rule; section numbers are the RFC's."""

from itertools import pairwise

import pytest

from onehop.contracts.messages import BROADCAST, DeliveryStatus
from radio_proxy.core.data_message import DataPacket
from radio_proxy.core.routing.links import REPEATED_EXCHANGES
from radio_proxy.core.routing.mrsr import MAX_SALVAGE, SEND_BUFFER
from radio_proxy.core.routing.mrsr_cache import CACHE_TIMEOUT_NS, PATHS_PER_DESTINATION, RouteCache
from radio_proxy.core.routing.mrsr_packets import Rerr, Rrep, Rreq, source_route_bytes, without_loops
from tests.radio.net import HOP_NS, MS, Net, chain, lose_link, receive
from tests.radio.routers import mrsr_data as data
from tests.radio.routers import mrsr_router as router

LONG = 60_000 * MS


def request(target: int, *route: int, number: int = 1, ttl: int = 5, normal: bool = False) -> Rreq:
    return Rreq(number, target, route, ttl, normal)


def test_packet_sizes() -> None:
    """6.1 to 6.7, and 20 B of IP: RREQ 8 + 4n, RREP 3 + 4n, RERR 16 B, fixed header 4 B."""
    assert request(5, 1).size_bytes == 20 + 4 + 8
    assert request(5, 1, 2, 3).size_bytes == 20 + 4 + 8 + 4 * 2
    assert Rrep(1, (1, 2, 3), (3, 2, 1)).size_bytes == 20 + 16 + 4 + 3 + 4 * 2
    assert Rerr(2, 3, (2, 1)).size_bytes == 20 + 4 + 12 + 16


def test_the_header_grows_by_four_bytes_a_hop() -> None:
    """6.7."""
    sizes = [source_route_bytes(tuple(range(n))) for n in (2, 3, 4, 5)]
    assert [b - a for a, b in pairwise(sizes)] == [4, 4, 4]
    net = chain("mrsr", 4)
    net.submit(1, 4)
    net.run(2_000 * MS)
    assert {sent.size_bytes for sent in net.of(DataPacket)} == {800 + source_route_bytes((1, 2, 3, 4))}


def test_a_request_that_lists_this_robot_is_discarded() -> None:
    """8.2.2: own address in the route."""
    net = Net("mrsr", [1], [])
    receive(net, 1, request(5, 9, 1, 8), 8, 0)
    net.run(LONG)
    assert not net.sent


def test_a_request_is_passed_on_once_with_this_robot_in_its_route() -> None:
    """8.2.2: (identification, target) seen before."""
    net = Net("mrsr", [1], [])
    receive(net, 1, request(5, 9, 8), 8, 0)
    receive(net, 1, request(5, 9, 7), 7, 0)
    net.run(LONG)
    assert [sent.packet for sent in net.of(Rreq)] == [request(5, 9, 8, 1, ttl=4)]


def test_only_so_many_requests_of_a_robot_are_remembered() -> None:
    """4.3: RequestTableIds = 16."""
    net = Net("mrsr", [1], [])
    for number in range(1, 18):
        receive(net, 1, request(5, 9, number=number, ttl=2), 9, 0)
    receive(net, 1, request(5, 9, number=17, ttl=2), 9, 0)
    receive(net, 1, request(5, 9, number=1, ttl=2), 9, 0)
    net.run(LONG)
    assert len(net.of(Rreq)) == 18


def test_a_nonpropagating_request_goes_no_further() -> None:
    """3.3.3: hop limit 1."""
    net = Net("mrsr", [1], [])
    receive(net, 1, request(5, 9, ttl=1), 9, 0)
    net.run(LONG)
    assert not net.of(Rreq)


def test_the_target_answers_along_the_reversed_route() -> None:
    """8.2.4, with a jitter of at most 10 ms."""
    net = Net("mrsr", [1], [])
    receive(net, 1, request(1, 9, 8), 8, 0)
    net.run(11 * MS)
    (reply,) = net.first_of(Rrep)
    assert (reply.packet, reply.target) == (Rrep(1, (9, 8, 1), (1, 8, 9)), 8)


def test_copies_that_came_farther_are_not_answered() -> None:
    net = Net("mrsr", [1], [])
    for route in ((9, 8), (9, 7), (9, 6, 5)):
        receive(net, 1, request(1, *route), route[-1], 0)
    net.run(LONG)
    assert [sent.target for sent in net.first_of(Rrep)] in ([8, 7], [7, 8])


def test_a_cached_route_answers_unless_it_would_loop() -> None:
    """8.2.3: no robot twice in the route so far and the cached one together."""
    net = Net("mrsr", [1], [])
    router(net, 1).cache.add((1, 8, 5), 0)
    receive(net, 1, request(5, 9, 8), 8, 0)
    net.run(100 * MS)
    assert not net.of(Rrep)
    assert len(net.of(Rreq)) == 1
    receive(net, 1, request(5, 9, 7, number=2), 7, net.now)
    net.run(100 * MS)
    (reply,) = net.first_of(Rrep)
    assert reply.packet == Rrep(2, (9, 7, 1, 8, 5), (1, 7, 9))
    assert len(net.of(Rreq)) == 1, "who answers does not pass on"


def test_a_reply_that_is_needless_is_not_sent() -> None:
    """8.2.5: another robot's reply, as short, was heard while this one waited."""
    net = Net("mrsr", [1], [])
    router(net, 1).cache.add((1, 5), 0)
    receive(net, 1, request(5, 9), 9, 0)
    router(net, 1).on_overheard(Rrep(1, (9, 2, 4, 5), (2, 9)), 2, 0)
    receive(net, 1, request(5, 9, number=2), 9, 0)
    router(net, 1).on_overheard(Rrep(2, (9, 2, 5), (2, 9)), 2, 0)
    net.run(LONG)
    assert [sent.packet for sent in net.first_of(Rrep)] == [Rrep(1, (9, 1, 5), (1, 9))]


def test_the_timeout_of_a_request_counts_from_when_it_is_sent() -> None:
    """3.3.3: one that waited in the queue is no reason to ask the whole network."""
    net = Net("mrsr", [1], [])
    net.hold_ns = 40 * MS
    net.submit(1, 2)
    net.run(70 * MS)
    assert [sent.time_ns for sent in net.of(Rreq)] == [0]
    net.run(1 * MS)
    assert [sent.time_ns for sent in net.of(Rreq)] == [0, 71 * MS]


def test_requests_come_ever_more_rarely() -> None:
    """Section 9: 30 ms for the neighbours, then 0.5 s doubling to 10 s; given up at 30 s."""
    net = Net("mrsr", [1], [])
    message = net.submit(1, 2)
    net.run(LONG)
    asked = [(s.packet.ttl, s.packet.normal) for s in net.of(Rreq) if isinstance(s.packet, Rreq)]
    assert asked == [(1, False), (255, False), *[(255, True)] * 6]
    waits = [b.time_ns - a.time_ns - HOP_NS for a, b in pairwise(net.of(Rreq))]
    assert [wait // MS for wait in waits] == [30, 500, 1000, 2000, 4000, 8000, 10000]
    assert net.lost == [(message, DeliveryStatus.NO_ROUTE)]


def test_the_send_buffer_is_bounded_and_drops_the_newest() -> None:
    """4.2 leaves the policy open beyond 'SHOULD'; 64 messages, 30 s."""
    net = Net("mrsr", [1], [])
    offered = [net.submit(1, 2) for _ in range(SEND_BUFFER + 1)]
    assert net.lost == [(offered[-1], DeliveryStatus.QUEUE_FULL)]
    net.run(30_000 * MS)
    assert len(net.lost) == SEND_BUFFER + 1


def test_messages_wait_for_the_route_and_keep_their_order() -> None:
    """4.2 and 8.2.6: one reply sends everything that waits for its target."""
    net = chain("mrsr", 3)
    offered = [net.submit(1, 3) for _ in range(5)]
    net.run(1_000 * MS)
    assert [arrived.message for _, arrived in net.delivered] == offered
    assert all(0 < message.discovery_time < 100 * MS for message in offered)


def test_no_request_while_a_route_lives() -> None:
    net = chain("mrsr", 3)
    net.submit(1, 3)
    net.run(1_000 * MS)
    before = len(net.of(Rreq))
    net.run(200_000 * MS)
    net.submit(1, 3)
    net.submit(3, 1)
    net.run(1_000 * MS)
    assert len(net.delivered) == 3
    assert len(net.of(Rreq)) == before


def test_a_path_is_forgotten_after_300_s() -> None:
    """RouteCacheTimeout, section 9."""
    cache = RouteCache(1)
    cache.add((1, 2, 3), 0)
    assert cache.find(3, CACHE_TIMEOUT_NS - 1) == (1, 2, 3)
    assert cache.find(3, CACHE_TIMEOUT_NS) is None


def test_the_cache_knows_everyone_on_a_path_and_prefers_short_ones() -> None:
    cache = RouteCache(1)
    cache.add((1, 2, 3, 4), 0)
    cache.add((1, 5, 4), 1)
    assert cache.find(3, 1) == (1, 2, 3)
    assert cache.find(4, 1) == (1, 5, 4)


def test_the_cache_refuses_loops_and_is_bounded() -> None:
    cache = RouteCache(1)
    cache.add((1, 2, 3, 2, 4), 0)
    cache.add((7, 2, 4), 0)
    assert cache.paths() == ()
    for via in range(2, 20):
        cache.add((1, via, 99), via)
    assert [path for path in cache.paths() if path[-1] == 99] == [
        (1, via, 99) for via in (19, 18, 17, 16)
    ]
    assert PATHS_PER_DESTINATION == 4


def test_a_broken_link_is_forgotten_everywhere() -> None:
    """8.3.5: in either direction, but what lies before it stays."""
    cache = RouteCache(1)
    for path in ((1, 2, 3, 4), (1, 5, 3, 2), (1, 6, 4)):
        cache.add(path, 0)
    cache.remove_link(2, 3)
    assert cache.paths() == ((1, 2), (1, 5, 3), (1, 6, 4), (1, 5), (1, 6))


def test_a_broken_link_is_reported_to_the_source() -> None:
    """8.3.4; every robot that passes the error on forgets the link as well (8.3.5)."""
    net = chain("mrsr", 4)
    net.submit(1, 4)
    net.run(2_000 * MS)
    net.links.remove(frozenset((3, 4)))
    net.submit(1, 4)
    net.run(20 * MS)
    assert [(s.sender, s.target, s.packet) for s in net.of(Rerr)] == [
        (3, 2, Rerr(3, 4, (3, 2, 1))),
        (2, 1, Rerr(3, 4, (3, 2, 1))),
    ]
    assert all(router(net, robot).cache.find(4, net.now) is None for robot in (1, 2, 3))


def test_one_exchange_that_is_given_up_breaks_no_link() -> None:
    """4.5 and 8.3: what a link gives up is handed to it again; the source hears nothing of it."""
    net = chain("mrsr", 3)
    net.submit(1, 3)
    net.run(2_000 * MS)
    net.sent.clear()
    failing = iter([True] * REPEATED_EXCHANGES)
    net.loss = lambda sender, receiver: (sender, receiver) == (2, 3) and next(failing, False)
    net.submit(1, 3)
    net.run(20 * MS)
    assert not net.of(Rerr)
    assert not net.of(Rreq)
    (_, arrived) = net.delivered[-1]
    assert (arrived.path, arrived.attempts) == ((1, 2, 3), (1, 7 * REPEATED_EXCHANGES + 1))


def test_a_link_that_gives_everything_up_is_broken() -> None:
    """4.5 and 8.3.4: after so many exchanges in a row its source is told."""
    net = chain("mrsr", 3)
    net.submit(1, 3)
    net.run(2_000 * MS)
    net.links.remove(frozenset((2, 3)))
    net.sent.clear()
    net.submit(1, 3)
    net.run(20 * MS)
    assert len([s for s in net.of(DataPacket) if s.sender == 2]) == REPEATED_EXCHANGES + 1
    assert [s.packet for s in net.of(Rerr)] == [Rerr(2, 3, (2, 1))]


def test_a_message_is_salvaged_over_another_cached_path() -> None:
    """8.3.6."""
    net = Net("mrsr", [1, 2, 3, 4], [(1, 2), (2, 3), (2, 4), (4, 3)])
    router(net, 1).cache.add((1, 2, 3), 0)
    router(net, 2).cache.add((2, 4, 3), 0)
    router(net, 2).cache.add((2, 3), 0)
    net.links.remove(frozenset((2, 3)))
    net.submit(1, 3)
    net.run(100 * MS)
    ((_, arrived),) = net.delivered
    assert (arrived.path, arrived.route, arrived.salvaged) == ((1, 2, 4, 3), (2, 4, 3), 1)
    assert len(net.of(Rerr)) == 1, "the source is told all the same"


def test_a_message_is_salvaged_fifteen_times_at_most() -> None:
    """MAX_SALVAGE_COUNT, section 9."""
    net = Net("mrsr", [1, 2], [(1, 2)])
    router(net, 2).cache.add((2, 4, 3), 0)
    worn = data(1, (1, 2), (1, 2, 3), salvaged=MAX_SALVAGE)
    lose_link(net, 2, 3)
    router(net, 2).on_undeliverable(worn.tried(7), 3, DeliveryStatus.BELOW_THRESHOLD, 0)
    assert net.lost == [(worn.message, DeliveryStatus.BELOW_THRESHOLD)]


def test_both_directions_of_a_route_are_learnt_from_data() -> None:
    """8.1.4: the destination answers without a discovery of its own."""
    net = chain("mrsr", 3)
    net.submit(1, 3)
    net.run(1_000 * MS)
    assert router(net, 2).cache.find(1, net.now) == (2, 1)
    assert router(net, 3).cache.find(1, net.now) == (3, 2, 1)


def test_a_neighbour_that_does_not_take_replies_is_not_heard_for_a_while() -> None:
    """8.2.6 and 4.6: the blacklist."""
    net = Net("mrsr", [1], [])
    receive(net, 1, request(1, 8), 8, 0)
    net.run(100 * MS)
    receive(net, 1, request(5, 8, number=2), 8, net.now)
    net.run(5_100 * MS)
    assert not net.of(Rreq)
    receive(net, 1, request(5, 8, number=3), 8, net.now)
    net.run(100 * MS)
    assert len(net.of(Rreq)) == 1


def test_the_normal_discovery_delivers_when_nobody_passes_on() -> None:
    """Thesis 3.7.2: p_r is about 0; the request at 530 ms is a normal one."""
    net = chain("mrsr", 4)
    net.speed, net.remaining = 3.0, 200.0
    message = net.submit(1, 4)
    net.run(LONG)
    assert [arrived.path for _, arrived in net.delivered] == [(1, 2, 3, 4)]
    assert 530 * MS < message.discovery_time < 650 * MS


def test_origin_and_target_are_exempt_from_the_probability() -> None:
    net = chain("mrsr", 2)
    net.speed, net.remaining = 3.0, 100.0
    net.submit(1, 2)
    net.run(30 * MS)
    assert len(net.delivered) == 1


def test_the_source_discovers_once_more_when_its_link_breaks() -> None:
    net = Net("mrsr", [1, 2, 3], [(1, 3), (1, 2), (2, 3)])
    net.submit(1, 3)
    net.run(100 * MS)
    net.links.remove(frozenset((1, 3)))
    net.submit(1, 3)
    net.run(2_000 * MS)
    assert [arrived.path for _, arrived in net.delivered] == [(1, 3), (1, 2, 3)]


@pytest.mark.parametrize(
    ("path", "straight"),
    [((1, 2, 3), (1, 2, 3)), ((1, 2, 3, 2, 4), (1, 2, 4)), ((1, 2, 1, 3), (1, 3)), ((1,), (1,))],
)
def test_detours_are_cut_out_of_a_path(path: tuple[int, ...], straight: tuple[int, ...]) -> None:
    assert without_loops(path) == straight


def test_a_request_is_a_broadcast_and_a_reply_is_not() -> None:
    net = chain("mrsr", 3)
    net.submit(1, 3)
    net.run(1_000 * MS)
    assert {sent.target for sent in net.of(Rreq)} == {BROADCAST}
    assert BROADCAST not in {sent.target for sent in net.of(Rrep)}
