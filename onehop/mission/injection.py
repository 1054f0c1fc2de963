"""Order a fault on a mission that runs, and wait until it has taken effect."""

import secrets
import time

from onehop.contracts import topics
from onehop.contracts.errors import DecodeError, MissionError
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.operation import FaultAnswer, FaultOrder
from onehop.mission.rendezvous import Rendezvous
from onehop.node.bus import GONE, Bus, open_client
from onehop.wire.codec import decode, encode

CONNECT_MS = 10_000
"""How long the mission's bus, or another injector that is there first, may take [ms]."""

ANSWER_S = 30.0
"""How long the next tick may take to come [s]: a restart of a process holds it up."""

REPEAT_S = 0.5
"""How often an order is repeated until it is answered [s]."""


def inject(way_in: Rendezvous, fault: FaultSection) -> FaultAnswer:
    """The world's answer. Raises MissionError when there is none, InputError for a bad certificate."""
    identity = way_in.identity()
    try:
        bus = open_client(way_in.mission, way_in.endpoint, topics.INJECTOR, identity, CONNECT_MS)
    except MissionError as error:
        raise MissionError(f"the mission does not answer: {error}") from None
    with bus:
        bus.watch(topics.WORLD)
        order = FaultOrder(secrets.randbits(62), fault)
        put = bus.publisher(topics.by(topics.INJECTOR, topics.FAULT))
        deadline = time.monotonic() + ANSWER_S
        while time.monotonic() < deadline:
            put(encode(order))
            answer = _answer(bus, order.number, time.monotonic() + REPEAT_S)
            if answer is not None:
                return answer
    raise MissionError(f"the mission did not answer within {ANSWER_S:g} s; it may be held up")


def _answer(bus: Bus, number: int, deadline: float) -> FaultAnswer | None:
    """The answer to an order, None when there is none by the deadline. Raises MissionError."""
    while (received := bus.receive_by(deadline)) is not None:
        what, data = received
        if (what, data) == (topics.alive(topics.WORLD), GONE):
            raise MissionError("the mission ended before the fault could take effect")
        if what == topics.ANSWER:
            try:
                answer = decode(FaultAnswer, data)
            except DecodeError:
                continue
            if answer.number == number:
                return answer
    return None
