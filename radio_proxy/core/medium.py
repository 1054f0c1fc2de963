"""The wireless medium: what is on the air, who senses it, and what became of it at its receivers.

Carrier sense and energy detection go by mean powers; a draw for every station that senses a frame would
cost more than the rest of the model.
"""

from onehop.contracts import elementary
from radio_proxy.core.addresses import StationIndex
from radio_proxy.core.draws import Draws
from radio_proxy.core.emission import Emission
from radio_proxy.core.link_rules import LinkRules
from radio_proxy.core.nav import Reservations
from radio_proxy.core.propagation import Propagation
from radio_proxy.core.reception import Receivers


class Medium:
    """Emissions in progress. receivers: who is locked on which; nav: who reserved the medium.

    detects_energy: energy alone makes the medium busy.
    """

    def __init__(self, propagation: Propagation, draws: Draws, rules: LinkRules) -> None:
        self.propagation = propagation
        self.emissions: list[Emission] = []
        self.receivers = Receivers(propagation, draws, rules)
        self.nav = Reservations(self.receivers)
        self._sense_db = propagation.budget.carrier_sense_db
        self.detects_energy = rules.energy_detect_db is not None
        self._energy = elementary.power_of_ten((rules.energy_detect_db or 0.0) / 10.0)

    def begin(self, emission: Emission) -> None:
        """Start a transmission; it and every other one in progress interfere with each other."""
        if self.emissions:
            self.receivers.overlap(emission, self.emissions)
        self.emissions.append(emission)
        if self.nav.watching:
            self.nav.on_begin(emission)

    def end(self, emission: Emission, now: int) -> list[StationIndex]:
        """A transmission is over; returns the stations that received it with errors."""
        emission.end = now
        receivers, errors = self.receivers, []
        if emission.reception is not None or not receivers.locks_are_certain:
            errors = receivers.finish(emission, self.emissions)
        self.emissions.remove(emission)
        return errors

    def is_busy(self, station: StationIndex) -> bool:
        """Physical carrier sense (802.11-1999, 15.4.8.4): carriers, and energy if it is detected."""
        for emission in self.emissions:
            if emission.row[station] >= self._sense_db:
                return True
        return self.detects_energy and self._received_energy(station) >= self._energy

    def _received_energy(self, station: StationIndex) -> float:
        """Mean power at a station of all frames and jams over the noise floor."""
        energy = elementary.power_of_ten(self.propagation.noise_rise(station) / 10.0) - 1.0
        for emission in self.emissions:
            energy += elementary.power_of_ten(emission.row[station] / 10.0)
        return energy
