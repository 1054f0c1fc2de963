"""The wireless medium: which emissions overlap, who senses them, and who receives them.

A frame is received when its SINR (thesis eq. 3.23: floor, jams and every overlapping emission) reaches
the receive threshold and its bits survive the modulation's error rate.
Differs: an overlap counts over the whole frame and interferers at their mean power, because a frame
that was touched at all needs the threshold at its worst moment. Overheard reservations (NAV) are judged
at mean power too, because beyond carrier sense only they matter, and a draw for every station that
overhears a frame would cost more than the rest of the model.
"""

from dataclasses import dataclass

from onehop.contracts import elementary
from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.addresses import StationIndex
from radio_proxy.core.draws import Draws
from radio_proxy.core.error_rates import CERTAIN_SINR_DB, frame_success
from radio_proxy.core.propagation import SILENT_DB, Propagation


@dataclass(slots=True, eq=False)
class Emission:
    """One frame that is being transmitted, from begin() to end(). row: mean SNR at every station [dB].

    fade_db: draw for the whole exchange, or None for a draw of its own at every reception.
    overlaps: rows of every other emission that was in progress meanwhile.
    """

    source: StationIndex
    row: list[float]
    fade_db: float | None
    overlaps: tuple[list[float], ...] = ()


@dataclass(slots=True, eq=False)
class Reservation:
    """A duration field: the NAV of every station that overhears it is set to `until` [ns]."""

    until: int
    emission: Emission
    source: StationIndex
    receiver: StationIndex


class Medium:
    """Emissions in progress, and the reservations that they announced.

    reserved_to: no reservation ends later [ns].
    """

    def __init__(self, propagation: Propagation, draws: Draws) -> None:
        self.propagation = propagation
        self.emissions: list[Emission] = []
        self._reservations: list[Reservation] = []
        self.reserved_to = 0
        self._draws = draws
        self._sense_db = propagation.budget.carrier_sense_db
        self._threshold_db = propagation.budget.receive_threshold_db
        self._sigma_db = propagation.budget.shadowing_db

    def fade_db(self) -> float:
        """One draw of the log-normal fading [dB]."""
        return self._sigma_db * self._draws.normal() if self._sigma_db else 0.0

    def begin(self, source: StationIndex, fade_db: float | None, now: int) -> Emission:
        """Start a transmission; it and every other one in progress interfere with each other."""
        emission = Emission(source, self.propagation.snr_row(source, now), fade_db)
        for other in self.emissions:
            other.overlaps += (emission.row,)
            emission.overlaps += (other.row,)
        self.emissions.append(emission)
        return emission

    def end(self, emission: Emission) -> None:
        """A transmission is over."""
        self.emissions.remove(emission)

    def is_busy(self, station: StationIndex) -> bool:
        """Physical carrier sense (802.11-1999, 15.4.8.4, CCA mode 2: a jam is no DSSS signal)."""
        for emission in self.emissions:  # noqa: SIM110 (any() makes a generator of what is mostly empty)
            if emission.row[station] >= self._sense_db:
                return True
        return False

    def reserve(
        self,
        emission: Emission,
        source: StationIndex,
        receiver: StationIndex,
        until: int,
        now: int,
    ) -> Reservation:
        """Set the NAV of every station that overhears this emission (802.11-1999, 9.2.5.4)."""
        self._reservations = [r for r in self._reservations if r.until > now]
        reservation = Reservation(until, emission, source, receiver)
        self._reservations.append(reservation)
        self.reserved_to = max(self.reserved_to, until)
        return reservation

    def reset_nav(self, reservation: Reservation) -> None:
        """Cancel a reservation whose RTS no CTS followed (802.11-1999, 9.2.5.4)."""
        if reservation in self._reservations:
            self._reservations.remove(reservation)

    def reserved_until(self, station: StationIndex, now: int) -> int:
        """The NAV of a station: end of the reservations that it overheard, `now` without any [ns]."""
        until = now
        if self.reserved_to <= now:
            return now
        for reservation in self._reservations:
            if (
                reservation.until > until
                and station not in (reservation.source, reservation.receiver)
                and self._mean_sinr_db(reservation.emission, station) >= self._threshold_db
            ):
                until = reservation.until
        return until

    def receive(
        self, emission: Emission, station: StationIndex, rate_mbps: float, bits: int
    ) -> tuple[DeliveryStatus | None, float]:
        """What keeps a station from receiving a frame (None: nothing), and its SINR [dB].

        A collision is what would have reached the threshold without the emissions that overlap it.
        """
        mean_db = emission.row[station]
        if mean_db <= SILENT_DB:
            return DeliveryStatus.BELOW_THRESHOLD, SILENT_DB
        fade_db = emission.fade_db
        if fade_db is None:
            fade_db = self._sigma_db * self._draws.normal() if self._sigma_db else 0.0
        alone_db = mean_db + fade_db - self.propagation.noise_rise_db[station]
        sinr_db = alone_db
        if emission.overlaps:
            sinr_db = self._mean_sinr_db(emission, station) + fade_db
        if sinr_db < self._threshold_db:
            collided = alone_db >= self._threshold_db
            return (DeliveryStatus.COLLISION if collided else DeliveryStatus.BELOW_THRESHOLD), sinr_db
        if sinr_db >= CERTAIN_SINR_DB:
            return None, sinr_db
        lost = self._draws.uniform() >= frame_success(rate_mbps, sinr_db, bits)
        return (DeliveryStatus.BIT_ERRORS if lost else None), sinr_db

    def _mean_sinr_db(self, emission: Emission, station: StationIndex) -> float:
        rise_db = self.propagation.noise_rise_db[station]
        if emission.overlaps:
            noise = elementary.power_of_ten(rise_db / 10.0)
            for row in emission.overlaps:
                noise += elementary.power_of_ten(row[station] / 10.0)
            rise_db = 10.0 * elementary.log10(noise)
        return emission.row[station] - rise_db
