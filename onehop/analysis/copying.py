"""Copy the records of a log into a new file without understanding them."""

import os
from pathlib import Path
from typing import Any, Self

from mcap.records import Attachment, Channel, Header, Message, Metadata, Schema
from mcap.writer import CompressionType, Writer


class LogCopy:
    """A new MCAP file that takes records of an old one; ids of schemas and channels are its own.

    Used in a with statement. It appears under its name only when it is finished, so it may take the
    place of the file that it copies.

    keys: topic of every channel that was taken, by its id in the old file.
    """

    def __init__(self, path: Path, origin: str) -> None:
        self._path, self._draft = path, path.with_name(path.name + ".part")
        self._stream = self._draft.open("wb")
        self.writer = Writer(self._stream, chunk_size=1 << 20, compression=CompressionType.ZSTD)
        self._origin = origin
        self._schemas: dict[int, int] = {0: 0}
        self._channels: dict[int, int] = {}
        self.keys: dict[int, str] = {}

    def take(self, record: Any) -> None:
        """Copy anything but a message."""
        if isinstance(record, Header):
            self.writer.start(record.profile, f"{record.library}, {self._origin}")
        elif isinstance(record, Schema) and record.id not in self._schemas:
            self._schemas[record.id] = self.writer.register_schema(
                record.name, record.encoding, record.data
            )
        elif isinstance(record, Channel) and record.id not in self._channels:
            self._take_channel(record)
        elif isinstance(record, Metadata):
            self._settle()
            self.writer.add_metadata(record.name, record.metadata)
        elif isinstance(record, Attachment):
            self._settle()
            self.writer.add_attachment(
                record.create_time, record.log_time, record.name, record.media_type, record.data
            )

    def _settle(self) -> None:
        """Write out the messages so far: the writer holds them back, and nothing may overtake them."""
        self.writer.flush()  # type: ignore[no-untyped-call]

    def _take_channel(self, record: Channel) -> None:
        self.keys[record.id] = record.topic
        self._channels[record.id] = self.writer.register_channel(
            record.topic, record.message_encoding, self._schemas[record.schema_id], record.metadata
        )

    def take_message(self, message: Message) -> None:
        """Copy a message of a channel that was taken."""
        self.writer.add_message(
            self._channels[message.channel_id], message.log_time, message.data,
            message.publish_time, message.sequence,
        )  # fmt: skip

    def finish(self) -> None:
        """Write summary and index; the file takes its name."""
        self.writer.finish()  # type: ignore[no-untyped-call]
        self._stream.close()
        os.replace(self._draft, self._path)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """What was not finished leaves no trace."""
        self._stream.close()
        self._draft.unlink(missing_ok=True)
