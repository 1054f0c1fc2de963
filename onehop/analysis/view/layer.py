"""Write the viewer layer into a log, beside the wire channels, which stay byte for byte what they were.

A layer that is there already is replaced.
"""

from pathlib import Path

from onehop.analysis.copying import LogCopy
from onehop.analysis.log import Log
from onehop.analysis.view.channels import ViewerChannels
from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.wire.audit import Audit
from onehop.wire.log_reader import LoggedTick, forged
from onehop.wire.log_writer import LOG_EPOCH_NS


def write_view(log: Log, out: Path) -> tuple[dict[str, int], list[str]]:
    """Write log and viewer layer to `out`, which may be the log itself.

    Returns viewer messages by topic, and the flaws of the log (audit.py), which the copy has too. Raises
    LogError when the log is damaged.
    """
    audit = Audit(log.file)
    with LogCopy(out, "with viewer layer") as copy, log.path.open("rb") as stream:
        copy.take_apart(stream, log.file.contents.apart)
        layer = ViewerChannels(log, copy.writer)
        wire = _WireChannels(copy, log.period_ns)
        try:
            for tick in audit.ticks():
                wire.add(tick)
                layer.add(tick)
        except DecodeError as error:
            raise forged(log.path, error) from None
        copy.finish()
    return dict(sorted(layer.counts.items())), audit.flaws


class _WireChannels:
    """Copies the wire messages of each tick."""

    def __init__(self, copy: LogCopy, period_ns: int) -> None:
        self._copy = copy
        self._writer = copy.writer
        self._period_ns = period_ns
        self._channels: dict[str, int] = {}
        self._last_tick = -1

    def add(self, tick: LoggedTick) -> None:
        if tick.tick != self._last_tick + 1:
            self._copy.settle()
        self._last_tick = tick.tick
        stamp = LOG_EPOCH_NS + tick.tick * self._period_ns
        for key, data in tick.messages:
            channel = self._channels.get(key)
            if channel is None:
                channel = self._writer.register_channel(topics.wire(key), "msgpack", 0)
                self._channels[key] = channel
            self._writer.add_message(channel, stamp, data, stamp, tick.tick)
