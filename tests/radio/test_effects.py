"""What the radio must show in a mission: relays, faults, overhead and delay of the two protocols."""

import math
import statistics

import pytest

from onehop.contracts.ideal_link import THESIS_THRESHOLD_BPS
from onehop.contracts.messages import Cut, DeliveryStatus, Jam, Reception, Verdict
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.routing.mrsr_packets import Rrep, Rreq, source_route_bytes
from tests.radio.missions import Mission, line, message

NS3_AODV_MS = (7.542, 15.398, 23.255)
NS3_DSR_MS = (7.702, 15.782, 23.927)
"""Idle 1, 2 and 3 hops, ns-3 3.44, 28 B header."""


def throughput_bps(reception: Reception) -> float:
    """What a follower measures."""
    return 8e9 * reception.msdu_bytes / (reception.arrival_ns - reception.service_start_ns)


def still(routing: str, **changes: object) -> RadioSection:
    return RadioSection(routing=routing, shadowing_db=0.0, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize(("routing", "expected"), [("mrdv", NS3_AODV_MS), ("mrsr", NS3_DSR_MS)])
@pytest.mark.parametrize("hops", [1, 2, 3])
def test_idle_hops_take_what_ns3_measured(routing: str, expected: tuple[float, ...], hops: int) -> None:
    """Within 1 % once the route is known."""
    mission = Mission(line(hops + 1, 20.0), still(routing, mac_header_bytes=28))
    mission.run(20, {1: (message(hops + 1),)})
    (verdict,) = mission.run(4, {1: (message(hops + 1),)})
    assert verdict.path == tuple(range(1, hops + 2))
    assert verdict.discovery_ns == 0
    taken_ms = (verdict.arrival_ns - verdict.service_start_ns) / 1e6
    assert taken_ms == pytest.approx(expected[hops - 1], rel=0.01)


@pytest.mark.parametrize("routing", ["mrdv", "mrsr"])
def test_a_cut_link_makes_a_relay_and_a_throughput_below_the_threshold(routing: str) -> None:
    """The direct link gives .8 Mb/s, a relay .41, the threshold is .5333."""
    mission = Mission({1: (0.0, 0.0), 2: (8.0, 0.0), 3: (4.0, 4.0)}, still(routing))
    for _ in range(2):
        mission.run(1, {1: (message(2),)})
    assert throughput_bps(mission.inboxes[2].receptions[0]) > THESIS_THRESHOLD_BPS
    mission.cuts = (Cut((1,), (2,)),)
    mission.run(40, {1: (message(2),)})
    mission.run(1, {1: (message(2),)})
    (reception,) = mission.inboxes[2].receptions
    assert reception.hops == 2
    assert throughput_bps(reception) < THESIS_THRESHOLD_BPS
    assert throughput_bps(reception) == pytest.approx(0.41e6, rel=0.03)


@pytest.mark.parametrize("routing", ["mrdv", "mrsr"])
def test_the_fallback_delivers_when_nobody_passes_requests_on(routing: str) -> None:
    """Thesis 3.7.2: at 3 m/s and 300 m to go p_r is about 1e-14."""
    mission = Mission(line(3, 20.0), still(routing))
    mission.speeds = dict.fromkeys(mission.places, 3.0)
    mission.remaining = dict.fromkeys(mission.places, 300.0)
    verdicts = mission.run(100, {1: (message(3),)})
    assert [(v.status, v.path) for v in verdicts] == [(DeliveryStatus.DELIVERED, (1, 2, 3))]
    assert verdicts[0].discovery_ns > 500_000_000


def routing_bytes(mission: Mission) -> int:
    """Bytes of routing packets; the source routes of data are counted apart."""
    return sum(count for kind, count in mission.control_bytes.items() if kind != "source_route")


def drive(routing: str, seed: int) -> tuple[int, list[Verdict]]:
    """Control bytes and Next messages of a long column that sways, so that routes keep changing."""
    mission = Mission(line(6, 12.0), still(routing), seed)
    acknowledgements = {}
    for tick in range(2400):
        t = tick * 0.05
        mission.places = {
            i: (12.0 * (i - 1) + 6.0 * math.sin(0.11 * t * i + seed), 5.0 * math.cos(0.07 * t * i))
            for i in range(1, 7)
        }
        mission.speeds = dict.fromkeys(mission.places, 1.2)
        mission.remaining = dict.fromkeys(mission.places, max(0.0, 40.0 - 0.3 * t))
        outboxes = dict(acknowledgements)
        if tick % 40 == 0:
            outboxes[3] = tuple(message(i) for i in (1, 2, 4, 5, 6))
        mission.step(outboxes)
        acknowledgements = {
            i: (message(3, 60),) for i, inbox in mission.inboxes.items() if i != 3 and inbox.receptions
        }
    nexts = [v for v in mission.verdicts if v.msdu_bytes == 800 and v.status is DeliveryStatus.DELIVERED]
    return routing_bytes(mission), nexts


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_mrsr_has_less_overhead_and_more_delay_a_hop_than_mrdv(seed: int) -> None:
    """Thesis 4.2; medians, for the mean is that of the few messages whose link broke under way."""
    overhead, delay_a_hop = {}, {}
    for routing in ("mrsr", "mrdv"):
        overhead[routing], nexts = drive(routing, seed)
        assert len(nexts) > 250
        delays = [
            (v.arrival_ns - v.service_start_ns - v.discovery_ns) / (len(v.path) - 1) for v in nexts
        ]
        delay_a_hop[routing] = statistics.median(delays)
    assert overhead["mrsr"] < 0.8 * overhead["mrdv"]
    assert delay_a_hop["mrsr"] > 1.01 * delay_a_hop["mrdv"]


def test_every_hop_of_a_routing_packet_counts_and_so_does_every_hop_of_a_source_route() -> None:
    """Broch et al. 1998, 5.2. One message over two hops; nobody knows anybody."""
    mission = Mission(line(3, 20.0), still("mrsr"))
    mission.run(20, {1: (message(3),)})
    assert mission.control_bytes == {
        "rreq": 2 * Rreq(1, 3, (1,), 1, False).size_bytes + Rreq(1, 3, (1, 2), 254, False).size_bytes,
        "rrep": 2 * Rrep(1, (1, 2, 3), (3, 2, 1)).size_bytes,
        "source_route": 2 * source_route_bytes((1, 2, 3)),
    }


def test_one_hop_costs_no_routing_while_it_is_used() -> None:
    """A leader's Next every 2 s keeps its routes alive: requests at the start, none later."""
    mission = Mission(line(6, 3.0), still("mrdv"))
    outbox = tuple(message(i) for i in (1, 2, 4, 5, 6))
    mission.run(40, {3: outbox})
    after_first = mission.control_bytes
    for _ in range(5):
        mission.run(40, {3: outbox})
    assert mission.control_bytes == after_first


def test_a_cut_carries_nothing_and_heals() -> None:
    mission = Mission(line(2, 5.0), still("direct"))
    mission.cuts = (Cut((1,), (2,)),)
    (lost,) = mission.run(4, {1: (message(2),)})
    assert (lost.status, lost.attempts) == (DeliveryStatus.BELOW_THRESHOLD, (7,))
    mission.cuts = ()
    (found,) = mission.run(1, {1: (message(2),)})
    assert found.status is DeliveryStatus.DELIVERED


def test_a_jam_raises_losses_inside_its_disc_alone() -> None:
    mission = Mission({1: (0.0, 0.0), 2: (6.0, 0.0), 3: (0.0, 6.0)}, still("direct"))
    mission.jams = (Jam(6.0, 0.0, 2.0, -40.0),)
    statuses = {v.receiver: v.status for v in mission.run(4, {1: (message(2), message(3))})}
    assert statuses == {2: DeliveryStatus.BELOW_THRESHOLD, 3: DeliveryStatus.DELIVERED}


def test_bit_errors_are_told_from_a_weak_signal() -> None:
    """With the threshold out of the way DBPSK loses frames at -5 dB (success .04)."""
    section = still("direct", receive_threshold_db=-50.0, carrier_sense_db=-60.0, tx_power_dbm=-42.0)
    (verdict,) = Mission(line(2, 1.0), section).run(4, {1: (message(2),)})
    assert verdict.snr_db == pytest.approx(-5.01, abs=0.01)
    assert verdict.status is DeliveryStatus.BIT_ERRORS
    assert verdict.bit_error_rate > 1e-4


def test_same_seed_same_verdicts() -> None:
    """No hidden randomness: two radios that see the same truths say the same."""
    said = []
    for seed in (5, 5, 6):
        mission = Mission(line(5, 14.0), RadioSection(), seed)
        for tick in range(60):
            others = tuple(message(i) for i in range(1, 6) if i != 3)
            mission.step({3: others} if tick % 20 == 0 else {})
        said.append(tuple(mission.verdicts))
    assert said[0] == said[1] != said[2]
