"""What a page may say to the server: one struct a kind, and everything else is refused."""

from typing import Annotated, Any

import msgspec

from onehop.contracts.errors import DecodeError
from onehop.contracts.fault_section import KINDS, FaultSection
from onehop.contracts.printable import printable
from onehop.contracts.ranges import out_of_range
from onehop.wire.codec import REFUSALS

LONGEST_BYTES = 1 << 14
"""A page has no more to say than this at once [B]."""

NEWEST = -1
"""Tick of a frame that is the newest there is."""

Tick = Annotated[int, msgspec.Meta(ge=NEWEST, lt=1 << 32)]
Seconds = Annotated[float, msgspec.Meta(ge=0.0, le=1e6)]


class Request(msgspec.Struct, frozen=True, tag_field="kind", forbid_unknown_fields=True):
    """Anything that a page says."""


class Want(Request, frozen=True, tag="want"):
    """The next frame: of a tick, or the newest as soon as it is newer than `since`.

    since: the tick that is shown. robot: whose scan is wanted, 0 for nobody's.
    """

    tick: Tick
    since: Tick
    robot: Annotated[int, msgspec.Meta(ge=0)] = 0


class Explain(Request, frozen=True, tag="explain"):
    """Why a robot did what it did."""

    robot: int
    at_s: Seconds


class RoadMap(Request, frozen=True, tag="road map"):
    """What a robot that leads had planned last by a tick."""

    robot: int
    tick: Annotated[int, msgspec.Meta(ge=0, lt=1 << 32)]


class Order(Request, frozen=True, tag="order"):
    """A fault, with keys and values as in a scenario. number: of the answer."""

    number: int
    fault: dict[str, Any]


class SetPace(Request, frozen=True, tag="pace"):
    """How fast the mission goes: ticks a second (0: as many as it can), or paused but for some steps."""

    ticks_per_s: Annotated[float, msgspec.Meta(ge=0.0, le=1e6)]
    paused: bool
    steps: Annotated[int, msgspec.Meta(ge=0, le=1000)] = 0


class TakeOver(Request, frozen=True, tag="take over"):
    """The buttons, from whoever has them."""


AnyRequest = Want | Explain | RoadMap | Order | SetPace | TakeOver

_DECODER: msgspec.json.Decoder[AnyRequest] = msgspec.json.Decoder(AnyRequest)


def decode_request(text: str) -> AnyRequest:
    """Raises DecodeError."""
    try:
        return _DECODER.decode(text)
    except REFUSALS as error:
        raise DecodeError(f"no request of a page: {printable(str(error))}") from None


def fault_of(order: Order) -> FaultSection:
    """The fault that is ordered. Raises DecodeError when it cannot be one; the world looks further."""
    if order.fault.get("kind") not in KINDS:
        raise DecodeError(f"no kind of fault; one of {', '.join(KINDS)}")
    try:
        fault = msgspec.convert(order.fault, FaultSection)
    except REFUSALS as error:
        raise DecodeError(printable(str(error))) from None
    begun = fault.begun(0.0)
    for problem in (*out_of_range(begun), *begun.problems()):
        raise DecodeError(f"{problem.key}: {problem.what}; {problem.remedy}")
    return fault
