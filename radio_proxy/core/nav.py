"""Virtual carrier sense: the network allocation vector (802.11-1999, 9.2.5.4).

A duration field holds for every station that received the frame that bore it. Which those are is found
out when somebody asks.
"""

from dataclasses import dataclass, field

from radio_proxy.core.addresses import StationIndex
from radio_proxy.core.emission import Emission
from radio_proxy.core.reception import Receivers


@dataclass(slots=True, eq=False)
class Reservation:
    """A duration field: the NAV of every station that received it is set to `until` [ns].

    later: frames that began since it was set; of an RTS only. void_from: when the NAV of those to whom
    none of them was indicated by then is reset [ns], -1 before.
    """

    until: int
    emission: Emission
    later: list[Emission] = field(default_factory=list)
    void_from: int = -1


class Reservations:
    """The NAV of every station. latest: no reservation ends later [ns].

    watching: reservations of an RTS for which it matters what follows.
    """

    def __init__(self, receivers: Receivers) -> None:
        self.latest = 0
        self._receivers = receivers
        self._reservations: list[Reservation] = []
        self.watching: list[Reservation] = []

    def reserve(self, emission: Emission, until: int, now: int) -> Reservation | None:
        """Set the NAV of every station that received this frame, but for its addressee; None: nobody."""
        reception = emission.reception
        if reception is not None and reception.locked == []:
            return None
        self._reservations = [r for r in self._reservations if r.until > now]
        reservation = Reservation(until, emission)
        self._reservations.append(reservation)
        self.latest = max(self.latest, until)
        return reservation

    def watch(self, reservation: Reservation) -> None:
        """Note from now on which frames follow an RTS."""
        self.watching.append(reservation)

    def on_begin(self, emission: Emission) -> None:
        """A frame begins."""
        for reservation in self.watching:
            reservation.later.append(emission)

    def reset(self, reservation: Reservation, now: int) -> None:
        """Reset the NAV of those to whom PHY-RXSTART has not been indicated since an RTS."""
        self.watching.remove(reservation)
        reservation.void_from = now

    def until(self, station: StationIndex, now: int) -> int:
        """The NAV of a station: end of the reservations that it overheard, `now` without any [ns]."""
        until = now
        if self.latest <= now:
            return now
        for reservation in self._reservations:
            if reservation.until > until and self._holds(reservation, station):
                until = reservation.until
        return until

    def _holds(self, reservation: Reservation, station: StationIndex) -> bool:
        emission, receivers = reservation.emission, self._receivers
        if station in (emission.source, emission.receiver):
            return False
        if not receivers.has_received(emission, station):
            return False
        void_from = reservation.void_from
        return void_from < 0 or any(
            receivers.has_started(later, station, void_from) for later in reservation.later
        )
