"""Links as somebody measured them: each direction of each link over time (docs/link-traces.md)."""

from onehop.contracts.values import Value

QUANTITIES = ("snr_db", "rssi_dbm", "loss_db")
"""What a trace may tell: SNR, received power, or loss on the way, by the name of its column."""


class LinkSeries(Value, frozen=True):
    """One direction of one link. times_ns: rising. values_db: None from where the link was lost."""

    sender: int
    receiver: int
    times_ns: tuple[int, ...]
    values_db: tuple[float | None, ...]


class LinkTrace(Value, frozen=True):
    """What was measured. quantity: one of QUANTITIES. series: by sender and receiver, each pair once."""

    quantity: str
    series: tuple[LinkSeries, ...]
