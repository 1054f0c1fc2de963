"""What is measured of a mission while it runs, without a log.

Of the followers while their team drives: a robot that says that it obeys another, and is neither at
setup nor stopped. docs/sweeps.md has the definitions for people.
"""

from collections.abc import Mapping

from onehop.analysis.connectivity import is_connected
from onehop.analysis.derived import connectivity_of
from onehop.analysis.energy import EnergyMeter
from onehop.contracts.messages import BROADCAST, Action, Carriage, DeliveryStatus, RadioRecord, Truth
from onehop.contracts.team import Mode
from onehop.scenario.bundle import Bundle
from radio_proxy.core.error_rates import thesis_ber
from world_server.core.world import World

NOBODY = 0
"""The leader of a robot that obeys nobody yet."""

_AT_REST = (Mode.SETUP, Mode.STOPPED)


class Course:
    """Sums over the ticks of one mission."""

    def __init__(self, bundle: Bundle) -> None:
        scenario = bundle.scenario
        self._period_s = scenario.clock.period_ns / 1e9
        self._team = len(scenario.team.robots)
        self._command_bytes = scenario.team.next_msdu_bytes
        self._followed = self._below = 0
        self._throughput = self._error = 0.0
        self._driven = self._led = 0.0
        self._sent = self._delivered = self._delay_ns = 0
        self._ber = 0.0
        self._energy = EnergyMeter(scenario.radio, self._period_s)
        self._drive_j = self._radio_j = 0.0
        self._links = connectivity_of(bundle)
        self._looks = self._connected = 0
        self._record: RadioRecord | None = None
        self._truth: Truth | None = None

    def watch(self, world: World, actions: Mapping[int, Action], carried: Carriage) -> None:
        """Called by the driver after every tick."""
        leaders = []
        for robot, action in actions.items():
            status = action.status
            if status is None:
                continue
            if status.leader == robot:
                leaders.append(robot)
            elif status.leader != NOBODY and status.mode not in _AT_REST:
                self._followed += 1
                self._throughput += status.throughput_bps
                self._below += status.throughput_bps < status.threshold_bps
                self._error += status.error
        before, self._truth = self._truth, world.truth()
        if before is not None:
            self._spend(before, carried.record)
        for one in self._truth.present:
            speed = abs(one.twist.v)
            self._driven += speed
            if one.robot in leaders:
                self._led += speed
        self._record = carried.record
        for verdict in carried.record.verdicts:
            if verdict.destination != BROADCAST and verdict.msdu_bytes >= self._command_bytes:
                self._sent += 1
                if verdict.status is DeliveryStatus.DELIVERED:
                    self._delivered += 1
                    self._delay_ns += verdict.arrival_ns - verdict.offered_ns
                    self._ber += thesis_ber(verdict.snr_db, 8 * verdict.msdu_bytes)

    def _spend(self, truth: Truth, record: RadioRecord) -> None:
        """A tick, its ground truth and what the radio did in it; those of the first one are left out."""
        for spent in self._energy.take(truth, record).values():
            self._drive_j += spent.drive_j
            self._radio_j += spent.radio_j
        if self._links.is_due(truth.tick):
            self._looks += 1
            present = [one.robot for one in truth.present]
            self._connected += is_connected(present, self._links.pairs(truth))

    def measures(self) -> dict[str, float | None]:
        """The measures by name; None where there was nothing to measure."""
        followers = max(self._team - 1, 1)
        record = self._record
        return {
            "throughput_bps": _mean(self._throughput, self._followed),
            "below_threshold_s": self._below * self._period_s / followers,
            "error_m": _mean(self._error, self._followed),
            "delay_ms": _mean(self._delay_ns / 1e6, self._delivered),
            "delivery_ratio": _mean(self._delivered, self._sent),
            "routing_bytes": sum(record.control_bytes.values()) if record is not None else 0,
            "ber": _mean(self._ber, self._delivered),
            "drive_j": self._drive_j / self._team,
            "radio_j": self._radio_j / self._team,
            "connected_share": _mean(self._connected, self._looks),
            "driven_m": self._driven * self._period_s / self._team,
            "led_m": self._led * self._period_s,
        }


def _mean(total: float, count: int) -> float | None:
    return total / count if count else None
