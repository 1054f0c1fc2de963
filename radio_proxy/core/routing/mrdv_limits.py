"""Timers and limits of AODV under the names of RFC 3561, section 10, and who counts by them."""

from collections import deque

from radio_proxy.core.addresses import RobotId
from radio_proxy.core.routing.mrdv_packets import Rreq
from radio_proxy.core.routing.mrdv_table import ACTIVE_ROUTE_NS, MS

NODE_TRAVERSAL_NS = 40 * MS
"""Time of a hop, waiting and processing included [ns]."""

NET_DIAMETER = 35
"""Most hops between two robots."""

NET_TRAVERSAL_NS = 2 * NODE_TRAVERSAL_NS * NET_DIAMETER
"""How long a request through the whole network waits for its reply [ns]."""

PATH_DISCOVERY_NS = 2 * NET_TRAVERSAL_NS
"""How long a request is remembered, lest it be passed on twice [ns]."""

MY_ROUTE_NS = 2 * ACTIVE_ROUTE_NS
"""Lifetime that a destination gives the route to itself [ns]."""

TTL_START, TTL_INCREMENT, TTL_THRESHOLD = 1, 2, 7
"""The expanding ring search: first ring, step and last ring [hops]."""

TIMEOUT_BUFFER = 2
"""Hops that the timeout of a ring allows for congestion."""

RREQ_RETRIES = 2
"""Repetitions of a request through the whole network."""

RATE_LIMIT = 10
"""RREQ_RATELIMIT and RERR_RATELIMIT: packets of each kind that a robot originates [1/s]."""

SECOND_NS = 1000 * MS

WEAK_REQUEST_WAIT_NS = 20 * MS
"""How long a request that came over a weak link waits for a copy over two better ones: two jitters
[ns]."""

BUFFER_MESSAGES = 64
"""Messages that wait for routes; the newest is dropped when it is full (size of RFC 4728, 4.2)."""


class RateLimit:
    """RREQ_RATELIMIT or RERR_RATELIMIT of one robot."""

    def __init__(self) -> None:
        self._sent: deque[int] = deque()

    def next_allowed(self, now: int) -> int:
        """When one more may be sent: now (then it counts), or later."""
        while self._sent and self._sent[0] <= now - SECOND_NS:
            self._sent.popleft()
        if len(self._sent) >= RATE_LIMIT:
            return self._sent[0] + SECOND_NS
        self._sent.append(now)
        return now


class SeenRequests:
    """The requests that one robot has sent or taken within PATH_DISCOVERY_TIME (RFC 3561, 6.5)."""

    def __init__(self) -> None:
        self._until: dict[tuple[RobotId, int], int] = {}

    def is_new(self, request: Rreq, now: int) -> bool:
        """Note a request; whether it was not there yet."""
        while self._until and next(iter(self._until.values())) <= now:
            del self._until[next(iter(self._until))]
        key = (request.origin, request.number)
        if key in self._until:
            return False
        self._until[key] = now + PATH_DISCOVERY_NS
        return True
