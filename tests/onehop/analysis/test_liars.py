"""What a robot says is shown as text, whatever it is: in report, explanation, viewer layer and diff."""

import json
import math
import time
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from msgspec.structs import replace

from onehop.analysis import Log, open_log
from onehop.analysis.difference import compare
from onehop.analysis.explanation import explain
from onehop.analysis.explanation_text import MOST_LINES, explanation_text
from onehop.analysis.report.narrative import MOST_NOTES
from onehop.analysis.report.page import write_report
from onehop.analysis.trajectory import draw_trajectory
from onehop.analysis.view.layer import write_view
from onehop.contracts.messages import (
    Action,
    DeliveryStatus,
    Note,
    NoteValue,
    RadioRecord,
    Transmission,
    TransmitRequest,
    Truth,
    Verdict,
)
from onehop.contracts.printable import json_value
from onehop.contracts.team import Mode
from onehop.wire.codec import decode, encode
from onehop.wire.log_reader import LogFile
from tests.onehop.log_forms import Form, ticks_of, write_form

LIAR = 4
HOSTILE = "<script>alert(1)</script>\x1b[2J\r\n\0$\\frac{$\u202e"
KINDS = (
    "mode", "lost_leader", "lost_follower", "joined", "yielded", "roster", "arrived", "no_way",
    "elected", "narrow", "wide", "", HOSTILE,
)  # fmt: skip
VALUES: tuple[NoteValue, ...] = (
    2**64 - 1, -(2**63), math.nan, math.inf, HOSTILE, "x" * 100_000, (), tuple(range(5000)), "",
)  # fmt: skip
NAMES = ("leader", "robots", "reason", "on", "was", "mode", "epoch", "members", "at_s", "kind", "robot")

FLOOD = 100_000
"""Messages of one robot in one tick."""


def _notes(tick: int) -> tuple[Note, ...]:
    """One note of each kind, each key with another value at every tick, some keys missing."""
    return tuple(
        Note(
            kind,
            {
                name: VALUES[(tick + place + number) % len(VALUES)]
                for place, name in enumerate((*NAMES, HOSTILE))
                if (tick + place) % 5
            },
        )
        for number, kind in enumerate(KINDS)
    )


def _lie(tick: int, action: Action) -> Action:
    number = (math.nan, math.inf, -math.inf, 1e308, -5e-324)[tick % 5]
    status = replace(
        action.status,
        mode=list(Mode)[tick % len(Mode)],
        epoch=(2**64 - 1, -(2**63), tick)[tick % 3],
        leader=(LIAR, 0, 99, 2**63, -1)[tick % 5],
        members=((), (LIAR,), tuple(range(2000)), (2**64 - 1, 0, -5))[tick % 4],
        throughput_bps=number, threshold_bps=abs(number), k_rho=number, error=number,
        target_x=number, target_y=-number,
    )  # fmt: skip
    return replace(action, status=status, notes=_notes(tick), remaining_distance=number, speed=number)


@pytest.fixture(scope="module")
def lying(log_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Log:
    """The small mission, with a robot that says everything that the wire lets through."""
    path = tmp_path_factory.mktemp("liar") / "mission.mcap"
    ticks = ticks_of(log_path)
    for tick, messages in ticks:
        place = next(n for n, (key, _) in enumerate(messages) if key == f"out/{LIAR}")
        key, said = messages[place]
        messages[place] = key, encode(_lie(tick, decode(Action, said)))
    write_form(log_path, path, Form(), ticks)
    return open_log(path)


@pytest.mark.slow
def test_the_report_shows_a_liars_words_as_text(lying: Log, tmp_path: Path) -> None:
    page = write_report(lying, tmp_path).page.read_text()
    assert "<script" not in page
    assert "\x1b" not in page
    assert page.count(f"Robot {LIAR} notes") > 3
    assert page.count(f"Leader {LIAR} takes in") <= MOST_NOTES


def test_the_explanation_shows_a_liars_words_as_text(lying: Log) -> None:
    for at_s in (1.0, 1.05, 1.1, 1.15, 1.2):
        found = explain(lying, LIAR, at_s)
        assert all(line.isprintable() for line in explanation_text(found))
        json.dumps(json_value(found.as_json()), allow_nan=False)


def test_a_note_cannot_pass_for_another_moment_or_kind(lying: Log) -> None:
    events = explain(lying, LIAR, 2.0).events
    assert {event["kind"] for event in events} == set(KINDS)
    assert all(isinstance(event["at_s"], float) and event["at_s"] <= 2.0 for event in events)


def test_the_viewer_layer_shows_a_liars_words_as_text(lying: Log, tmp_path: Path) -> None:
    path = tmp_path / "view.mcap"
    counts, _ = write_view(lying, path)
    texts = [message.message for message in _events(path)]
    assert len(texts) == counts["/events"] > 100
    assert all(text.isprintable() for text in texts)
    assert list(LogFile(path).ticks()) == list(lying.file.ticks())


def _events(path: Path) -> list[Any]:
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        return [message for *_, message in reader.iter_decoded_messages(["/events"])]


def test_the_trajectory_is_drawn_with_a_liar_in_it(lying: Log, tmp_path: Path) -> None:
    draw_trajectory(lying.file, tmp_path / "trajectory.png")
    assert (tmp_path / "trajectory.png").stat().st_size > 1000


def test_a_liars_first_word_is_the_first_difference(lying: Log, log: Log) -> None:
    found = compare(log, lying)
    assert found.first is not None
    assert (found.first.tick, found.first.channel) == (0, f"/wire/out/{LIAR}")
    json.dumps(json_value([found.first.a, found.first.b]), allow_nan=False)


def test_whole_numbers_beyond_64_bits_are_the_nearest_that_a_column_has(lying: Log) -> None:
    epochs = set(lying.table("status", robots=[LIAR])["epoch"].tolist())
    assert {2**63 - 1, -(2**63)} < epochs


@pytest.fixture(scope="module")
def flooded(log_path: Path, tmp_path_factory: pytest.TempPathFactory) -> Log:
    """The small mission, with a robot that sends a hundred thousand messages in one tick."""
    path = tmp_path_factory.mktemp("flood") / "mission.mcap"
    ticks = ticks_of(log_path)
    at = 30
    messages = dict(ticks[at][1])
    truth, record = decode(Truth, messages["truth"]), decode(RadioRecord, messages["radio"])
    outbox = (Transmission(0, b"", 0, 0), Transmission(77, b"\xc1", 1, 0)) * (FLOOD // 2)
    request = TransmitRequest(LIAR, 0.0, 0.0, outbox)
    others = tuple(one for one in truth.transmit_requests if one.robot != LIAR)
    sent_before = sum(
        len(one.outbox)
        for tick, inbox in ticks[:at]
        for one in decode(Truth, dict(inbox)["truth"]).transmit_requests
        if one.robot == LIAR
    )
    start_ns = truth.time_ns - 50_000_000
    verdicts = tuple(
        Verdict(
            sent_before + 1 + number, LIAR, sent.destination, sent.destination or 1,
            DeliveryStatus.QUEUE_FULL, 1, (LIAR,), (1,), start_ns, start_ns, -1, 0, 0, 0.0, 0.0,
        )
        for number, sent in enumerate(outbox)
    )  # fmt: skip
    messages["truth"] = encode(replace(truth, transmit_requests=(*others, request)))
    messages["radio"] = encode(replace(record, verdicts=verdicts))
    ticks[at] = at, list(messages.items())
    write_form(log_path, path, Form(), ticks)
    return open_log(path)


def test_a_flood_is_explained_by_its_last_messages_and_their_number(flooded: Log) -> None:
    started = time.process_time()
    lines = list(explanation_text(explain(flooded, LIAR, 2.0)))
    assert time.process_time() - started < 20.0
    assert len(lines) < 2 * MOST_LINES + 20
    assert any(line.endswith("earlier ones (--json has them)") for line in lines)


@pytest.mark.slow
def test_a_flood_is_reported(flooded: Log, tmp_path: Path) -> None:
    started = time.process_time()
    page = write_report(flooded, tmp_path).page
    assert time.process_time() - started < 60.0
    assert page.stat().st_size < 10_000_000
