"""A message that is of no use any more is dropped where it waits; its discovery goes on for others."""

import pytest

from onehop.contracts.messages import BROADCAST, DeliveryStatus
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.routing.mrdv_limits import NET_DIAMETER
from radio_proxy.core.routing.mrdv_packets import Rreq as MrdvRreq
from radio_proxy.core.routing.mrsr_packets import Rreq as MrsrRreq
from tests.radio.missions import Mission, line, message
from tests.radio.net import MS, Net, chain
from tests.radio.stations import Cell

STILL = RadioSection(routing="direct", shadowing_db=0.0)
SECOND = 1_000 * MS


def test_a_frame_that_expires_in_the_queue_is_not_served() -> None:
    """Each takes 8.2 ms or so: the third comes up too late, the fourth has time."""
    cell = Cell([(0.0, 0.0), (5.0, 0.0)], STILL)
    frames = [cell.send_at(0.0, 0, 1) for _ in range(4)]
    frames[2].expires = 10 * MS
    cell.run(50_000.0)
    assert [frame for _, _, frame in cell.arrived] == [frames[0], frames[1], frames[3]]
    assert cell.expired == [frames[2]]


def test_a_queue_in_which_everything_expires_is_empty() -> None:
    cell = Cell([(0.0, 0.0), (5.0, 0.0)], STILL)
    frames = [cell.send_at(0.0, 0, 1) for _ in range(3)]
    frames[1].expires = frames[2].expires = 1 * MS
    late = cell.send_at(30_000.0, 0, 1)
    cell.run(50_000.0)
    assert [frame for _, _, frame in cell.arrived] == [frames[0], late]
    assert cell.expired == frames[1:]


def test_a_message_expires_in_the_queue_of_its_nic() -> None:
    """Also a broadcast, whose verdict is one for each robot."""
    short = 20 * MS
    outbox = tuple(message(2, lifetime_ns=short) for _ in range(4))
    outbox += (message(BROADCAST, 100, lifetime_ns=short), message(2))
    verdicts = Mission(line(3, 5.0), STILL).run(3, {1: outbox})
    delivered, expired = DeliveryStatus.DELIVERED, DeliveryStatus.EXPIRED
    assert [(v.message, v.receiver, v.status) for v in verdicts] == [
        (1, 2, delivered),
        (2, 2, delivered),
        (3, 2, delivered),
        (4, 2, expired),
        (5, 2, expired),
        (5, 3, expired),
        (6, 2, delivered),
    ]
    assert all(v.path == (1,) and v.attempts == (0,) for v in verdicts if v.status is expired)


@pytest.mark.parametrize("routing", ["mrsr", "mrdv"])
def test_a_scenario_may_set_a_lifetime_for_all_that_have_none(routing: str) -> None:
    section = RadioSection(routing=routing, shadowing_db=0.0, message_lifetime_s=1.0)  # type: ignore[arg-type]
    mission = Mission({1: (0, 0), 2: (90, 0)}, section)
    outbox = (message(2), message(2, lifetime_ns=2 * SECOND))
    verdicts = mission.run(60, {1: outbox})
    assert [(v.message, v.status) for v in verdicts] == [
        (1, DeliveryStatus.EXPIRED),
        (2, DeliveryStatus.EXPIRED),
    ]
    assert mission.run(1) == []
    assert [v.discovery_ns for v in verdicts] == [SECOND, 2 * SECOND]


@pytest.mark.parametrize("routing", ["mrsr", "mrdv"])
def test_a_message_expires_while_it_waits_for_a_route(routing: str) -> None:
    net = Net(routing, [1, 2], [])
    short, long = net.submit(1, 2, SECOND), net.submit(1, 2)
    net.run(SECOND - 1)
    assert not net.lost
    net.run(1)
    assert net.lost == [(short, DeliveryStatus.EXPIRED)]
    net.run(40 * SECOND)
    assert net.lost[1:] == [(long, DeliveryStatus.NO_ROUTE)]


@pytest.mark.parametrize("routing", ["mrsr", "mrdv"])
def test_a_discovery_goes_on_while_others_take_the_place_of_what_expires(routing: str) -> None:
    """A Next every half second that lives as long: the normal discovery comes all the same."""
    net = chain(routing, 4)
    net.speed, net.remaining = 3.0, 200.0
    for _ in range(8):
        net.submit(1, 4, SECOND // 2)
        net.run(SECOND // 2)
    assert {data.path for _, data in net.delivered} == {(1, 2, 3, 4)}
    assert len(net.delivered) >= 4


@pytest.mark.parametrize("routing", ["mrsr", "mrdv"])
def test_nobody_asks_for_a_route_that_nothing_waits_for(routing: str) -> None:
    net = Net(routing, [1, 2], [])
    net.submit(1, 2, SECOND)
    net.run(60 * SECOND)
    asked = [*net.of(MrdvRreq), *net.of(MrsrRreq)]
    assert max(sent.time_ns for sent in asked) <= SECOND
    ttls = [sent.packet.ttl for sent in net.of(MrdvRreq) if isinstance(sent.packet, MrdvRreq)]
    assert NET_DIAMETER not in ttls


@pytest.mark.parametrize("routing", ["mrsr", "mrdv"])
def test_what_expired_while_its_link_failed_is_not_sent_along_another_route(routing: str) -> None:
    net = chain(routing, 2)
    net.submit(1, 2)
    net.run(SECOND)
    net.links.clear()
    net.sent.clear()
    late = net.submit(1, 2, 2 * MS)
    net.run(40 * SECOND)
    assert net.lost == [(late, DeliveryStatus.EXPIRED)]
    assert not net.of(MrdvRreq)
    assert not net.of(MrsrRreq)
