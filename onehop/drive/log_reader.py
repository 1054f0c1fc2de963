"""Read a log, sound or torn: what it was made from, and its wire messages tick by tick.

The file is read front to back, so a log whose recorder was killed gives everything up to the tear: only
the last, unfinished record is missing. `LogFile.torn` says so after the messages have been read.
"""

import json
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mcap.exceptions import InvalidMagic, McapError
from mcap.records import Attachment, Channel, Footer, Message, Metadata
from mcap.stream_reader import StreamReader
from zstandard import ZstdError

from onehop.contracts import topics
from onehop.contracts.errors import LogError
from onehop.contracts.values import WIRE_VERSION
from onehop.drive.journal import Digest, WireMessage, canonical_rank
from onehop.drive.log_writer import MAP_ATTACHMENT, SCENARIO_ATTACHMENT
from onehop.scenario_file import Bundle, bundle_from_json

_WIRE = topics.wire("")


@dataclass(frozen=True, slots=True)
class Tick:
    """All wire messages of one tick, in canonical order."""

    tick: int
    messages: list[WireMessage]

    def get(self, key: str) -> bytes | None:
        """The bytes that crossed a bus key in this tick."""
        return next((data for name, data in self.messages if name == key), None)


class LogFile:
    """One log. Raises LogError when it is none of ours or of a wire version that is not known."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.torn = False
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
            ended = False
            try:
                for record in StreamReader(stream, validate_crcs=True).records:
                    ended = ended or isinstance(record, Footer)
                    yield record
            except (McapError, struct.error) as error:  # the file ends within a record
                if isinstance(error, InvalidMagic):
                    raise LogError(str(self.path), "not an MCAP file", "give a .mcap log") from None
            except (ValueError, ZstdError) as error:
                raise LogError(
                    str(self.path), f"damaged near byte {stream.tell()} ({error})", "use a copy of it"
                ) from None
            self.torn = not ended

    def ticks(self) -> Iterator[Tick]:
        """Every tick with its wire messages. Sets `torn` and `summary` when it has come to the end."""
        channels: dict[int, str] = {}
        current: Tick | None = None
        for record in self._records():
            if isinstance(record, Message):
                key = channels.get(record.channel_id)
                if key is None:
                    continue
                if current is None or record.sequence != current.tick:
                    if current is not None:
                        yield _in_order(current)
                    current = Tick(record.sequence, [])
                current.messages.append((key, record.data))
            elif isinstance(record, Channel) and record.topic.startswith(_WIRE):
                channels[record.id] = record.topic.removeprefix(_WIRE)
            elif isinstance(record, Metadata) and record.name == "outcome":
                self.summary = json.loads(record.metadata["summary"])
        if current is not None:
            yield _in_order(current)


def _in_order(tick: Tick) -> Tick:
    tick.messages.sort(key=lambda message: canonical_rank(message[0]))
    return tick


def digest(log: LogFile) -> str:
    """SHA-256 over the wire channels of a log: the same as the run printed."""
    sha = Digest()
    for tick in log.ticks():
        sha.add(tick.tick, tick.messages)
    return sha.hex()
