"""Write the viewer layer into a log, beside the wire channels, which stay byte for byte what they were.

A layer that is there already is replaced.
"""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mcap.exceptions import EndOfFile
from mcap.records import Channel, Message, Metadata, Schema
from mcap.stream_reader import StreamReader

from onehop.analysis.copying import LogCopy
from onehop.analysis.log import Log
from onehop.analysis.view.channels import ViewerChannels
from onehop.contracts import topics

_WIRE = topics.wire("")


def write_view(log: Log, out: Path) -> dict[str, int]:
    """Write log and viewer layer to `out`, which may be the log itself; returns messages by topic.

    Whatever the log was, the copy is sound.
    """
    with LogCopy(out, "with viewer layer") as copy:
        layer = ViewerChannels(log, copy)
        _copy_with(layer, log, copy)
        copy.finish()
    return dict(sorted(layer.counts.items()))


def _copy_with(layer: ViewerChannels, log: Log, copy: LogCopy) -> None:
    """Everything of the log but an old layer, and after each tick what the new layer makes of it."""
    tick, messages = -1, list[Message]()
    for record in _records(log.path):
        if isinstance(record, Message):
            if record.channel_id not in copy.keys:
                continue
            if record.sequence != tick:
                layer.add(tick, messages)
                tick, messages = record.sequence, []
            messages.append(record)
            copy.take_message(record)
        elif not _is_viewers(record):
            if isinstance(record, Metadata) and record.name == "outcome":
                layer.add(tick, messages)
                messages = []
            copy.take(record)
    layer.add(tick, messages)


def _records(path: Path) -> Iterator[Any]:
    with path.open("rb") as stream:
        try:
            yield from StreamReader(stream, validate_crcs=True).records
        except (EndOfFile, struct.error):  # the latter where an index is torn
            return


def _is_viewers(record: Any) -> bool:
    return isinstance(record, Schema) or (
        isinstance(record, Channel) and not record.topic.startswith(_WIRE)
    )
