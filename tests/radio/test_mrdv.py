"""MRDV does what RFC 3561 says, rule by rule; section numbers are the RFC's."""

from itertools import pairwise

import pytest

from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.data_message import DataPacket
from radio_proxy.core.routing.mrdv_limits import BUFFER_MESSAGES, NET_DIAMETER
from radio_proxy.core.routing.mrdv_packets import RREP_BYTES, RREQ_BYTES, Rrep, Rreq, rerr_bytes
from radio_proxy.core.routing.mrdv_table import ACTIVE_ROUTE_NS, DELETE_PERIOD_NS, RouteTable
from tests.radio.net import HOP_NS, MS, Net, chain, receive
from tests.radio.routers import mrdv_request as request
from tests.radio.routers import mrdv_router as router

LONG = 60_000 * MS


def test_packet_sizes() -> None:
    """5.1 to 5.3, and 28 B of IP and UDP."""
    assert (RREQ_BYTES, RREP_BYTES, rerr_bytes(1), rerr_bytes(3)) == (52, 48, 40, 56)


def test_a_route_is_replaced_by_a_newer_one_or_a_shorter_one_as_new() -> None:
    """6.2 and 6.7."""
    table = RouteTable()
    assert table.update(7, 2, 3, 10, LONG, 0)
    assert not table.update(7, 3, 1, 9, LONG, 0)
    assert not table.update(7, 3, 3, 10, LONG, 0)
    assert not table.update(7, 3, 4, 10, LONG, 0)
    assert table.update(7, 4, 2, 10, LONG, 0)
    assert table.update(7, 5, 9, 11, LONG, 0)
    route = table.usable(7, 0)
    assert route is not None
    assert (route.next_hop, route.hops, route.sequence) == (5, 9, 11)


def test_a_dead_route_is_replaced_by_one_as_new() -> None:
    """6.7 case iii."""
    table = RouteTable()
    table.update(7, 2, 3, 10, LONG, 0)
    table.break_link(2, 0)
    assert not table.update(7, 3, 1, 10, LONG, 0), "the broken route is number 11 now"
    assert table.update(7, 3, 6, 11, LONG, 0)


def test_a_route_dies_after_3_s_without_use_and_is_forgotten_after_15_more() -> None:
    """ACTIVE_ROUTE_TIMEOUT and DELETE_PERIOD, section 10."""
    table = RouteTable()
    table.update(7, 2, 3, 10, ACTIVE_ROUTE_NS, 0)
    assert table.usable(7, ACTIVE_ROUTE_NS - 1) is not None
    assert table.usable(7, ACTIVE_ROUTE_NS) is None
    assert table.entry(7, ACTIVE_ROUTE_NS + DELETE_PERIOD_NS - 1) is not None
    assert table.entry(7, ACTIVE_ROUTE_NS + DELETE_PERIOD_NS) is None


def test_use_keeps_a_route_alive() -> None:
    """6.2: each time a route is used its lifetime is at least ACTIVE_ROUTE_TIMEOUT from then."""
    net = chain("mrdv", 3)
    for _ in range(10):
        net.submit(1, 3)
        net.run(2_000 * MS)
    asked = [sent for sent in net.of(Rreq) if sent.sender == 1]
    assert len(net.delivered) == 10
    assert [sent.packet.number for sent in asked if isinstance(sent.packet, Rreq)] == [1, 2]


def test_no_request_while_a_route_lives() -> None:
    net = chain("mrdv", 2)
    net.submit(1, 2)
    net.run(100 * MS)
    before = len(net.of(Rreq))
    net.submit(1, 2)
    net.submit(2, 1)
    net.run(100 * MS)
    assert len(net.delivered) == 3
    assert len(net.of(Rreq)) == before


def test_a_request_is_passed_on_once() -> None:
    """6.5: (origin, id) seen within PATH_DISCOVERY_TIME is discarded."""
    net = Net("mrdv", [1], [])
    for sender in (8, 7, 8):
        receive(net, 1, request(5), sender, 0)
    net.run(LONG)
    assert len(net.of(Rreq)) == 1


def test_a_request_leaves_a_way_back() -> None:
    """6.5: reverse routes to the origin and to the previous hop."""
    net = Net("mrdv", [1], [])
    receive(net, 1, request(5), 8, 0)
    back, neighbour = router(net, 1).table.usable(9, 0), router(net, 1).table.usable(8, 0)
    assert back is not None
    assert (back.next_hop, back.hops, back.sequence) == (8, 2, 5)
    assert neighbour is not None
    assert (neighbour.next_hop, neighbour.hops, neighbour.sequence_known) == (8, 1, False)


def test_a_request_loses_a_hop_of_its_ttl() -> None:
    """6.5: TTL 1 goes no further, hop count grows."""
    net = Net("mrdv", [1], [])
    receive(net, 1, request(5, ttl=1), 8, 0)
    receive(net, 1, request(5, number=2, ttl=2), 8, 0)
    net.run(LONG)
    (onward,) = [sent.packet for sent in net.of(Rreq)]
    assert isinstance(onward, Rreq)
    assert (onward.number, onward.ttl, onward.hops) == (2, 1, 2)


@pytest.mark.parametrize(
    ("asked", "known", "answers"),
    [(None, 10, True), (10, 10, True), (9, 10, True), (11, 10, False), (2**32 - 1, 3, True)],
)
def test_only_a_route_fresh_enough_answers(asked: int | None, known: int, answers: bool) -> None:
    """6.6: the sequence number in the table is at least the one asked for."""
    net = Net("mrdv", [1], [])
    router(net, 1).table.update(5, 3, 2, known, LONG, 0)
    receive(net, 1, request(5, sequence=asked), 8, 0)
    net.run(LONG)
    replies = [sent for sent in net.of(Rrep) if sent.target == 8]
    assert bool(replies) == answers
    assert bool(net.of(Rreq)) != answers


def test_a_request_over_a_weak_link_waits_for_a_copy_over_a_better_one() -> None:
    """6.5 takes the first that comes; here 7 passes it on a little later than the origin is heard."""
    for better, next_hop, hops in ((True, 7, 2), (False, 9, 1)):
        net = Net("mrdv", [1], [])
        router(net, 1).on_heard(9, 2.0, 0)
        router(net, 1).on_packet(request(5, hops=0), 9, 0)
        net.run(15 * MS)
        if better:
            receive(net, 1, request(5), 7, net.now)
        net.run(15 * MS)
        back = router(net, 1).table.usable(9, net.now)
        assert back is not None
        assert (back.next_hop, back.hops) == (next_hop, hops)


def test_a_weak_link_does_not_replace_a_route_over_relays() -> None:
    """6.2, as far as a broadcast that was heard by chance would do so."""
    for margin_db, next_hop in ((2.0, 3), (20.0, 8)):
        net = Net("mrdv", [1], [])
        router(net, 1).table.update(8, 3, 2, 10, LONG, 0)
        router(net, 1).on_heard(8, margin_db, 0)
        router(net, 1).on_packet(request(5), 8, 0)
        net.run(25 * MS)
        route = router(net, 1).table.usable(8, net.now)
        assert route is not None
        assert route.next_hop == next_hop


def test_destination_only_is_heeded() -> None:
    """6.3, flag D."""
    net = Net("mrdv", [1], [])
    router(net, 1).table.update(5, 3, 2, 10, LONG, 0)
    receive(net, 1, request(5, destination_only=True), 8, 0)
    net.run(LONG)
    assert not net.of(Rrep)


def test_who_answers_for_another_tells_it_of_the_origin() -> None:
    """6.6.3: a gratuitous reply towards the destination."""
    net = Net("mrdv", [1], [])
    router(net, 1).table.update(5, 3, 2, 10, LONG, 0)
    receive(net, 1, request(5), 8, 0)
    (gratuitous,) = [sent.packet for sent in net.of(Rrep) if sent.target == 3]
    assert isinstance(gratuitous, Rrep)
    assert (gratuitous.origin, gratuitous.destination, gratuitous.sequence) == (5, 9, 5)


def test_a_destination_answers_with_a_number_as_new_as_asked() -> None:
    """6.6.1."""
    net = Net("mrdv", [1], [])
    receive(net, 1, request(1, sequence=40), 8, 0)
    (reply,) = [sent.packet for sent in net.of(Rrep)]
    assert isinstance(reply, Rrep)
    assert (reply.sequence, reply.hops, reply.lifetime) == (40, 0, 6_000 * MS)


def test_a_request_learns_a_newer_number_on_its_way() -> None:
    """6.5: the forwarder puts in the greater of both numbers."""
    net = Net("mrdv", [1], [])
    router(net, 1).table.update(5, 3, 2, 10, LONG, 0)
    router(net, 1).table.break_link(3, 0)
    receive(net, 1, request(5, sequence=7), 8, 0)
    net.run(100 * MS)
    (onward,) = [sent.packet for sent in net.of(Rreq)]
    assert isinstance(onward, Rreq)
    assert onward.sequence == 11


def test_the_ring_grows_and_then_the_whole_net_is_asked() -> None:
    """6.4 and section 10: TTL 1, 3, 5, 7, then NET_DIAMETER three times with doubled timeout."""
    net = Net("mrdv", [1], [])
    net.submit(1, 2)
    net.run(LONG)
    asked = [s.packet.ttl for s in net.of(Rreq) if isinstance(s.packet, Rreq)]
    assert asked == [1, 3, 5, 7, NET_DIAMETER, NET_DIAMETER, NET_DIAMETER]
    waits = [(b.time_ns - a.time_ns) // MS for a, b in pairwise(net.of(Rreq))]
    expected = (240, 400, 560, 720, 2800, 5600)
    assert all(timeout <= wait < timeout + 10 for wait, timeout in zip(waits, expected, strict=True))
    assert any((b.time_ns - a.time_ns) % MS for a, b in pairwise(net.of(Rreq))), "jittered"


def test_a_known_distance_widens_the_first_ring() -> None:
    """6.4: TTL starts at the last hop count + TTL_INCREMENT."""
    net = Net("mrdv", [1], [])
    router(net, 1).table.update(2, 3, 4, 10, LONG, 0)
    router(net, 1).table.break_link(3, 0)
    net.submit(1, 2)
    (first, *_) = net.of(Rreq)
    assert isinstance(first.packet, Rreq)
    assert (first.packet.ttl, first.packet.sequence) == (6, 11)


def test_messages_wait_for_the_route_and_keep_their_order() -> None:
    """6.3: buffering during discovery."""
    net = chain("mrdv", 3)
    offered = [net.submit(1, 3) for _ in range(5)]
    net.run(1_000 * MS)
    assert [data.message for _, data in net.delivered] == offered
    assert all(message.discovery_time > 0 for message in offered)


def test_the_buffer_is_bounded_and_drops_the_newest() -> None:
    net = Net("mrdv", [1], [])
    offered = [net.submit(1, 2) for _ in range(BUFFER_MESSAGES + 2)]
    assert net.lost == [(message, DeliveryStatus.QUEUE_FULL) for message in offered[-2:]]


def test_a_partition_ends_in_no_route() -> None:
    """6.3: after RREQ_RETRIES the messages are dropped: at 21.52 s with the timers of section 10.

    The jitter of six repetitions comes on top.
    """
    net = Net("mrdv", [1, 2], [])
    message = net.submit(1, 2)
    net.run(21_519 * MS)
    assert not net.lost
    net.run(61 * MS)
    assert net.lost == [(message, DeliveryStatus.NO_ROUTE)]


def test_no_more_than_ten_requests_a_second() -> None:
    """6.3: RREQ_RATELIMIT."""
    net = Net("mrdv", [1], [])
    for destination in range(2, 40):
        net.submit(1, destination)
    net.run(2_999 * MS)
    times = [sent.time_ns for sent in net.of(Rreq)]
    assert len(times) == 30
    assert all(later - earlier >= 1_000 * MS for earlier, later in zip(times, times[10:], strict=False))


def test_a_moving_robot_hardly_passes_requests_on() -> None:
    """Thesis 3.7.2: (v, gamma) = (3, 10) -> 1.69e-5; the flag for normal discovery switches it off."""
    net = Net("mrdv", [1], [])
    net.speed, net.remaining = 3.0, 100.0
    receive(net, 1, request(5), 8, 0)
    receive(net, 1, request(5, number=2, normal=True), 8, 0)
    net.run(LONG)
    assert [s.packet.number for s in net.of(Rreq) if isinstance(s.packet, Rreq)] == [2]


def test_origin_and_target_are_exempt_from_the_probability() -> None:
    net = chain("mrdv", 2)
    net.speed, net.remaining = 3.0, 100.0
    net.submit(1, 2)
    net.run(100 * MS)
    assert len(net.delivered) == 1


def test_the_normal_discovery_delivers_when_nobody_passes_on() -> None:
    """Thesis 3.7.2: the fallback; here after the rings, at 1.92 s."""
    net = chain("mrdv", 4)
    net.speed, net.remaining = 3.0, 200.0
    message = net.submit(1, 4)
    net.run(LONG)
    assert [data.path for _, data in net.delivered] == [(1, 2, 3, 4)]
    assert 1_920 * MS < message.discovery_time < 2_100 * MS


def test_hops_cost_what_they_should() -> None:
    net = chain("mrdv", 4)
    net.submit(1, 4)
    net.run(2_000 * MS)
    net.sent.clear()
    start = net.now
    net.submit(1, 4)
    net.run(100 * MS)
    assert net.delivered[-1][0] - start == 3 * HOP_NS
    assert all(isinstance(sent.packet, DataPacket) and sent.size_bytes == 800 for sent in net.sent)


def test_after_a_restart_only_destinations_answer() -> None:
    """6.13: stale routes of others, which may lead back here, are not taken for DELETE_PERIOD."""
    net = chain("mrdv", 3)
    net.stop(2)
    net.start(2, 1)
    net.submit(2, 3)
    net.run(20_000 * MS)
    net.links.clear()
    net.submit(2, 3)
    net.run(100 * MS)
    flags = [s.packet.destination_only for s in net.of(Rreq) if isinstance(s.packet, Rreq)]
    assert flags[0] is True
    assert flags[-1] is False
