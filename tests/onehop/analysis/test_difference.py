"""Two logs compared: the first difference by tick, channel and field."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgpack
import numpy as np

from onehop.analysis import Log, open_log
from onehop.analysis.difference import compare
from onehop.scenario.bundle import Bundle
from onehop.wire.log_reader import LogFile
from onehop.wire.log_writer import LogWriter

Change = Callable[[int, str, bytes], bytes | None]


def rewritten(log_path: Path, path: Path, change: Change, bundle: Bundle | None = None) -> Log:
    """The log with some messages changed, or left out where change gives None."""
    source = LogFile(log_path)
    writer = LogWriter(path, bundle or source.bundle, "inline")
    for tick in source.ticks():
        changed = [(key, change(tick.tick, key, data)) for key, data in tick.messages]
        writer.write(tick.tick, [(key, data) for key, data in changed if data is not None])
    writer.close(None)
    return open_log(path)


def altered(data: bytes, change: Callable[[Any], None]) -> bytes:
    fields = msgpack.unpackb(data)
    change(fields)
    packed: bytes = msgpack.packb(fields)
    return packed


def test_a_log_does_not_differ_from_itself(log: Log) -> None:
    found = compare(log, log)
    assert found.same
    assert found.messages == len(list(log.messages("truth", "radio", "rx/", "obs/", "out/")))


def test_the_first_changed_field_is_named_with_both_values(
    log: Log, log_path: Path, tmp_path: Path
) -> None:
    def hurry(tick: int, key: str, data: bytes) -> bytes:
        if key == "out/3" and tick in (50, 60):
            return altered(data, lambda fields: fields["twist"].update(v=7.5))
        return data

    found = compare(log, rewritten(log_path, tmp_path / "b.mcap", hurry))
    recorded = dict(log.actions(3, 2.5, 2.5))[50].twist.v
    assert found.first is not None
    assert (found.first.tick, found.first.channel, found.first.field) == (50, "/wire/out/3", "twist.v")
    assert (found.first.a, found.first.b) == (recorded, 7.5)
    assert found.differing == 2


def test_a_beam_of_a_scan_is_named(log: Log, log_path: Path, tmp_path: Path) -> None:
    def blind(tick: int, key: str, data: bytes) -> bytes:
        def shorten(fields: Any) -> None:
            scan = np.frombuffer(fields["scan"], dtype="<f4").copy()
            scan[17] = 0.25
            fields["scan"] = scan.tobytes()

        return altered(data, shorten) if (tick, key) == (9, "obs/1") else data

    found = compare(log, rewritten(log_path, tmp_path / "b.mcap", blind))
    assert found.first is not None
    assert (found.first.tick, found.first.field, found.first.b) == (9, "scan[17]", 0.25)


def test_a_missing_message_is_a_difference(log: Log, log_path: Path, tmp_path: Path) -> None:
    found = compare(
        log,
        rewritten(log_path, tmp_path / "b.mcap", lambda t, k, d: None if (t, k) == (5, "rx/4") else d),
    )
    assert found.first is not None
    assert (found.first.tick, found.first.channel) == (5, "/wire/rx/4")
    assert (found.first.a, found.first.b) == ("present", None)


def test_a_shorter_log_differs_where_it_ends(log: Log, log_path: Path, tmp_path: Path) -> None:
    found = compare(log, rewritten(log_path, tmp_path / "b.mcap", lambda t, _, d: d if t < 30 else None))
    assert found.first is not None
    assert (found.first.tick, found.first.field) == (30, "tick")
    assert (found.first.a, found.first.b) == ("present", None)


def test_a_setting_that_differs_is_named_beside_the_messages(
    log: Log, log_path: Path, tmp_path: Path
) -> None:
    other = Bundle(replace(log.scenario, seed=9), {})
    found = compare(log, rewritten(log_path, tmp_path / "b.mcap", lambda _t, _k, d: d, other))
    assert found.first is None
    assert not found.same
    assert found.scenario == [("seed", 1, 9)]
