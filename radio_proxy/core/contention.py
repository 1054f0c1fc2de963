"""Who may transmit when: carrier sense, DIFS or EIFS, and a backoff that freezes (802.11-1999, 9.2.5).

Differs: a station that finds the medium idle waits a whole DIFS from that moment, because both measured
references (ns-3's idle exchange of 7.542 ms, thesis eq. 3.16) count it. A frame enqueued in the same
instant as another station's draws a backoff, because ticks would otherwise make them collide always.
"""

from collections import deque
from dataclasses import dataclass, field

from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.addresses import EVERYONE, StationIndex
from radio_proxy.core.airtime import Timing
from radio_proxy.core.draws import Draws
from radio_proxy.core.emission import Emission
from radio_proxy.core.event_queue import NEVER
from radio_proxy.core.link_rules import LinkRules
from radio_proxy.core.medium import Medium

WINDOWS = 12
"""Contention windows that are computed in advance; the last is the largest of every PHY here."""


@dataclass(slots=True, eq=False)
class Frame:
    """One MSDU for one hop. receiver: a station or EVERYONE; packet: opaque to this layer.

    urgent: a routing packet, served before data. expires: when it is not worth sending any more [ns].
    service_start: when it became the head of its queue [ns]. attempts: transmissions so far;
    short_retries, long_retries: its retry counts (retries.py). received: its data has arrived, with or
    without an ACK. sinr_db, cause: of its last RTS, CTS, data or ACK that was judged; cause is None if
    that one was received.
    """

    receiver: StationIndex
    msdu_bytes: int
    packet: object
    urgent: bool = False
    expires: int = NEVER
    service_start: int = -1
    attempts: int = 0
    short_retries: int = 0
    long_retries: int = 0
    received: bool = False
    sinr_db: float = 0.0
    cause: DeliveryStatus | None = None


@dataclass(slots=True, eq=False)
class Station:
    """A station. urgent, queue: routing packets and data that wait, each first in, first out.

    frame: the one in service. failures: how often its contention window has doubled. slots: backoff
    left. access: when it will transmit, NEVER while frozen [ns]. idle_start: from when its DIFS counts
    [ns]; eifs_end: it does not count before, because a frame was received with errors [ns].
    contending: it waits for the medium. fresh: its frame found the medium idle, so it has drawn no
    backoff. gone: its robot left the mission; events that still name it are void.
    """

    index: StationIndex
    urgent: deque[Frame] = field(default_factory=deque)
    queue: deque[Frame] = field(default_factory=deque)
    frame: Frame | None = None
    failures: int = 0
    slots: int = 0
    access: int = NEVER
    idle_start: int = 0
    eifs_end: int = 0
    contending: bool = False
    fresh: bool = False
    gone: bool = False


class Contention:
    """The stations that wait for the medium; next_station transmits at next_access unless it freezes.

    minds_errors: somebody waits, or is to wait, for EIFS.
    """

    def __init__(self, timing: Timing, medium: Medium, draws: Draws, rules: LinkRules) -> None:
        self.next_access = NEVER
        self.next_station: Station | None = None
        self._timing = timing
        self._medium = medium
        self._draws = draws
        self._sense_db = medium.propagation.budget.carrier_sense_db
        self._difs, self._slot = timing.difs, timing.slot
        self._windows = [timing.window(failures) for failures in range(WINDOWS)]
        self._waiting: list[Station] = []
        self._after_error = timing.sifs + timing.ack
        self._errs_at_end = rules.as_ns3
        self.minds_errors = False
        self._erred: list[Station] = []
        self._deferring: list[Station] = []
        self._eifs_latest = 0

    def join_with_frame(self, station: Station, now: int, force_backoff: bool) -> None:
        """A frame comes into service: after DIFS if the medium is idle, else after a backoff as well."""
        medium, index = self._medium, station.index
        if force_backoff or medium.is_busy(index) or medium.nav.until(index, now) > now:
            self.join(station, now)
        else:
            station.slots = 0
            station.fresh = True
            self._enter(station, now)

    def join(self, station: Station, now: int) -> None:
        """Wait with a backoff out of the station's window."""
        self._draw_backoff(station)
        self._enter(station, now)

    def take_next(self) -> Station:
        """The station whose wait is over; on_busy or find_next must follow."""
        station = self.next_station
        assert station is not None
        self._drop(station)
        return station

    def leave(self, station: Station) -> None:
        """The station left the mission."""
        self._drop(station)
        self.find_next()

    def find_next(self) -> None:
        """Find who transmits next, after somebody stopped waiting."""
        self.next_access, self.next_station = NEVER, None
        for station in self._waiting:
            if station.access < self.next_access:
                self.next_access, self.next_station = station.access, station

    def on_busy(self, emission: Emission, now: int) -> None:
        """An emission begins: who senses it keeps the slots that have not passed (9.2.5.2).

        A station that is to transmit within its turnaround time cannot sense it any more and collides.
        """
        if self.next_station is None:
            return
        row, sense_db, medium = emission.row, self._sense_db, self._medium
        committed = now + self._timing.turnaround
        next_access, next_station = NEVER, None
        for station in self._waiting:
            access = station.access
            if access == NEVER:
                continue
            if access > committed and (
                row[station.index] >= sense_db
                or (medium.detects_energy and medium.is_busy(station.index))
            ):
                self._freeze(station, now, emission.source)
            elif access < next_access:
                next_access, next_station = access, station
        self.next_access, self.next_station = next_access, next_station

    def on_frame_end(self, emission: Emission, erring: list[Station], now: int) -> None:
        """A frame has ended, which some received with errors: EIFS for them (802.11-1999, 9.2.3.4).

        It begins when the medium is idle after the frame, in ns-3 at its end; to receive another frame
        without error ends it.
        """
        received = self._medium.receivers.has_received
        for stations in (self._erred, self._deferring):
            for station in stations:
                if station.eifs_end > now and received(emission, station.index):
                    station.eifs_end = now
        erred = [s for s in self._erred if s.eifs_end > now] + erring
        for station in erring:
            station.eifs_end = NEVER
        idle = [s for s in erred if self._errs_at_end or not self._medium.is_busy(s.index)]
        for station in idle:
            station.eifs_end = self._eifs_latest = now + self._after_error
        self._erred = [s for s in erred if s.eifs_end == NEVER]
        self._deferring = [s for s in self._deferring if s.eifs_end > now] + idle
        self.minds_errors = bool(self._erred or self._deferring)

    def reassess(self, now: int) -> None:
        """Who moves or is jammed may find the medium busy or idle although no frame began or ended."""
        for station in self._waiting:
            busy = self._medium.is_busy(station.index)
            if station.access == NEVER and not busy:
                self._resume(station, now)
            elif station.access != NEVER and busy:
                self._freeze(station, now, EVERYONE)
        self.find_next()

    def on_idle(self, now: int, response: list[float] | None = None) -> None:
        """An emission has ended; whoever now finds the medium idle goes on.

        response: mean SNR at every station of a CTS, data or ACK that follows after a SIFS [dB]; who
        senses it does not even start, for SIFS is shorter than DIFS.
        """
        medium, sense_db = self._medium, self._sense_db
        if response is None and not medium.emissions:
            deferring = medium.nav.latest > now or self._eifs_latest > now
            if not deferring and not medium.detects_energy:
                self._resume_all(now)
                return
        for station in self._waiting:
            if station.access != NEVER or (response is not None and response[station.index] >= sense_db):
                continue
            if not medium.is_busy(station.index):
                self._resume(station, now)

    def on_nav_reset(self, now: int) -> None:
        """A reservation was cancelled: nobody waits for its end any more."""
        for station in self._waiting:
            if station.access != NEVER and station.idle_start > now:
                self._resume(station, now)
        self.find_next()

    def _draw_backoff(self, station: Station) -> None:
        failures = station.failures
        window = self._windows[failures] if failures < WINDOWS else self._windows[-1]
        station.slots = self._draws.slots(window)

    def _drop(self, station: Station) -> None:
        station.contending = station.fresh = False
        station.slots = 0
        station.access = NEVER
        self._waiting.remove(station)

    def _enter(self, station: Station, now: int) -> None:
        station.contending = True
        station.access = NEVER
        self._waiting.append(station)
        if not self._medium.is_busy(station.index):
            self._resume(station, now)

    def _resume_all(self, now: int) -> None:
        """The medium is idle everywhere and nobody has reserved it: `_resume` for all that froze."""
        next_access, next_station = self.next_access, self.next_station
        after_difs, slot = now + self._difs, self._slot
        for station in self._waiting:
            if station.access == NEVER:
                station.idle_start = now
                station.access = access = after_difs + station.slots * slot
                if access < next_access:
                    next_access, next_station = access, station
        self.next_access, self.next_station = next_access, next_station

    def _resume(self, station: Station, now: int) -> None:
        start = now if station.eifs_end <= now else station.eifs_end
        nav = self._medium.nav
        if nav.latest > start:
            start = nav.until(station.index, start)
        station.idle_start = start
        station.access = access = start + self._difs + station.slots * self._slot
        if access < self.next_access:
            self.next_access, self.next_station = access, station

    def _freeze(self, station: Station, now: int, source: StationIndex) -> None:
        elapsed = now - station.idle_start - self._difs
        if elapsed > 0:
            station.slots -= elapsed // self._slot
        if station.fresh and source != station.index:
            station.fresh = False
            self._draw_backoff(station)
        station.access = NEVER
