"""MRDV when a link breaks: errors, precursors, another discovery, restarts (RFC 3561, 6.10 to 6.13)."""

import pytest

from onehop.contracts.messages import BROADCAST, DeliveryStatus
from radio_proxy.core.data_message import DataPacket
from radio_proxy.core.routing.links import REPEATED_EXCHANGES
from radio_proxy.core.routing.mrdv_packets import Rerr, Rreq
from tests.radio.net import MS, Net, chain, lose_link, receive
from tests.radio.routers import mrdv_request as request
from tests.radio.routers import mrdv_router as router

LONG = 60_000 * MS


def test_a_broken_link_kills_every_route_over_it_one_number_newer() -> None:
    """6.10, 6.11 case i: link-layer feedback; destination sequence numbers are incremented."""
    net = Net("mrdv", [1], [])
    table = router(net, 1).table
    for destination, via in ((5, 3), (6, 3), (7, 4)):
        table.update(destination, via, 2, 10, LONG, 0)
    lose_link(net, 1, 3)
    assert [table.usable(d, 0) is not None for d in (5, 6, 7)] == [False, False, True]
    assert [entry.sequence for d in (5, 6, 7) if (entry := table.entry(d, 0))] == [11, 11, 10]


def test_one_exchange_that_is_given_up_breaks_no_link() -> None:
    """6.10 leaves the notification open: no error and no request for what is chance."""
    net = chain("mrdv", 3)
    net.submit(1, 3)
    net.run(1_000 * MS)
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
    """6.11 case i, after so many exchanges in a row."""
    net = chain("mrdv", 3)
    net.submit(1, 3)
    net.run(1_000 * MS)
    net.links.remove(frozenset((2, 3)))
    net.sent.clear()
    net.submit(1, 3)
    net.run(20 * MS)
    assert len([s for s in net.of(DataPacket) if s.sender == 2]) == REPEATED_EXCHANGES + 1
    assert [(s.sender, s.target) for s in net.of(Rerr)] == [(2, 1)]


def test_a_message_whose_route_went_while_its_link_failed_looks_for_another() -> None:
    net = Net("mrdv", [1, 2, 3], [(1, 2), (2, 3)])
    router(net, 1).table.update(3, 2, 2, 0, LONG, 0)
    message = net.submit(1, 3)
    net.sent.clear()
    router(net, 1).table.break_link(2, 0)
    given_up = DataPacket(message, (1,)).tried(7)
    router(net, 1).on_undeliverable(given_up, 2, DeliveryStatus.BELOW_THRESHOLD, 0)
    assert [type(sent.packet) for sent in net.sent] == [Rreq]


def test_a_stale_route_through_the_asker_does_not_answer() -> None:
    """6.11: the number that a break adds keeps the asker from being sent back to itself."""
    net = chain("mrdv", 3)
    net.submit(1, 3)
    net.run(500 * MS)
    net.links.remove(frozenset((2, 3)))
    net.loss = lambda sender, receiver: (sender, receiver) == (2, 1)
    net.submit(2, 3)
    net.run(20 * MS)
    assert router(net, 2).table.usable(3, net.now) is None
    net.loss = lambda _sender, _receiver: False
    net.run(2_000 * MS)
    still = router(net, 1).table.usable(3, net.now)
    assert still is None or still.next_hop == 2
    assert router(net, 2).table.usable(3, net.now) is None


@pytest.mark.parametrize(("precursors", "target"), [((8,), 8), ((8, 9), BROADCAST)])
def test_precursors_are_told(precursors: tuple[int, ...], target: int) -> None:
    """6.11: unicast to a single precursor, broadcast to several, none without."""
    net = Net("mrdv", [1], [])
    table = router(net, 1).table
    table.update(5, 3, 2, 10, LONG, 0)
    table.update(6, 3, 2, 20, LONG, 0)
    route = table.usable(5, 0)
    assert route is not None
    for robot in precursors:
        route.add_precursor(robot)
    lose_link(net, 1, 3)
    (error,) = net.of(Rerr)
    assert (error.packet, error.target) == (Rerr(((5, 11),)), target)


def test_an_error_kills_only_routes_through_its_sender_and_travels_on() -> None:
    """6.11 case iii."""
    net = Net("mrdv", [1], [])
    table = router(net, 1).table
    table.update(5, 3, 2, 10, LONG, 0)
    table.update(6, 4, 2, 10, LONG, 0)
    for destination in (5, 6):
        route = table.usable(destination, 0)
        assert route is not None
        route.add_precursor(8)
    receive(net, 1, Rerr(((5, 12), (6, 12))), 3, 0)
    assert table.usable(5, 0) is None
    assert table.usable(6, 0) is not None
    assert [sent.packet for sent in net.of(Rerr)] == [Rerr(((5, 12),))]


def test_data_without_a_route_is_answered_with_an_error() -> None:
    """6.11 case ii."""
    net = chain("mrdv", 3)
    net.submit(1, 3)
    net.run(1_000 * MS)
    net.stop(2)
    net.start(2, 1)
    net.submit(1, 3)
    net.run(LONG)
    assert [(sent.sender, sent.target) for sent in net.of(Rerr)][:1] == [(2, 1)]
    assert [status for _, status in net.lost] == [DeliveryStatus.NO_ROUTE]


def test_the_source_discovers_once_more_when_its_link_breaks() -> None:
    net = Net("mrdv", [1, 2, 3], [(1, 3), (1, 2), (2, 3)])
    net.submit(1, 3)
    net.run(100 * MS)
    net.links.remove(frozenset((1, 3)))
    net.submit(1, 3)
    net.run(2_000 * MS)
    assert [data.path for _, data in net.delivered] == [(1, 3), (1, 2, 3)]


def test_a_neighbour_that_does_not_take_replies_is_not_heard_for_a_while() -> None:
    """6.8: the blacklist, filled by link-layer feedback on a reply."""
    net = Net("mrdv", [1], [])
    receive(net, 1, request(1), 8, 0)
    net.run(10 * MS)
    receive(net, 1, request(5, number=2), 8, net.now)
    net.run(5_700 * MS)
    assert not net.of(Rreq)
    receive(net, 1, request(5, number=3), 8, net.now)
    net.run(100 * MS)
    assert len(net.of(Rreq)) == 1
