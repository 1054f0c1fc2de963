"""Read a log, sound or torn: what it was made from, and its wire messages tick by tick.

The file is read front to back, so a log whose recorder was killed gives everything up to the tear: only
the last, unfinished record is missing.
"""

import json
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

from mcap.data_stream import ReadDataStream
from mcap.exceptions import InvalidMagic, McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Message, Metadata
from mcap.stream_reader import StreamReader
from zstandard import ZstdError

from onehop.contracts.errors import LogError
from onehop.contracts.values import WIRE_VERSION
from onehop.scenario.bundle import Bundle, bundle_from_json
from onehop.wire.journal import Digest, WireMessage, canonical_rank
from onehop.wire.log_writer import MAP_ATTACHMENT, SCENARIO_ATTACHMENT
from onehop.wire.selection import select, walk


@dataclass(frozen=True, slots=True)
class LoggedTick:
    """All wire messages of one tick, in canonical order."""

    tick: int
    messages: list[WireMessage]

    def get(self, key: str) -> bytes | None:
        """The bytes that crossed a bus key in this tick."""
        return next((data for name, data in self.messages if name == key), None)


class LogFile:
    """One log. Raises LogError when it is none of ours or of a wire version that is not known.

    summary: what `onehop run` printed, None if the log ends before the mission did. torn: its recorder
    was killed.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.torn = True
        self.metadata: dict[str, str] = {}
        self.summary: dict[str, Any] | None = None
        attachments: dict[str, bytes] = {}
        for record in self._records():
            if isinstance(record, Metadata) and record.name == "onehop":
                self.metadata = record.metadata
            elif isinstance(record, Attachment):
                attachments[record.name] = record.data
            elif isinstance(record, Message):
                break
        self._check_origin(attachments)
        files = {
            name.removeprefix(MAP_ATTACHMENT): data
            for name, data in attachments.items()
            if name.startswith(MAP_ATTACHMENT)
        }
        text = attachments[SCENARIO_ATTACHMENT].decode()
        self.bundle: Bundle = bundle_from_json(text, files, f"{path}: {SCENARIO_ATTACHMENT}")
        self._read_end()

    def _read_end(self) -> None:
        with self.path.open("rb") as stream:
            for opcode, length in walk(stream):
                if opcode == Opcode.METADATA:
                    record = Metadata.read(ReadDataStream(BytesIO(stream.read(length))))
                    if record.name == "outcome":
                        self.summary = json.loads(record.metadata["summary"])
                self.torn = opcode != Opcode.FOOTER

    def _check_origin(self, attachments: dict[str, bytes]) -> None:
        version = self.metadata.get("wire_version")
        if version is None or SCENARIO_ATTACHMENT not in attachments:
            raise LogError(str(self.path), "not a log of a mission", "give a file that onehop run wrote")
        if version != str(WIRE_VERSION):
            raise LogError(
                str(self.path),
                f"wire schema version {version}",
                f"this program reads version {WIRE_VERSION}; use the onehop that wrote it "
                f"({self.metadata.get('onehop', 'unknown')})",
            )

    def _records(self) -> Iterator[Any]:
        try:
            stream = self.path.open("rb")
        except OSError as error:
            raise LogError(
                str(self.path), error.strerror or "cannot be read", "name a log that exists"
            ) from None
        with stream:
            try:
                yield from StreamReader(stream, validate_crcs=True).records
            except (McapError, struct.error) as error:  # the file ends within a record
                if isinstance(error, InvalidMagic):
                    raise LogError(str(self.path), "not an MCAP file", "give a .mcap log") from None
            except (ValueError, ZstdError) as error:
                raise LogError(
                    str(self.path), f"damaged near byte {stream.tell()} ({error})", "use a copy of it"
                ) from None

    def ticks(self) -> Iterator[LoggedTick]:
        """Every tick with its wire messages, up to where the log is torn."""
        messages = select(self.path, lambda _: True, self.bundle.scenario.clock.period_ns)
        for number, group in groupby(messages, key=itemgetter(0)):
            yield _in_order(LoggedTick(number, [(key, data) for _, key, data in group]))


def _in_order(tick: LoggedTick) -> LoggedTick:
    tick.messages.sort(key=lambda message: canonical_rank(message[0]))
    return tick


def digest(log: LogFile) -> str:
    """SHA-256 over the wire channels of a log: the same as the run printed."""
    sha = Digest()
    for tick in log.ticks():
        sha.add(tick.tick, tick.messages)
    return sha.hex()
