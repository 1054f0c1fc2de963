"""When a frame is given up, and how the contention window grows (802.11-1999, 9.2.4 and 9.2.5.3).

A failed RTS, and a failed data frame that was sent without one, count to the short retry count; a failed
data frame after RTS and CTS to the long one. A CTS resets the short count. Each failure doubles the
window; a success, and a count that reaches its limit, reset it.
Differs: a station's own counts are those of the frame that it serves, because it serves one at a time;
the standard keeps the long count over a frame that was given up by its short one.
"""

from radio_proxy.core.contention import Frame, Station
from radio_proxy.core.link_rules import LinkRules


class Retries:
    """The counting rules in force.

    As in ns-3 a frame that is given up leaves the window as it is, the next failure resets it, and a
    broadcast changes nothing.
    """

    def __init__(self, rules: LinkRules) -> None:
        self._limits = rules.retries
        self._as_ns3 = rules.as_ns3

    def on_cts(self, frame: Frame) -> None:
        """The RTS of a frame was answered."""
        frame.short_retries = 0

    def on_failure(self, station: Station, frame: Frame, after_cts: bool) -> bool:
        """A frame was not answered; returns whether it is given up."""
        limits = self._limits
        if after_cts:
            frame.long_retries += 1
        else:
            frame.short_retries += 1
        if limits.single is not None:
            given_up = frame.attempts >= limits.single
        else:
            given_up = frame.short_retries >= limits.short or frame.long_retries >= limits.long
        if self._as_ns3:
            limit = limits.short if limits.single is None else limits.single
            station.failures = station.failures + 1 if station.failures < limit else 0
        else:
            station.failures = 0 if given_up else station.failures + 1
        return given_up

    def on_broadcast(self, station: Station) -> None:
        """A frame was sent to everyone."""
        if not self._as_ns3:
            station.failures = 0
