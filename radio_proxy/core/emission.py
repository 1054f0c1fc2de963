"""One frame on the air, and what is on record about it at those who hear it."""

from dataclasses import dataclass, field

from msgspec import Struct

from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.addresses import StationIndex
from radio_proxy.core.event_queue import NEVER

Judgement = tuple[DeliveryStatus | None, float]
"""What kept a frame from being received (None: nothing), and its lowest SINR [dB]."""


@dataclass(slots=True, eq=False)
class Reception:
    """A frame at its receivers; kept only of frames that overlap others, or that somebody overheard.

    overlaps: every other emission that was in progress meanwhile. levels_db: received power at a
    station, over the noise floor, fading included. deaf: stations that could not receive it, because
    they transmitted or were locked on another frame. locked: stations that locked on it; None until the
    time of preamble detection is over. headers: whether a locked station could read the PLCP header.
    judged: how the frame ended.
    """

    overlaps: list["Emission"] = field(default_factory=list)
    levels_db: dict[StationIndex, float] = field(default_factory=dict)
    deaf: set[StationIndex] = field(default_factory=set)
    locked: list[StationIndex] | None = None
    headers: dict[StationIndex, bool] = field(default_factory=dict)
    judged: dict[StationIndex, Judgement] = field(default_factory=dict)


class Emission(Struct, eq=False):
    """One frame that is transmitted from `start` to `end` [ns]; end is NEVER while it is in progress.

    receiver: its addressee or EVERYONE. rate_mbps, bits: of the MAC frame, after the PLCP header.
    row: mean SNR at every station [dB]. fade_db: draw for the whole exchange, or None for a draw of its
    own at every station.
    """

    source: StationIndex
    receiver: StationIndex
    rate_mbps: float
    bits: int
    row: list[float]
    fade_db: float | None
    start: int
    end: int = NEVER
    reception: Reception | None = None
