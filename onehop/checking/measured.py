"""What a trace of measured links says of a link at a time, worked out anew (docs/link-traces.md)."""

import math

import numpy as np

from onehop.contracts.arrays import FloatArray
from onehop.contracts.link_trace import LinkTrace
from onehop.contracts.radio_section import RadioSection


class Measured:
    """A trace. is_all: a link that it does not have is none.

    unweakened_db: SNR of a signal that loses nothing on its way. noise_dbm: floor.
    """

    def __init__(
        self, trace: LinkTrace, radio: RadioSection, unweakened_db: float, noise_dbm: float
    ) -> None:
        self.is_all = radio.links_use == "instead"
        self._quantity = trace.quantity
        self._unweakened_db, self._noise_dbm = unweakened_db, noise_dbm
        self._series = {
            (one.sender, one.receiver): (
                np.array(one.times_ns, dtype=np.float64),
                np.array([np.nan if v is None else v for v in one.values_db], dtype=np.float64),
            )
            for one in trace.series
        }

    def matrix_db(self, robots: tuple[int, ...], time_ns: int, modelled: FloatArray) -> FloatArray:
        """Mean SNR of rows at columns [dB]. modelled: what it is without a trace."""
        snr = np.full(modelled.shape, -math.inf) if self.is_all else modelled.copy()
        row = {robot: number for number, robot in enumerate(robots)}
        for sender, receiver in self._series:
            place = row[sender], row[receiver]
            snr[place] = self.mean_db(sender, receiver, time_ns, float(modelled[place]))
        return snr

    def mean_db(self, sender: int, receiver: int, time_ns: int, modelled_db: float) -> float:
        """Mean SNR of a link; modelled_db: what it is without a trace."""
        series = self._series.get((sender, receiver))
        if series is None:
            return -math.inf if self.is_all else modelled_db
        value = _at(*series, float(time_ns))
        if math.isnan(value):
            return -math.inf
        if not self.is_all:
            return modelled_db - value
        if self._quantity == "snr_db":
            return value
        return value - self._noise_dbm if self._quantity == "rssi_dbm" else self._unweakened_db - value


def _at(times: FloatArray, values: FloatArray, time: float) -> float:
    """Linear between two values; nan from a nan on, and no way to or from one."""
    last = int(np.searchsorted(times, time, side="right")) - 1
    here = float(values[max(last, 0)])
    if last < 0 or last + 1 == len(times) or math.isnan(values[last + 1]):
        return here
    return float(np.interp(time, times[last : last + 2], values[last : last + 2]))
