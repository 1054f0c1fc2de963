"""Faults ordered by hand: taken in whenever they come, carried out with the next tick, and answered.

A robot that has left, and whose process somebody else has started again (a container), is restarted too.
"""

from collections import OrderedDict
from collections.abc import Iterator
from functools import partial

from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.operation import FaultAnswer, FaultOrder
from onehop.node.bus import Bus
from onehop.wire.codec import decode, encode
from world_server.core.world import World
from world_server.mailbox import Mailbox

MOST_WAITING = 100
"""Orders that may wait for the next tick; any more are passed over, and will be repeated."""

MOST_REMEMBERED = 1000
"""Answers that are given again when an order is repeated."""


class FaultOrders:
    """The world's side of `onehop fault`. robots: ids of the team.

    arrived: robots whose restart finds their process there already.
    """

    def __init__(self, bus: Bus, mail: Mailbox, robots: tuple[int, ...]) -> None:
        self._put = bus.publisher(topics.to(topics.INJECTOR, topics.ANSWER))
        self._waiting: dict[int, FaultSection] = {}
        self._taken: dict[int, FaultSection] = {}
        self._answers: OrderedDict[int, bytes] = OrderedDict()
        self._arriving: set[int] = set()
        self.arrived: set[int] = set()
        mail.read(topics.INJECTOR, topics.FAULT, self._on_order)
        for robot in robots:
            mail.read(topics.robot_name(robot), topics.ARRIVAL, partial(self._on_arrival, robot))

    @property
    def are_waiting(self) -> bool:
        """Whether an order is there that waits for the next tick."""
        return bool(self._waiting)

    def take(self, world: World) -> tuple[FaultSection, ...]:
        """The orders that are to be carried out with the next tick; the others are refused."""
        self.arrived = set()
        if not (self._waiting or self._arriving):
            return ()
        for number, fault in self._waiting.items():
            refusal = world.refusal(fault)
            if refusal is None:
                self._taken[number] = fault
            else:
                self._answer(FaultAnswer(number, world.tick, refusal, fault))
        self._waiting = {}
        return (*self._restarts(world), *self._taken.values())

    def _restarts(self, world: World) -> Iterator[FaultSection]:
        """A restart of each robot that has arrived and is not present."""
        self.arrived = self._arriving.difference(one.robot for one in world.truth().present)
        self._arriving = set()
        for robot in sorted(self.arrived):
            yield FaultSection("restart", robots=(robot,))

    def confirm(self, world: World) -> None:
        """Answer what has been carried out with the tick that begins."""
        for number, fault in self._taken.items():
            begun = fault.begun(world.time_ns / 1e9)
            refusal = "" if world.outcome() is None else "the mission ended before it could take effect"
            self._answer(FaultAnswer(number, world.tick, refusal, begun))
        self._taken = {}

    def _answer(self, answer: FaultAnswer) -> None:
        self._answers[answer.number] = data = encode(answer)
        if len(self._answers) > MOST_REMEMBERED:
            self._answers.popitem(last=False)
        self._put(data)

    def _on_arrival(self, robot: int, _: bytes) -> None:
        self._arriving.add(robot)

    def _on_order(self, data: bytes) -> None:
        try:
            order = decode(FaultOrder, data)
        except DecodeError:
            return
        if order.number in self._answers:
            self._put(self._answers[order.number])
        elif len(self._waiting) < MOST_WAITING:
            self._waiting[order.number] = order.fault
