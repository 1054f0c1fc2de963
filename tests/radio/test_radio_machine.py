"""The whole radio under random traffic, movement and faults: its promises hold after every tick."""

from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    rule,
    run_state_machine_as_test,
)

from onehop.contracts.messages import BROADCAST, Cut, DeliveryStatus, Jam, Transmission, Verdict
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.airtime import dsss
from tests.radio.missions import PERIOD, Mission, Outboxes, message

ROBOTS = 5
robots = st.integers(1, ROBOTS)
rules = st.sampled_from(
    [
        {},
        {"as_ns3": True},
        {"preset": "physical", "rts_threshold_bytes": 100},
        {"capture_db": 6.0, "preamble_sinr_db": 4.0, "rts_threshold_bytes": 2304},
        {"receive_threshold_db": 5.0, "carrier_sense_db": 5.0, "rate_mbps": 11.0},
        {"energy_detect_db": 25.0, "short_retry_limit": 3, "fading": "exchange"},
    ]
)
"""Keys of the radio section: rules of reception and contention."""

place = st.tuples(st.integers(0, 60), st.integers(0, 20))
TICKS_TO_SETTLE = 1000
"""50 s: longer than two discoveries of MRDV (21.5 s each) or the send buffer of MRSR (30 s)."""


class RadioMachine(RuleBasedStateMachine):
    """Robots talk, move, leave and come back while links are cut and areas jammed."""

    routing = ""

    @initialize(
        spots=st.lists(place, min_size=ROBOTS, max_size=ROBOTS), seed=st.integers(0, 99), keys=rules
    )
    def begin(self, spots: list[tuple[int, int]], seed: int, keys: dict[str, Any]) -> None:
        self.section = RadioSection(routing=self.routing, queue_frames=4, **keys)  # type: ignore[arg-type]
        places = {i: (float(x), float(y)) for i, (x, y) in enumerate(spots, 1)}
        self.mission = Mission(places, self.section, seed)
        self.pending: Outboxes = {}
        self.offered: dict[tuple[int, int], Transmission] = {}
        self.counts = dict.fromkeys(range(1, ROBOTS + 1), 0)
        self.settled: set[tuple[int, int, int]] = set()

    @rule(source=robots, destination=st.integers(0, ROBOTS + 1), size=st.sampled_from([20, 60, 800]))
    def submit(self, source: int, destination: int, size: int) -> None:
        if source in self.mission.places:
            number = len(self.pending.get(source, ())) + self.counts[source] + 1
            sent = message(destination, size, payload=b"%d:%d" % (source, number))
            self.pending[source] = (*self.pending.get(source, ()), sent)
            self.offered[source, number] = sent

    @rule(ticks=st.sampled_from([1, 1, 2, 5, 30]))
    def step(self, ticks: int) -> None:
        for _ in range(ticks):
            outboxes, self.pending = self.pending, {}
            for source, sent in outboxes.items():
                self.counts[source] += len(sent)
            self.check(self.mission.step(outboxes))

    @rule(robot=robots, spot=place)
    def move(self, robot: int, spot: tuple[int, int]) -> None:
        if robot in self.mission.places:
            self.mission.places[robot] = (float(spot[0]), float(spot[1]))

    @rule(a=robots, b=robots)
    def cut(self, a: int, b: int) -> None:
        self.mission.cuts = (Cut((a,), (b,)),) if a != b else ()

    @rule(spot=place, noise_dbm=st.sampled_from([-80.0, -60.0, -20.0]))
    def jam(self, spot: tuple[int, int], noise_dbm: float) -> None:
        self.mission.jams = (Jam(float(spot[0]), float(spot[1]), 15.0, noise_dbm),)

    @rule()
    def heal(self) -> None:
        self.mission.cuts, self.mission.jams = (), ()

    @rule(robot=robots, spot=place)
    def leave_or_return(self, robot: int, spot: tuple[int, int]) -> None:
        if robot in self.mission.places:
            del self.mission.places[robot]
            for sent in self.pending.pop(robot, ()):
                del self.offered[robot, int(sent.payload.split(b":")[1])]
        else:
            self.mission.places[robot] = (float(spot[0]), float(spot[1]))
            self.mission.incarnations[robot] += 1
            self.mission.speeds[robot] = self.mission.remaining[robot] = 0.0

    def check(self, verdicts: tuple[Verdict, ...]) -> None:
        """What one tick reports agrees with what was offered and with the inboxes."""
        end = (self.mission.tick - 1) * PERIOD
        for verdict in verdicts:
            key = (verdict.source, verdict.message, verdict.receiver)
            assert key not in self.settled, "a message is settled once"
            self.settled.add(key)
            sent = self.offered[verdict.source, verdict.message]
            assert verdict.destination == sent.destination
            assert (verdict.arrival_ns >= 0) == (verdict.status is DeliveryStatus.DELIVERED)
        arrived = [
            v
            for v in verdicts
            if v.status is DeliveryStatus.DELIVERED and v.receiver in self.mission.places
        ]
        got = [(i, r) for i, inbox in self.mission.inboxes.items() for r in inbox.receptions]
        assert len(got) == len(arrived)
        for robot, reception in got:
            number = int(reception.payload.split(b":")[1])
            assert self.offered[reception.source, number].payload == reception.payload
            assert (reception.source, number, robot) in self.settled
            assert end - PERIOD < reception.arrival_ns <= end
            airtime = dsss(self.section).data(reception.msdu_bytes)
            assert reception.arrival_ns - reception.service_start_ns >= reception.hops * airtime

    @invariant()
    def inboxes_are_in_order_of_arrival(self) -> None:
        for inbox in self.mission.inboxes.values():
            keys = [(reception.arrival_ns, reception.source) for reception in inbox.receptions]
            assert keys == sorted(keys)

    @invariant()
    def receivers_are_locked_on_frames_in_progress_that_others_sent(self) -> None:
        medium = self.mission.radio._link._medium
        for station, emission in medium.receivers._locked_on.items():
            assert emission in medium.emissions
            assert station != emission.source
            assert all(other.source != station for other in medium.emissions)

    def teardown(self) -> None:
        self.step(1)
        if self.section.energy_detect_db is not None:
            self.heal()
        for _ in range(TICKS_TO_SETTLE):
            self.check(self.mission.step())
        ended = {(source, number) for source, number, _ in self.settled}
        for key, sent in self.offered.items():
            alone = sent.destination == BROADCAST
            assert key in ended or alone, f"{key} never ended"


class DirectMachine(RadioMachine):
    routing = "direct"


class MrdvMachine(RadioMachine):
    routing = "mrdv"


class MrsrMachine(RadioMachine):
    routing = "mrsr"


def explore(machine: type[RadioMachine], examples: int) -> None:
    run_state_machine_as_test(
        machine,
        settings=settings(
            max_examples=examples,
            stateful_step_count=25,
            deadline=None,
            derandomize=True,
            suppress_health_check=list(HealthCheck),
        ),
    )


@pytest.mark.parametrize("machine", [DirectMachine, MrdvMachine, MrsrMachine])
def test_the_radio_keeps_its_promises(machine: type[RadioMachine]) -> None:
    explore(machine, 8)


@pytest.mark.slow
@pytest.mark.parametrize("machine", [DirectMachine, MrdvMachine, MrsrMachine])
def test_the_radio_keeps_its_promises_in_many_missions(machine: type[RadioMachine]) -> None:
    explore(machine, 120)


def test_no_station_is_left_locked_on_a_frame_that_is_over() -> None:
    """A reservation without its data frame is reset, and asks whether a frame had begun by then."""
    machine = MrdvMachine()
    machine.begin([(0, 0), (0, 0), (22, 0), (0, 0), (0, 0)], 0, {})
    machine.jam((0, 5), -80.0)
    machine.submit(4, 1, 20)
    machine.submit(3, 4, 20)
    machine.step(1)
    machine.receivers_are_locked_on_frames_in_progress_that_others_sent()
