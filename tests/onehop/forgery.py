"""A good log, altered: what a checker must find. Its digest is made anew, so that it shows nothing."""

import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgpack

from onehop.scenario.bundle import Bundle, changed
from onehop.wire.journal import Digest, canonical_rank
from onehop.wire.log_reader import LogFile
from onehop.wire.log_writer import LogWriter

Fields = dict[str, Any]
Change = Callable[[Fields], object]


class Forgery:
    """The messages of a log, by tick and key, to be changed and written.

    settings: changes of the scenario. summary: the outcome. hides_traces: whether to digest anew.
    """

    def __init__(self, source: Path) -> None:
        log = LogFile(source)
        assert log.summary is not None
        self.bundle = log.bundle
        self.settings: list[str] = []
        self.summary = dict(log.summary)
        self.hides_traces = True
        self.ticks: list[tuple[int, list[tuple[str, bytes]]]] = [
            (tick.tick, list(tick.messages)) for tick in log.ticks()
        ]

    def get(self, tick: int, key: str) -> Fields:
        """One message."""
        fields: Fields = msgpack.unpackb(dict(self.ticks[tick][1])[key])
        return fields

    def has(self, tick: int, key: str) -> bool:
        return key in dict(self.ticks[tick][1])

    def change(self, tick: int, key: str, change: Change) -> None:
        """Change one message."""
        fields = self.get(tick, key)
        change(fields)
        messages = self.ticks[tick][1]
        messages[:] = [(k, msgpack.packb(fields) if k == key else data) for k, data in messages]

    def remove(self, tick: int, key: str) -> None:
        messages = self.ticks[tick][1]
        messages[:] = [(k, data) for k, data in messages if k != key]

    def add(self, tick: int, key: str, fields: Fields) -> None:
        """One more message."""
        self.ticks[tick][1].append((key, msgpack.packb(fields)))

    def say(self, ticks: range, robot: int, **status: Any) -> None:
        """A robot says something else of its team, where it says anything."""
        for tick in ticks:
            if self.has(tick, f"out/{robot}"):
                self.change(tick, f"out/{robot}", lambda action: action["status"].update(status))

    def present(self, ticks: range, robot: int, change: Change) -> None:
        """A robot is otherwise than it was, in truth and in what it is told."""
        for tick in ticks:
            for one in self.get(tick, "truth")["present"]:
                if one["robot"] == robot:
                    self.change(tick, "truth", lambda truth: change(_of(truth, robot)))
                    if self.has(tick, f"obs/{robot}"):
                        self.change(tick, f"obs/{robot}", change)

    def verdicts(self, status: str = "delivered", first: int = 0) -> Iterator[tuple[int, int, Fields]]:
        """Tick, place in its record, and verdict, from a tick on."""
        for tick in range(first, len(self.ticks)):
            for place, verdict in enumerate(self.get(tick, "radio")["verdicts"]):
                if verdict["status"] == status:
                    yield tick, place, verdict

    def reword(self, tick: int, robot: int, change: Callable[[list[Any]], object]) -> None:
        """A robot's commands and beacons of a tick say something else, wherever they are heard.

        change: of the fields of a payload, in place.
        """
        swaps: dict[bytes, bytes] = {}
        for sent in self.get(tick, f"out/{robot}")["outbox"]:
            fields = msgpack.unpackb(sent["payload"][:-4])
            if fields[1] in ("command", "beacon"):
                change(fields)
                content = msgpack.packb(fields)
                swaps[sent["payload"]] = content + zlib.crc32(content).to_bytes(4, "little")
        assert swaps
        for later in range(tick, min(tick + 40, len(self.ticks))):
            messages = self.ticks[later][1]
            for place, (key, data) in enumerate(messages):
                if any(payload in data for payload in swaps):
                    messages[place] = key, msgpack.packb(_swapped(msgpack.unpackb(data), swaps))

    def write(self, path: Path) -> LogFile:
        """The altered log."""
        scenario = changed(self.bundle.scenario, self.settings)
        writer = LogWriter(path, Bundle(scenario, self.bundle.files), "forged")
        digest = Digest()
        for tick, messages in self.ticks:
            ordered = sorted(messages, key=lambda message: canonical_rank(message[0]))
            digest.add(tick, ordered)
            writer.write(tick, ordered)
        if self.hides_traces:
            self.summary["digest"] = digest.hex()
        writer.close(self.summary)
        return LogFile(path)


def _of(truth: Fields, robot: int) -> Fields:
    found: Fields = next(one for one in truth["present"] if one["robot"] == robot)
    return found


def _swapped(value: Any, swaps: dict[bytes, bytes]) -> Any:
    if isinstance(value, dict):
        return {key: _swapped(inner, swaps) for key, inner in value.items()}
    if isinstance(value, list):
        return [_swapped(inner, swaps) for inner in value]
    return swaps.get(value, value) if isinstance(value, bytes) else value
