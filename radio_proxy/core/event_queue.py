"""The radio's clock: one queue of events that the DCF and the timers of routing share.

Events happen in order of time; those of one instant in the order in which they were scheduled. When a
station may next transmit moves too often to be queued: it is asked for before every event, and comes
after all events of its instant.
"""

import heapq
from collections.abc import Callable
from typing import Any, Protocol

NEVER = 1 << 62
"""A time that does not come [ns]."""

Callback = Callable[[Any, int], None]
"""Called with the argument it was scheduled with and the time [ns]."""


class ChannelAccess(Protocol):
    """Who waits for the medium. next_access: when one of them transmits unless it is deferred [ns]."""

    next_access: int


class EventQueue:
    """Events to come. horizon: up to when the current run goes; no fault or pose changes before [ns].

    on_access: called with the time when a station of `access` is to transmit [ns].
    """

    def __init__(self, access: ChannelAccess, on_access: Callable[[int], None]) -> None:
        self.horizon = 0
        self._access = access
        self._on_access = on_access
        self._events: list[tuple[int, int, Callback, Any]] = []
        self._sequence = 0

    def at(self, time_ns: int, event: Callback, argument: Any) -> None:
        """Call event(argument, time_ns) at that time."""
        self._sequence += 1
        heapq.heappush(self._events, (time_ns, self._sequence, event, argument))

    def next(self) -> int:
        """When something happens next [ns], NEVER if nothing does."""
        return min(self._events[0][0] if self._events else NEVER, self._access.next_access)

    def run(self, until: int) -> None:
        """Everything that happens up to and including `until` [ns]."""
        self.horizon = until
        self._run(until)

    def follow(self, until: int) -> None:
        """The same where at any instant behind it anything may come: what happens up to now is all.

        So it makes no difference by which steps an instant is reached.
        """
        self.horizon = 0
        self._run(until)

    def _run(self, until: int) -> None:
        events, access, on_access = self._events, self._access, self._on_access
        while True:
            time_ns = events[0][0] if events else NEVER
            if access.next_access < time_ns:
                if access.next_access > until:
                    return
                on_access(access.next_access)
            else:
                if time_ns > until:
                    return
                _, _, event, argument = heapq.heappop(events)
                event(argument, time_ns)
