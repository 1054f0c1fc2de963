"""Links that were measured: they take the place of the propagation model, or weaken what it says.

Between two rows of a link its value changes linearly in dB; before the first and after the last it is
theirs. From a row without a value on nothing gets through, until the next row. Within a tick, where
robots have one place, a link has one value: that of its end.
"""

from bisect import bisect_right

from onehop.contracts.link_trace import LinkSeries, LinkTrace
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.link_budget import LinkBudget, free_space_loss_db


class MeasuredLinks:
    """The trace of a mission. is_all: a link that the trace does not have is none."""

    def __init__(self, trace: LinkTrace, section: RadioSection, budget: LinkBudget) -> None:
        self.is_all = section.links_use == "instead"
        self._sign, self._from_db = _to_snr(trace.quantity, section, budget)
        self._series: dict[int, list[LinkSeries]] = {}
        for one in trace.series:
            self._series.setdefault(one.sender, []).append(one)

    def snr_db(self, sender: int, time_ns: int) -> dict[int, float | None]:
        """Mean SNR at each robot that the trace has of a sender [dB]; None: nothing gets through."""
        return {
            receiver: None if value is None else self._from_db + self._sign * value
            for receiver, value in self._values(sender, time_ns)
        }

    def loss_db(self, sender: int, time_ns: int) -> dict[int, float | None]:
        """What each of these links loses beside what the model says [dB]; None: everything."""
        return dict(self._values(sender, time_ns))

    def _values(self, sender: int, time_ns: int) -> list[tuple[int, float | None]]:
        return [(one.receiver, value_at(one, time_ns)) for one in self._series.get(sender, ())]


def value_at(series: LinkSeries, time_ns: int) -> float | None:
    """The value of a link at a time."""
    times, values = series.times_ns, series.values_db
    after = bisect_right(times, time_ns)
    if after == 0:
        return values[0]
    before = values[after - 1]
    following = values[after] if after < len(times) else None
    if before is None or following is None:
        return before
    share = (time_ns - times[after - 1]) / (times[after] - times[after - 1])
    return before + share * (following - before)


def _to_snr(quantity: str, section: RadioSection, budget: LinkBudget) -> tuple[float, float]:
    """Sign and offset that make an SNR of what was measured [dB]."""
    if quantity == "snr_db":
        return 1.0, 0.0
    if quantity == "rssi_dbm":
        return 1.0, -budget.noise_dbm
    nearest = free_space_loss_db(section.reference_distance, section.frequency_hz)
    return -1.0, budget.snr_reference_db + nearest
