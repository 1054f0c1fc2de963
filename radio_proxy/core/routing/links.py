"""What a robot knows of its own links: which are good enough to be chosen, and which are broken.

A frame that was heard is no link, and one that was not acknowledged is no break: with a fading of 4 dB
both happen by chance all the time (H. Lundgren, E. Nordström, C. Tschudin, "Coping with communication
gray zones in IEEE 802.11b based ad hoc networks", WoWMoM 2002).
"""

import math
from collections import deque
from dataclasses import dataclass, field

from radio_proxy.core.addresses import RobotId
from radio_proxy.core.data_message import DataPacket

REPEATED_EXCHANGES = 5
"""How often a packet is handed to a link again before the link counts as broken.

A link whose mean is 1 dB above the threshold, with fading of 4 dB, gives up 38 % of its exchanges of
seven attempts, so six in a row are no chance; a neighbour out of reach is given up after 0.2 s.
Differs: RFC 4728, 4.5, has two (MaxMaintRexmt), the link layer's own included; RFC 3561, 6.10, leaves
it to the link layer."""

WORTHWHILE_DB = 3.0
"""Mean SINR above the receive threshold from which a direct link carries more than two hops do: at 17 m
of preset thesis, where fading of 4 dB leaves a direct link the .41 Mb/s of an ideal relay [dB]."""

FADING_DB = 4.0
"""Standard deviation of what one frame says of the mean: the fading of either preset [dB]."""

SAMPLES = 4
"""Frames of a neighbour that its mean is taken over, at most."""

SAMPLE_AGE_NS = 4_000_000_000
"""Older frames say nothing of a robot that moves: at 1 m/s it was 4 m elsewhere [ns]."""


@dataclass(slots=True, eq=False)
class _Link:
    """failures: exchanges in a row that were given up. heard: (time [ns], SINR above threshold [dB])."""

    failures: int = 0
    heard: deque[tuple[int, float]] = field(default_factory=lambda: deque(maxlen=SAMPLES))


class Links:
    """The links of one robot to its neighbours."""

    def __init__(self) -> None:
        self._links: dict[RobotId, _Link] = {}

    def on_heard(self, neighbour: RobotId, margin_db: float, now: int) -> None:
        """A frame of a neighbour was received, so much above the receive threshold."""
        self._of(neighbour).heard.append((now, margin_db))

    def on_acknowledged(self, neighbour: RobotId) -> None:
        """A neighbour acknowledged a packet: the link holds."""
        self._of(neighbour).failures = 0

    def on_given_up(self, packet: object, neighbour: RobotId) -> object | None:
        """What to hand to a link again that gave a packet up; None: the link is broken.

        It is broken when REPEATED_EXCHANGES more of that packet, or of any to that neighbour in a row,
        were in vain, and stays so until something is acknowledged.
        """
        link = self._of(neighbour)
        link.failures += 1
        of_packet = len(packet.given_up) if isinstance(packet, DataPacket) else 0
        if max(link.failures - 1, of_packet) >= REPEATED_EXCHANGES:
            link.heard.clear()
            return None
        return packet.again() if isinstance(packet, DataPacket) else packet

    def is_worthwhile(self, neighbour: RobotId, now: int) -> bool:
        """Whether a direct link may take the place of a route over relays.

        Its mean SINR, less one standard error of the few frames that it is taken over, has to be
        WORTHWHILE_DB above the threshold. RFC 4728, 3.4.3, allows for such a condition.
        """
        heard = [db for time, db in self._of(neighbour).heard if now - time <= SAMPLE_AGE_NS]
        if not heard:
            return False
        return sum(heard) / len(heard) - FADING_DB / math.sqrt(len(heard)) >= WORTHWHILE_DB

    def _of(self, neighbour: RobotId) -> _Link:
        return self._links.setdefault(neighbour, _Link())
