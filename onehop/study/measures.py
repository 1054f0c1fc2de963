"""What is measured of a mission while it runs, without a log.

Of the followers while their team drives: a robot that says that it obeys another, and is neither at
setup nor stopped. docs/study.md has the definitions for people.
"""

from collections.abc import Mapping

from onehop.contracts.messages import BROADCAST, Action, Carriage, DeliveryStatus, RadioRecord
from onehop.contracts.scenario import Scenario
from onehop.contracts.team import Mode
from world_server.core.world import World

NOBODY = 0
"""The leader of a robot that obeys nobody yet."""

_AT_REST = (Mode.SETUP, Mode.STOPPED)


class Course:
    """Sums over the ticks of one mission."""

    def __init__(self, scenario: Scenario) -> None:
        self._period_s = scenario.clock.period_ns / 1e9
        self._team = len(scenario.team.robots)
        self._command_bytes = scenario.team.next_msdu_bytes
        self._followed = self._below = 0
        self._throughput = self._error = 0.0
        self._driven = self._led = 0.0
        self._sent = self._delivered = self._delay_ns = 0
        self._record: RadioRecord | None = None

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
        for one in world.truth().present:
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
            "driven_m": self._driven * self._period_s / self._team,
            "led_m": self._led * self._period_s,
        }


def _mean(total: float, count: int) -> float | None:
    return total / count if count else None
