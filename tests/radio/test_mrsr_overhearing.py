"""What MRSR learns from what it overhears (RFC 4728, 3.3.1 and 3.4.3)."""

from radio_proxy.core.routing.mrsr_packets import Rerr, Rrep, Rreq
from tests.radio.net import MS, Net, chain
from tests.radio.routers import mrsr_data as data
from tests.radio.routers import mrsr_router as router


def test_an_overheard_reply_teaches_the_way_to_everyone_on_it() -> None:
    """3.3.1: 5 hears 2 pass on the reply of 3 to 1."""
    net = Net("mrsr", [1, 2, 3, 5], [(1, 2), (2, 3), (2, 5)])
    net.submit(1, 3)
    net.run(1_000 * MS)
    assert router(net, 5).cache.find(3, net.now) == (5, 2, 3)
    assert router(net, 5).cache.find(1, net.now) == (5, 2, 1)
    asked = len(net.of(Rreq))
    net.submit(5, 3)
    net.run(1_000 * MS)
    assert [arrived.path for _, arrived in net.delivered] == [(1, 2, 3), (5, 2, 3)]
    assert len(net.of(Rreq)) == asked


def test_an_overheard_reply_sends_what_waits_for_its_way() -> None:
    """8.2.6: a route that comes by chance ends a discovery as well."""
    net = Net("mrsr", [1, 2, 4, 9], [(1, 2), (2, 4)])
    message = net.submit(1, 4)
    router(net, 1).on_heard(2, 20.0, 0)
    router(net, 1).on_overheard(Rrep(7, (9, 2, 4), (2, 9)), 2, 0)
    net.run(5 * MS)
    assert [arrived.message for _, arrived in net.delivered] == [message]


def test_a_reply_overheard_on_a_weak_link_teaches_nothing() -> None:
    """3.3.1 leaves it open: a path over a link that carries nothing would be the shortest one."""
    net = Net("mrsr", [1], [])
    router(net, 1).on_heard(2, 1.0, 0)
    router(net, 1).on_overheard(Rrep(7, (9, 2, 4), (2, 9)), 2, 0)
    assert router(net, 1).cache.paths() == ()


def relayed(margin_db: float) -> Net:
    """1 sends to 3 over 2 while 3 comes near and is heard by 1, and 1 by 3, so well."""
    net = chain("mrsr", 3)
    net.submit(1, 3)
    net.run(2_000 * MS)
    net.links.add(frozenset((1, 3)))
    net.margin_db = lambda _sender, _receiver: margin_db
    net.sent.clear()
    net.submit(1, 3)
    net.run(20 * MS)
    return net


def test_data_overheard_early_shortens_its_route() -> None:
    """3.4.3 and 8.1.5: the route up to who was overheard, and from who overheard it."""
    net = relayed(20.0)
    (reply,) = net.of(Rrep)
    assert (reply.sender, reply.target, reply.packet) == (3, 1, Rrep(0, (1, 3), (3, 1)))
    assert router(net, 1).cache.find(3, net.now) == (1, 3)
    assert router(net, 3).cache.find(1, net.now) == (3, 1)
    net.submit(1, 3)
    net.run(20 * MS)
    assert [arrived.path for _, arrived in net.delivered] == [(1, 2, 3), (1, 2, 3), (1, 3)]


def test_a_route_is_shortened_in_its_middle() -> None:
    """8.1.5: what comes before and after the needless robots stays."""
    net = chain("mrsr", 6)
    net.submit(1, 6)
    net.run(2_000 * MS)
    net.links.add(frozenset((2, 5)))
    net.submit(1, 6)
    net.run(50 * MS)
    assert [s.packet for s in net.of(Rrep) if s.sender == 5 and s.target == 2] == [
        Rrep(0, (1, 2, 5, 6), (5, 2, 1))
    ]
    assert router(net, 1).cache.find(6, net.now) == (1, 2, 5, 6)


def test_a_weak_link_shortens_no_route() -> None:
    """3.4.3: a node may reply only when the packet was received well enough."""
    net = relayed(3.0)
    assert not net.of(Rrep)
    assert router(net, 1).cache.find(3, net.now) == (1, 2, 3)


def test_gratuitous_replies_are_held_off_for_a_second() -> None:
    """4.4 and 8.1.5: GratReplyHoldoff, by original sender and transmitter."""
    net = Net("mrsr", [3], [])
    router(net, 3).on_heard(1, 20.0, 0)
    overheard = data(1, (1,), (1, 2, 3))
    for time_ms in (0, 999, 1000):
        router(net, 3).on_overheard(overheard, 1, time_ms * MS)
    assert len(net.of(Rrep)) == 2
    router(net, 3).on_heard(4, 20.0, 1000 * MS)
    router(net, 3).on_overheard(data(1, (1, 4), (1, 4, 2, 3)), 4, 1001 * MS)
    assert net.of(Rrep)[-1].packet == Rrep(0, (1, 4, 3), (3, 4, 1))


def test_an_overheard_error_is_heeded() -> None:
    """3.3.1: whoever hears of a broken link forgets it."""
    net = Net("mrsr", [1], [])
    router(net, 1).cache.add((1, 2, 3, 4), 0)
    router(net, 1).on_overheard(Rerr(3, 4, (3, 2, 9)), 3, 0)
    assert router(net, 1).cache.paths() == ((1, 2), (1, 2, 3))
