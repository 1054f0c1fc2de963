"""Automatic route shortening of DSR (RFC 4728, 3.4.3, 4.4 and 8.1.5).

Who overhears data that is still to come to it over others tells the robot whose source route it is that
these are needless: a gratuitous ROUTE REPLY with the shorter route.
"""

from radio_proxy.core.addresses import RobotId
from radio_proxy.core.data_message import DataPacket
from radio_proxy.core.routing.mrsr_packets import Rrep

GRATUITOUS = 0
"""Number of a reply that no request asked for; requests count from 1."""

GRAT_REPLY_HOLDOFF_NS = 1_000_000_000
"""GratReplyHoldoff: how long nothing is replied to the same robot for the same transmitter
(RFC 4728, section 9) [ns]."""


class GratuitousReplies:
    """The Gratuitous Route Reply Table of one robot (4.4): until when each pair is held off [ns]."""

    def __init__(self, robot: RobotId) -> None:
        self._robot = robot
        self._held_off: dict[tuple[RobotId, RobotId], int] = {}

    def reply_to(self, data: DataPacket, sender: RobotId, now: int) -> Rrep | None:
        """The reply that shortens the route of overheard data; None while it is held off.

        It goes to the robot whose route the data carries: its source, or who has salvaged it.
        """
        route = data.route
        pair = (route[0], sender)
        if self._held_off.get(pair, now) > now:
            return None
        self._held_off[pair] = now + GRAT_REPLY_HOLDOFF_NS
        until_sender = route[: route.index(sender) + 1]
        found = until_sender + route[route.index(self._robot) :]
        return Rrep(GRATUITOUS, found, (self._robot, *until_sender[::-1]))
