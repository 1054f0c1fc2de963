"""What shadows and fades do to the messages of a mission."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from onehop.contracts.ideal_link import DIFS_US
from onehop.contracts.messages import DeliveryStatus
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.randomness import generator
from radio_proxy.core.airtime import dsss
from radio_proxy.core.corruption import Corrupter
from radio_proxy.core.deliveries import Deliveries
from radio_proxy.core.draws import Draws
from radio_proxy.core.emission import Emission
from radio_proxy.core.event_queue import NEVER
from radio_proxy.core.fast_fading import fast_fading
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.link_layer import LinkLayer
from radio_proxy.core.link_rules import link_rules
from radio_proxy.core.medium import Medium
from radio_proxy.core.propagation import Propagation
from radio_proxy.core.routing.mrsr_packets import Rerr
from radio_proxy.core.shadowing import shadowing
from tests.radio.missions import PERIOD, Mission, message
from tests.radio.net import Net
from tests.radio.routers import mrsr_router
from tests.radio.stations import Cell
from tests.radio.test_propagation import present

SEED = 4
ONCE = {"routing": "direct", "shadowing_db": 0.0, "retry_limit": 1}
SHADOWED = RadioSection(spatial_shadowing_db=9.0, **ONCE)  # type: ignore[arg-type]
FADED = RadioSection(fast_fading="rayleigh", **ONCE)  # type: ignore[arg-type]
AT_THE_EDGE = 10.0 ** (28.0 / 20.0)
"""Distance of mean SNR 32 dB, which is the receive threshold [m]."""

PLACES = [(AT_THE_EDGE * math.cos(k), AT_THE_EDGE * math.sin(k)) for k in range(24)]
Point = tuple[float, float]


def arrives(section: RadioSection, start: Point, end: Point) -> bool:
    """Whether a message from the origin reaches a robot that moves between these in its tick."""
    mission = Mission({1: (0.0, 0.0), 2: start}, section, SEED)
    mission.places[2] = end
    mission.step({1: (message(2),)})
    (verdict,) = mission.verdicts
    return verdict.status is DeliveryStatus.DELIVERED


def gain_of_the_ground(place: Point) -> float:
    ground = shadowing(link_budget(SHADOWED), SEED)
    assert ground is not None
    ground.place([(0.0, 0.0), place])
    return ground.row_db(0)[1]


def gain_of_the_paths(place: Point) -> float:
    air = fast_fading(FADED, SEED)
    assert air is not None
    air.move([(0.0, 0.0), place], [(0.0, 0.0), place], 0, PERIOD)
    return air.row_db(0, 0)[1]


def test_a_message_gets_through_where_the_ground_lets_it() -> None:
    expected = [gain_of_the_ground(place) > 0.0 for place in PLACES]
    assert [arrives(SHADOWED, place, place) for place in PLACES] == expected
    assert len(set(expected)) == 2


def test_a_message_gets_through_where_its_paths_add_up() -> None:
    expected = [gain_of_the_paths(place) > 0.0 for place in PLACES]
    assert [arrives(FADED, place, place) for place in PLACES] == expected
    assert len(set(expected)) == 2


def test_fades_are_those_of_the_way_within_a_tick() -> None:
    """A message is over after 8 ms of the 50: it meets the first sixth of the way, not its end."""

    def along(place: Point, share: float) -> Point:
        return place[0] * (1.0 + 0.05 * share / AT_THE_EDGE), place[1]

    seen = set()
    for place in PLACES:
        first_sixth = {gain_of_the_paths(along(place, k / 48)) > 0.1 for k in range(9)}
        at_end = gain_of_the_paths(along(place, 1.0)) > 0.1
        if len(first_sixth) == 1 and first_sixth != {at_end}:
            assert arrives(FADED, place, along(place, 1.0)) is not at_end
            seen.add(at_end)
    assert seen == {True, False}


@pytest.mark.parametrize(
    ("section", "gain"), [(SHADOWED, gain_of_the_ground), (FADED, gain_of_the_paths)]
)
def test_carrier_sense_is_asked_of_shadows_and_fades(
    section: RadioSection, gain: Callable[[Point], float]
) -> None:
    """At the distance where the mean is just the carrier sense, half of the places sense."""
    section = replace(section, carrier_sense_db=32.0)
    expected, sensed = [], []
    for place in PLACES:
        fields = shadowing(link_budget(section), SEED), fast_fading(section, SEED)
        propagation = Propagation(link_budget(section), (1, 2), (), *fields)
        propagation.update(present((0.0, 0.0), place), (), (), (0, PERIOD))
        medium = Medium(propagation, Draws(generator(SEED, "radio")), link_rules(section))
        medium.begin(Emission(0, 1, 1.0, 8, propagation.snr_row(0, 0), None, 0))
        sensed.append(medium.is_busy(1))
        expected.append(gain(place) > 0.0)
    assert sensed == expected
    assert len(set(expected)) == 2


def overhears(place: Point) -> bool:
    """Whether a robot there overhears an error on its way from the origin to one a metre away."""
    propagation = Propagation(link_budget(FADED), (1, 2, 3), (), fast_fading=fast_fading(FADED, SEED))
    propagation.update(present((0.0, 0.0), (1.0, 0.0), place), (), (), (0, PERIOD))
    deliveries = Deliveries(Corrupter(generator(SEED, "faults")))
    draws = Draws(generator(SEED, "radio"))
    link = LinkLayer((1, 2, 3), FADED, propagation, draws, deliveries)
    net = Net("mrsr", (1, 2, 3), ())
    for robot in net.nics:
        link.attach(robot, mrsr_router(net, robot))
        mrsr_router(net, robot).cache.add((robot, 8, 9), 0)
    link.send(1, Rerr(8, 9, (1, 2)), 2, 36, "rerr", 0)
    link.events.run(PERIOD)
    assert mrsr_router(net, 2).cache.paths() == ((2, 8),)
    return mrsr_router(net, 3).cache.paths() == ((3, 8),)


def test_who_overhears_a_packet_is_asked_of_its_fade() -> None:
    expected = [gain_of_the_paths(place) > 0.0 for place in PLACES]
    assert [overhears(place) for place in PLACES] == expected
    assert len(set(expected)) == 2


def test_who_goes_on_before_an_answer_is_asked_of_its_fade() -> None:
    """Who senses the data waits for its end, and for that of its ACK if that is sensed as well."""
    section = replace(FADED, carrier_sense_db=32.0, rts_threshold_bytes=2304)
    data_end_us = DIFS_US + dsss(section).data(800) / 1000
    waits, expected = [], []
    for place in PLACES:
        cell = Cell([(0.0, 0.0), (1.0, 0.0), place], section)
        cell.send_at(0.0, 0, 1)
        cell.send_at(1000.0, 2, 1)
        cell.run(data_end_us - 1.0)
        sender, receiver = (cell.propagation.snr_row(station, 0)[2] for station in (0, 1))
        waiting = cell.dcf._stations[2]
        if sender >= 32.0:
            assert waiting.access == NEVER
            cell.run(data_end_us + 5.0)
            waits.append(waiting.access == NEVER)
            expected.append(receiver >= 32.0)
    assert waits == expected
    assert len(set(expected)) == 2
