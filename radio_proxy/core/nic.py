"""The network interface card of a robot, as its routing protocol sees it."""

from collections.abc import Callable
from typing import Any

from onehop.contracts.messages import TransmitRequest
from radio_proxy.core.addresses import RobotId
from radio_proxy.core.deliveries import Deliveries
from radio_proxy.core.draws import Draws
from radio_proxy.core.event_queue import Callback, EventQueue
from radio_proxy.core.link_layer import LinkLayer


class Nic:
    """NicServices (routing/interface.py) of one incarnation of one robot.

    request_of: what a robot last handed over with its messages: its speed and its distance to go.
    """

    def __init__(
        self,
        robot: RobotId,
        incarnation: int,
        link: LinkLayer,
        deliveries: Deliveries,
        events: EventQueue,
        draws: Draws,
        request_of: Callable[[RobotId], TransmitRequest],
    ) -> None:
        self.robot = robot
        self.incarnation = incarnation
        self._down = False
        self._link = link
        self.deliver, self.drop = deliveries.deliver, deliveries.drop
        self._events = events
        self.uniform = draws.uniform
        self._request_of = request_of

    def shut_down(self) -> None:
        """The robot left: timers that are still to come are void."""
        self._down = True

    def send(self, packet: object, next_hop: RobotId, size_bytes: int, kind: str, now: int) -> bool:
        return self._link.send(self.robot, packet, next_hop, size_bytes, kind, now)

    def at(self, time_ns: int, event: Callback, argument: Any) -> None:
        def unless_down(given: Any, now: int) -> None:
            if not self._down:
                event(given, now)

        self._events.at(time_ns, unless_down, argument)

    def speed(self) -> float:
        return self._request_of(self.robot).speed

    def remaining_distance(self) -> float:
        return self._request_of(self.robot).remaining_distance
