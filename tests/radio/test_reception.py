"""Preamble, lock, stretches of interference, header and capture, frame by frame."""

import pytest

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Cut, DeliveryStatus, Presence
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.randomness import generator
from radio_proxy.core.addresses import EVERYONE, StationIndex
from radio_proxy.core.draws import Draws
from radio_proxy.core.emission import Emission
from radio_proxy.core.error_rates import frame_success
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.link_rules import link_rules
from radio_proxy.core.medium import Medium
from radio_proxy.core.propagation import Propagation

US = 1000
COLLISION, BUSY = DeliveryStatus.COLLISION, DeliveryStatus.RECEIVER_BUSY
WEAK, ERRORS = DeliveryStatus.BELOW_THRESHOLD, DeliveryStatus.BIT_ERRORS


class Air:
    """Emissions at given times on a medium without a DCF. Station 1 is the receiver, at the origin.

    errors: its index, once for every frame that it received with errors.
    """

    def __init__(self, places: list[tuple[float, float]], seed: int = 1, **keys: float | None) -> None:
        section = RadioSection(**{"shadowing_db": 0.0, **keys})  # type: ignore[arg-type]
        robots = tuple(range(1, len(places) + 1))
        self.propagation = Propagation(link_budget(section), robots, ())
        still = Twist(0.0, 0.0)
        presences = [
            Presence(r, 0, Pose(x, y, 0.0), still, False)
            for r, (x, y) in zip(robots, places, strict=True)
        ]
        self.errors: list[int] = []
        cuts = (Cut((1,), (3,)),)
        self.propagation.update(tuple(presences), cuts, ())
        self.medium = Medium(self.propagation, Draws(generator(seed, "radio")), link_rules(section))

    def judge(
        self, *frames: tuple[int, float, float], rate_mbps: float = 1.0
    ) -> list[DeliveryStatus | None]:
        """What became of each frame (source, start, end [us]) at station 1; None is received."""
        emissions = [
            Emission(
                StationIndex(source),
                StationIndex(1) if source != 1 else EVERYONE,
                rate_mbps,
                round(rate_mbps * (end - start - 192)),
                self.propagation.mean_snr_row(StationIndex(source)),
                None,
                round(start * US),
            )
            for source, start, end in frames
        ]
        times = [(round(start * US), 1, i) for i, (_, start, _) in enumerate(frames)]
        times += [(round(end * US), 0, i) for i, (_, _, end) in enumerate(frames)]
        for time, begins, i in sorted(times):
            if begins:
                self.medium.begin(emissions[i])
            else:
                self.errors += [s for s in self.medium.end(emissions[i], time) if s == 1]
        return [self.medium.receivers.judgement(e, StationIndex(1))[0] for e in emissions]


EQUAL = [(-10.0, 0.0), (0.0, 0.0), (10.0, 0.0)]
NEAR_AND_FAR = [(-10.0, 0.0), (0.0, 0.0), (2.0, 0.0)]
"""40 dB of station 0 and 54 dB of station 2, which do not hear each other."""


def test_a_receiver_stays_with_the_frame_that_it_is_locked_on() -> None:
    """At 1 Mb/s a frame survives an equal one that comes later: SINR 0 dB."""
    assert Air(EQUAL).judge((0, 0, 7000), (2, 500, 7500)) == [None, BUSY]
    assert Air(EQUAL).judge((0, 0, 1000), (2, 998, 2000)) == [None, BUSY]
    lax = Air(EQUAL, receive_threshold_db=-9.5)
    assert lax.judge((0, 0, 1000), (2, 2, 1002)) == [None, COLLISION]


def test_a_frame_that_begins_among_others_is_not_detected() -> None:
    """The first is over, but the second that it kept from being received still drowns the third."""
    frames = (0, 0, 1000), (2, 500, 1500), (0, 1200, 2200)
    assert Air(EQUAL).judge(*frames) == [None, BUSY, COLLISION]
    assert Air(EQUAL, preamble_sinr_db=0.0).judge(*frames)[1:] == [BUSY, COLLISION]


def test_of_two_preambles_in_one_instant_the_stronger_is_detected_if_its_sinr_is_enough() -> None:
    frames = (0, 0, 1000), (2, 0, 1000)
    assert Air(EQUAL, preamble_sinr_db=4.0).judge(*frames) == [COLLISION, COLLISION]
    assert Air(NEAR_AND_FAR).judge(*frames) == [COLLISION, COLLISION]
    assert Air(NEAR_AND_FAR, preamble_sinr_db=4.0).judge(*frames) == [COLLISION, None]


def test_a_preamble_is_detected_by_what_is_on_the_air_when_its_detection_ends() -> None:
    """4 us after its begin: what comes then comes too late to drown it."""
    assert Air(EQUAL).judge((0, 0, 1000), (2, 3, 1003))[0] is COLLISION
    assert Air(EQUAL).judge((0, 0, 1000), (2, 5, 1005))[0] is None
    assert Air(EQUAL).judge((0, 2, 1002), (2, 0, 5))[0] is None


def test_the_receive_threshold_is_asked_of_the_signal_alone() -> None:
    """30 dB at 32 m do not reach 32 dB, with or without others."""
    places = [(-32.0, 0.0), (0.0, 0.0), (10.0, 0.0)]
    assert Air(places, preamble_sinr_db=0.0).judge((0, 0, 1000), (2, 0, 1000)) == [WEAK, None]
    assert Air(places).judge((0, 0, 1000)) == [WEAK]


def test_a_station_that_transmits_does_not_receive() -> None:
    """Neither what begins meanwhile nor what it was receiving."""
    assert Air(EQUAL).judge((1, 0, 1000), (0, 500, 1500))[1] is BUSY
    assert Air(EQUAL).judge((1, 500, 800), (0, 0, 1000))[1] is BUSY
    assert Air(EQUAL).judge((1, 0, 400), (0, 500, 1500))[1] is None


def test_a_stronger_frame_captures_a_receiver_in_the_preamble() -> None:
    """The preamble lasts 144 us; the other frame is 14 dB stronger."""
    in_preamble, after_it = ((0, 0, 1000), (2, 100, 1100)), ((0, 0, 1000), (2, 150, 1150))
    keys = {"preamble_sinr_db": 4.0, "capture_db": 10.0}
    assert Air(NEAR_AND_FAR, **keys).judge(*in_preamble) == [COLLISION, None]
    assert Air(NEAR_AND_FAR, **keys).judge(*after_it)[1] is BUSY
    assert Air(NEAR_AND_FAR, **{**keys, "capture_db": 15.0}).judge(*in_preamble)[1] is BUSY
    assert Air(NEAR_AND_FAR, preamble_sinr_db=4.0).judge(*in_preamble)[1] is BUSY


def test_each_stretch_counts_with_its_own_bits() -> None:
    """11 Mb/s, 6 dB against another frame for a quarter of the payload, nobody for the rest."""
    places = [(-5.0, 0.0), (0.0, 0.0), (10.0, 0.0)]
    payload_us = 600.0
    bits = 11 * payload_us
    for share in (0.25, 1.0):
        received = 0
        for seed in range(1500):
            begin = 192.0 + payload_us * (1.0 - share)
            frames = (0, 0, 192.0 + payload_us), (2, begin, begin + 2000)
            received += Air(places, seed).judge(*frames, rate_mbps=11.0)[0] is None
        expected = frame_success(11.0, 6.0206, share * bits)
        assert received / 1500 == pytest.approx(expected, abs=0.04)
        assert 0.1 < expected < 0.9


def test_the_header_has_a_rate_of_its_own() -> None:
    """An equal frame over preamble and header only, at 0 dB: 1 Mb/s survives, 11 Mb/s would not."""
    assert Air(EQUAL).judge((0, 0, 1000), (2, 10, 190), rate_mbps=11.0)[0] is None
    air = Air(EQUAL)
    assert air.judge((0, 0, 1000), (2, 10, 250), rate_mbps=11.0)[0] is COLLISION
    assert air.errors == [1]


def test_a_header_that_is_lost_leaves_the_receiver_free() -> None:
    """-14 dB over the header: what comes then is received, and nothing counts as an error."""
    frames = (0, 0, 3000), (2, 100, 195), (2, 1000, 2000)
    air = Air(NEAR_AND_FAR, preamble_sinr_db=4.0)
    assert air.judge(*frames) == [COLLISION, BUSY, None]
    assert air.errors == []
    before = (0, 0, 3000), (2, 100, 185), (2, 188, 1000)
    assert Air(NEAR_AND_FAR, preamble_sinr_db=4.0).judge(*before)[2] is BUSY


def test_bit_errors_are_what_the_noise_alone_did() -> None:
    """At -7 dB nothing of 800 bytes gets through; with a threshold below it the receiver tries."""
    weak = {"tx_power_dbm": -25.0, "receive_threshold_db": -9.5}
    places = [(-4.0, 0.0), (0.0, 0.0), (400.0, 0.0)]
    assert Air(places, **weak).judge((0, 0, 7000)) == [None]
    short = [Air([(-7.5, 0.0), *places[1:]], s, **weak).judge((0, 0, 200))[0] for s in range(400)]
    header = frame_success(1.0, 12.0 - 17.5012, 48 + 8)
    assert short.count(None) / 400 == pytest.approx(header, abs=0.02)
    places[0] = (-9.0, 0.0)
    assert Air(places, **weak).judge((0, 0, 7000)) == [ERRORS]


def test_who_overhears_a_frame_needs_its_bits_as_well() -> None:
    """At the SNRs of radio cards that receive below 20 dB: 4 % of frames of 6672 bits at -5 dB."""
    overheard = Air(EQUAL, receive_threshold_db=-9.5).medium.receivers.judge_overheard
    judged = [overheard(StationIndex(1), -5.0, 1.0, 6672)[0] for _ in range(1000)]
    assert 15 <= judged.count(None) <= 60
    assert judged.count(None) + judged.count(ERRORS) == 1000
    assert overheard(StationIndex(1), -10.0, 1.0, 6672) == (WEAK, -10.0)
    assert overheard(StationIndex(1), 30.0, 1.0, 6672) == (None, 30.0)
