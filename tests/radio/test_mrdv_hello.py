"""Hellos of MRDV (RFC 3561, 6.9): direct routes that are offered, and broadcasts as an option."""

from itertools import pairwise

from onehop.contracts.messages import BROADCAST, DeliveryStatus
from radio_proxy.core.routing.forwarding import BROADCAST_JITTER_NS
from radio_proxy.core.routing.mrdv_hello import OFFER_PERIOD_NS
from radio_proxy.core.routing.mrdv_packets import Hello, Rerr
from tests.radio.net import MS, Net, chain, receive
from tests.radio.routers import mrdv_router as router

SECOND = 1_000 * MS


def next_hop(net: Net, robot: int, destination: int) -> int | None:
    route = router(net, robot).table.usable(destination, net.now)
    return None if route is None else route.next_hop


def relayed(margin_db: float) -> Net:
    """1 sends to 3 over 2 while 3 comes near and is heard by 1, and 1 by 3, so well."""
    net = chain("mrdv", 3)
    net.submit(1, 3)
    net.run(SECOND)
    net.links.add(frozenset((1, 3)))
    net.margin_db = lambda _sender, _receiver: margin_db
    net.sent.clear()
    net.submit(1, 3)
    net.run(2 * BROADCAST_JITTER_NS)
    return net


def test_who_overhears_data_for_itself_offers_a_direct_route() -> None:
    """6.9 and 6.2: a route to a neighbour that is heard; both ends have it then."""
    net = relayed(20.0)
    (offer,) = net.of(Hello)
    assert (offer.sender, offer.target, offer.size_bytes) == (3, 1, 48)
    assert (next_hop(net, 1, 3), next_hop(net, 3, 1)) == (3, 1)
    net.submit(1, 3)
    net.submit(3, 1)
    net.run(20 * MS)
    assert [data.path for _, data in net.delivered] == [(1, 2, 3), (1, 2, 3), (1, 3), (3, 1)]


def test_a_weak_link_is_not_offered() -> None:
    net = relayed(3.0)
    assert not net.of(Hello)
    assert (next_hop(net, 1, 3), next_hop(net, 3, 1)) == (2, 2)


def test_an_offer_that_is_not_acknowledged_changes_nothing() -> None:
    """A link that carries one way only takes the place of no route; it is tried again after a second."""
    net = chain("mrdv", 3)
    net.submit(1, 3)
    net.run(SECOND)
    for wait_ns in (0, OFFER_PERIOD_NS - 1, 1):
        net.run(wait_ns)
        router(net, 3).on_heard(1, 20.0, net.now)
    net.run(2 * BROADCAST_JITTER_NS)
    assert len(net.of(Hello)) == 2
    assert next_hop(net, 3, 1) == 2
    net.submit(1, 3)
    net.run(10 * MS)
    assert len(net.delivered) == 2


def test_a_neighbour_that_is_reached_directly_is_offered_nothing() -> None:
    net = chain("mrdv", 2)
    for _ in range(5):
        net.submit(1, 2)
        net.run(2 * SECOND)
    assert not net.of(Hello)


def hello_net() -> Net:
    """1 - 2 - 3 with hellos every second; 1 and 3 have spoken."""
    net = chain("mrdv", 3, hello_period=SECOND)
    net.submit(1, 3)
    net.run(2 * SECOND)
    return net


def test_hellos_come_every_period_while_data_is_about() -> None:
    """6.9: only of a robot that is part of an active route."""
    net = hello_net()
    net.sent.clear()
    for _ in range(5):
        net.submit(1, 3)
        net.run(SECOND)
    for robot in (1, 2, 3):
        times = [s.time_ns for s in net.of(Hello) if s.sender == robot]
        assert len(times) == 5
        assert {b - a for a, b in pairwise(times)} == {SECOND}
    assert {s.target for s in net.of(Hello)} == {BROADCAST}
    net.run(10 * SECOND)
    net.sent.clear()
    net.run(10 * SECOND)
    assert not net.sent


def test_a_broadcast_takes_the_place_of_a_hello() -> None:
    """6.9: nothing if a broadcast was sent within the last period."""
    net = hello_net()
    net.sent.clear()
    router(net, 1).on_broadcast_sent(None, net.now)
    for _ in range(4):
        net.submit(1, 3)
        net.run(SECOND // 2)
        router(net, 1).on_broadcast_sent(None, net.now)
    assert {s.sender for s in net.of(Hello)} == {2, 3}


def test_a_neighbour_whose_hellos_stay_away_is_lost() -> None:
    """6.9: after ALLOWED_HELLO_LOSS periods without anything from it; its precursors are told."""
    net = hello_net()
    net.submit(1, 3)
    net.run(SECOND)
    net.links.remove(frozenset((2, 3)))
    for _ in range(4):
        net.run(SECOND)
        receive(net, 2, Hello(BROADCAST, 0), 1, net.now)
    assert next_hop(net, 2, 3) is None
    assert next_hop(net, 2, 1) == 1
    assert [(s.sender, s.target) for s in net.of(Rerr)][:1] == [(2, 1)]


def test_a_hello_heard_by_chance_does_not_replace_a_route_over_relays() -> None:
    for margin_db, expected in ((2.0, 2), (20.0, 1)):
        net = chain("mrdv", 3)
        net.submit(1, 3)
        net.run(SECOND)
        router(net, 3).on_heard(1, margin_db, net.now)
        router(net, 3).on_packet(Hello(BROADCAST, 0), 1, net.now)
        assert next_hop(net, 3, 1) == expected


def test_an_offer_in_vain_is_no_broken_link() -> None:
    net = chain("mrdv", 3)
    net.submit(1, 3)
    net.run(SECOND)
    router(net, 3).on_undeliverable(Hello(2, 0), 2, DeliveryStatus.BELOW_THRESHOLD, net.now)
    assert next_hop(net, 3, 1) == 2
