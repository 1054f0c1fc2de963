"""Copy the records of a log into a new file without understanding them."""

import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import BinaryIO, Self

from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.writer import CompressionType, Writer

from onehop import __version__
from onehop.wire.log_writer import OUTCOME
from onehop.wire.records import (
    Record,
    attachment,
    channel,
    content_of,
    message,
    metadata,
    records_in,
    schema,
)


def parsed(data: bytes) -> Iterator[Schema | Channel | Message]:
    """The records of a stretch as values. Raises RecordError."""
    for opcode, begin, end in records_in(data):
        if opcode == Opcode.MESSAGE:
            yield message(data[begin:end])
        elif opcode == Opcode.CHANNEL:
            yield channel(data[begin:end])
        elif opcode == Opcode.SCHEMA:
            yield schema(data[begin:end])


class LogCopy:
    """A new MCAP file that takes records of an old one; ids of schemas and channels are its own.

    Used in a with statement. It appears under its name only when it is finished, so it may take the
    place of the file that it copies.

    origin: a word for its header. topics: of every channel that was taken, by its id in the old file.
    """

    def __init__(self, path: Path, origin: str) -> None:
        self._path, self._draft = path, path.with_name(path.name + ".part")
        self._stream = self._draft.open("wb")
        self.writer = Writer(self._stream, chunk_size=1 << 20, compression=CompressionType.ZSTD)
        self.writer.start("", f"onehop {__version__}, {origin}")
        self._schemas: dict[int, int] = {0: 0}
        self._channels: dict[int, int] = {}
        self._outcome: list[Metadata] = []
        self.topics: dict[int, str] = {}

    def take_apart(self, stream: BinaryIO, records: Iterable[Record]) -> None:
        """Copy metadata and attachments; the outcome waits for the end."""
        for record in records:
            if record.opcode == Opcode.METADATA:
                self._take_metadata(metadata(content_of(stream, record)))
            else:
                self._take_attachment(attachment(content_of(stream, record)))
        self.settle()

    def _take_metadata(self, about: Metadata) -> None:
        if about.name == OUTCOME:
            self._outcome = [about]
        else:
            self.writer.add_metadata(about.name, about.metadata)

    def _take_attachment(self, file: Attachment) -> None:
        self.writer.add_attachment(
            file.create_time, file.log_time, file.name, file.media_type, file.data
        )

    def settle(self) -> None:
        """End the chunk: nothing that follows can overtake it, and its head says which ticks it has."""
        self.writer.flush()  # type: ignore[no-untyped-call]

    def take_schema(self, one: Schema) -> None:
        """Copy a schema, unless its id is taken already."""
        if one.id not in self._schemas:
            self._schemas[one.id] = self.writer.register_schema(one.name, one.encoding, one.data)

    def take_channel(self, one: Channel) -> None:
        """Copy a channel of another id than those before; without its schema, if that is lost."""
        self.topics[one.id] = one.topic
        self._channels[one.id] = self.writer.register_channel(
            one.topic, one.message_encoding, self._schemas.get(one.schema_id, 0), one.metadata
        )

    def take_message(self, one: Message) -> None:
        """Copy a message of a channel that was taken."""
        self.writer.add_message(
            self._channels[one.channel_id], one.log_time, one.data, one.publish_time, one.sequence
        )

    def finish(self) -> None:
        """Write the outcome, summary and index; the file takes its name."""
        self.settle()
        for about in self._outcome:
            self.writer.add_metadata(about.name, about.metadata)
        self.writer.finish()  # type: ignore[no-untyped-call]
        self._stream.close()
        os.replace(self._draft, self._path)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """What was not finished leaves no trace."""
        self._stream.close()
        self._draft.unlink(missing_ok=True)
