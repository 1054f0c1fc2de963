"""Logs with messages that cannot have been recorded, and logs that lack ticks, as tables and traces."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgpack
import pytest

from onehop.analysis import Log, open_log
from onehop.analysis.message_traces import traces
from onehop.analysis.payloads import decode_payload
from onehop.analysis.view.layer import write_view
from onehop.contracts.errors import InputError, LogError
from tests.onehop.log_forms import Form, ticks_of, write_form


def _forged(
    log_path: Path, path: Path, tick: int, key: str, change: Callable[[dict[str, Any]], None]
) -> Log:
    """The log with one message changed."""
    ticks = ticks_of(log_path)
    fields = msgpack.unpackb(dict(ticks[tick][1])[key])
    change(fields)
    ticks[tick] = tick, [(k, msgpack.packb(fields) if k == key else d) for k, d in ticks[tick][1]]
    write_form(log_path, path, Form(), ticks)
    return open_log(path)


def test_a_robot_that_is_not_in_the_team_is_refused(log_path: Path, tmp_path: Path) -> None:
    def stranger(truth: dict[str, Any]) -> None:
        truth["present"][0]["robot"] = 99

    forged = _forged(log_path, tmp_path / "x.mcap", 9, "truth", stranger)
    with pytest.raises(LogError, match="poses of robot 99, which is not in the team"):
        forged.table("poses")
    with pytest.raises(LogError, match="tick 9"):
        write_view(forged, tmp_path / "view.mcap")
    assert not (tmp_path / "view.mcap").exists()


@pytest.mark.parametrize("x", [float("nan"), float("inf"), 1e308])
def test_a_pose_that_is_nowhere_is_not_shown(log_path: Path, tmp_path: Path, x: float) -> None:
    def stray(truth: dict[str, Any]) -> None:
        truth["present"][0]["pose"]["x"] = x

    forged = _forged(log_path, tmp_path / "x.mcap", 9, "truth", stray)
    with pytest.raises(LogError, match="tick 9, truth: no robot of the team is there"):
        write_view(forged, tmp_path / "view.mcap")


def test_a_message_that_is_none_is_refused_with_its_place(
    log: Log, log_path: Path, tmp_path: Path
) -> None:
    forged = _forged(log_path, tmp_path / "x.mcap", 9, "out/3", lambda action: action.pop("status"))
    with pytest.raises(LogError, match=r"tick 9, /wire/out/3: Action: .*status"):
        forged.table("notes")
    with pytest.raises(LogError, match=r"tick 9, /wire/out/3"):
        list(forged.actions(3))
    before, sound = (one.table("status", end_s=0.4) for one in (forged, log))
    assert before["tick"].tolist() == sound["tick"].tolist()


def test_a_message_of_another_tick_is_refused(log_path: Path, tmp_path: Path) -> None:
    forged = _forged(log_path, tmp_path / "x.mcap", 9, "out/3", lambda action: action.update(tick=8))
    with pytest.raises(LogError, match=r"tick 9, /wire/out/3: it is of tick 8"):
        forged.table("status")


def test_scans_of_different_length_are_refused(log_path: Path, tmp_path: Path) -> None:
    def shorten(observation: dict[str, Any]) -> None:
        observation["scan"] = observation["scan"][:-8]

    forged = _forged(log_path, tmp_path / "x.mcap", 9, "obs/3", shorten)
    with pytest.raises(LogError, match=r"a scan of 179 beams .*, of robot 3 that has 181"):
        forged.table("scans")


@pytest.mark.parametrize("time_s", [float("nan"), float("inf")])
def test_a_stretch_to_a_time_that_is_none_is_refused(log: Log, time_s: float) -> None:
    with pytest.raises(InputError, match="no moment of a mission"):
        log.table("poses", end_s=time_s)


def test_behind_missing_ticks_no_message_gets_the_payload_of_another(
    log: Log, log_path: Path, tmp_path: Path
) -> None:
    """Messages are counted from the start; where some are missing, the count is wrong behind them."""
    path = tmp_path / "holed.mcap"
    spoken = {tick for tick in log.table("transmit_requests")["tick"].tolist() if 20 < tick < 60}
    kept = [(tick, messages) for tick, messages in ticks_of(log_path) if tick not in spoken]
    write_form(log_path, path, Form(), kept)
    holed = open_log(path)
    assert spoken
    assert holed.flaws
    heard = Counter(
        (one.source, robot, one.arrival_ns / 1e9, decode_payload(one.payload))
        for robot in log.robots
        for _, inbox in log.inboxes(robot)
        for one in inbox.receptions
    )
    behind = [trace for trace in traces(holed, 3.5) if trace.delivered]
    known = [trace for trace in behind if trace.kind != "unknown"]
    assert len(known) > 0.9 * len(behind) > 50
    said = Counter((one.source, one.receiver, one.arrival_s, one.message) for one in known)
    assert said <= heard
