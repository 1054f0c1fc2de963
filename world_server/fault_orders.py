"""Faults ordered by hand: taken in whenever they come, carried out with the next tick, and answered."""

from collections import OrderedDict

from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.messages import FaultAnswer, FaultOrder
from onehop.node.bus import Bus
from onehop.wire.codec import decode, encode
from world_server.core.world import World
from world_server.mailbox import Mailbox

MOST_WAITING = 100
"""Orders that may wait for the next tick; any more are passed over, and will be repeated."""

MOST_REMEMBERED = 1000
"""Answers that are given again when an order is repeated."""


class FaultOrders:
    """The world's side of `onehop fault`."""

    def __init__(self, bus: Bus, mail: Mailbox) -> None:
        self._put = bus.publisher(topics.to(topics.INJECTOR, topics.ANSWER))
        self._waiting: dict[int, FaultSection] = {}
        self._taken: dict[int, FaultSection] = {}
        self._answers: OrderedDict[int, bytes] = OrderedDict()
        mail.read(topics.INJECTOR, topics.FAULT, self._on_order)

    def take(self, world: World) -> tuple[FaultSection, ...]:
        """The orders that are to be carried out with the next tick; the others are refused."""
        if not self._waiting:
            return ()
        for number, fault in self._waiting.items():
            refusal = world.refusal(fault)
            if refusal is None:
                self._taken[number] = fault
            else:
                self._answer(FaultAnswer(number, world.tick, refusal, fault))
        self._waiting = {}
        return tuple(self._taken.values())

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

    def _on_order(self, data: bytes) -> None:
        try:
            order = decode(FaultOrder, data)
        except DecodeError:
            return
        if order.number in self._answers:
            self._put(self._answers[order.number])
        elif len(self._waiting) < MOST_WAITING:
            self._waiting[order.number] = order.fault
