"""Whatever faults befall a team, in whatever order: it goes on, and its log happens again."""

from collections import Counter, defaultdict
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from onehop.checking import judge
from onehop.checking.invariants import NO_COLLISION
from onehop.contracts import topics
from onehop.contracts.errors import ScenarioError
from onehop.contracts.fault_section import KINDS, OWN_KEYS, in_toml
from onehop.contracts.messages import BROADCAST, RadioRecord, Truth
from onehop.drivers.replay import replay
from onehop.scenario.changes import apply_change
from onehop.wire.codec import decode
from onehop.wire.log_reader import LogFile
from tests.onehop.fault_scripts import SCRIPTS
from tests.onehop.scenes import field, log_of

END_S = 8.0
SETTLED_S = 4.0
"""A message that was offered so long before the end has its verdict by then, without routing: MRSR keeps
one for 30 s while it looks for a way."""

robots = st.lists(st.integers(1, 4), min_size=1, max_size=3, unique=True)
VALUES: dict[str, st.SearchStrategy[Any]] = {
    "robots": robots,
    "duration_s": st.sampled_from((0.0, 0.02, 0.5, 2.0, 100.0)),
    "x": st.sampled_from((3.0, 12.0, 35.0)),
    "y": st.sampled_from((3.0, 10.0, 36.0)),
    "heading_deg": st.floats(-360.0, 360.0),
    "delay_ticks": st.sampled_from((1, 3, 40)),
    "direction": st.sampled_from(("both", "from", "to")),
    "probability": st.sampled_from((0.1, 1.0)),
    "radius": st.sampled_from((1.0, 50.0)),
    "noise_dbm": st.sampled_from((-90.0, -40.0)),
}


@st.composite
def faults(draw: st.DrawFn) -> str:
    """One fault as an inline table."""
    kind = draw(st.sampled_from(KINDS))
    table = {key: draw(VALUES[key]) for key in OWN_KEYS[kind] if key in VALUES}
    if kind == "kidnap":
        table["robots"] = table["robots"][:1]
    if draw(st.booleans()):
        table["at_s"] = draw(st.floats(0.0, 6.0))
    else:
        table["on"] = draw(st.sampled_from(("leader elected", "formed", "narrow", "arrived")))
        table["after_s"] = draw(st.sampled_from((0.0, 0.7)))
    words = (f"{key} = {value!r}" for key, value in table.items())
    return "{" + ", ".join([f"kind = {kind!r}", *words]) + "}"


@pytest.mark.slow
@settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(faults(), min_size=1, max_size=6), st.sampled_from(("direct", "mrsr", "mrdv")))
def test_every_schedule_of_faults_ends_in_a_log_that_happens_again(
    schedule: list[str], routing: str
) -> None:
    script = f"faults=[{', '.join(schedule)}]"
    with TemporaryDirectory() as folder:
        limit = f"clock.limit_s={END_S}"
        bundle = field(Path(folder), script, limit, f"radio.routing={routing}")
        log_of(bundle, Path(folder) / "mission.mcap")
        log = LogFile(Path(folder) / "mission.mcap")
        report = replay(log)
        assert (report.divergences, report.flaws) == (0, [])
        broken = [one for one in judge(log).violations if one.invariant != NO_COLLISION]
        assert broken == [], script
        _each_message_has_its_verdict(log, routing)


def _each_message_has_its_verdict(log: LogFile, routing: str) -> None:
    numbers: Counter[int] = Counter()
    due: set[tuple[int, int]] = set()
    verdicts: dict[tuple[int, int], list[int]] = defaultdict(list)
    end_s = 0.0
    for tick in log.ticks():
        truth = decode(Truth, tick.get(topics.TRUTH) or b"")
        record = decode(RadioRecord, tick.get(topics.RADIO_RECORD) or b"")
        end_s = truth.time_ns / 1e9
        for request in truth.transmit_requests:
            for sent in request.outbox:
                numbers[request.robot] += 1
                if end_s < END_S - SETTLED_S and sent.destination != BROADCAST:
                    due.add((request.robot, numbers[request.robot]))
        for one in record.verdicts:
            verdicts[one.source, one.message].append(one.receiver)
    assert all(len(set(receivers)) == len(receivers) for receivers in verdicts.values())
    assert all(message <= numbers[source] for source, message in verdicts)
    if routing == "direct" and end_s > END_S - 0.1:
        assert due <= set(verdicts)


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS.values(), ids=SCRIPTS)
def test_what_a_log_tells_of_its_faults_is_a_script_that_repeats_it(tmp_path: Path, script: str) -> None:
    limit = "clock.limit_s=8"
    first = log_of(field(tmp_path, f"faults=[{script}]", limit), tmp_path / "first.mcap")
    told = [
        in_toml(fault)
        for tick in LogFile(tmp_path / "first.mcap").ticks()
        for fault in decode(Truth, tick.get(topics.TRUTH) or b"").faults
    ]
    assert told
    again = field(tmp_path, f"faults=[{', '.join(told)}]", limit)
    assert log_of(again, tmp_path / "again.mcap") == first
    quiet = field(tmp_path, limit)
    assert log_of(quiet, tmp_path / "quiet.mcap") != first


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ("kind='kill', robots=[2]", "at_s: neither at_s nor on is given; a time in seconds"),
        ("kind='kill', robots=[2], at_s=1, on='formed'", "at_s: at_s and on at once"),
        ("kind='kill', robots=[2], at_s=1, nth=2", "on: nth or after_s without it"),
        ("kind='kill', at_s=1", "robots: kill of nobody; name at least one robot"),
        ("kind='kill', at_s=1, robots=[9]", "robots: robot 9 is not in the team; ids of the team"),
        ("kind='kill', at_s=1, robots=[2], x=3", "x: kill takes no x; kill takes robots"),
        ("kind='kidnap', at_s=1, robots=[2, 3], x=3, y=3", "robots: 2 robots to one place"),
        ("kind='slow', at_s=1, robots=[2]", "delay_ticks: slow by no tick"),
        ("kind='slow', at_s=1, robots=[2], delay_ticks=1001", "delay_ticks: 1001 is out of range"),
        ("kind='corrupt', at_s=1, probability=0", "probability: nothing is corrupted"),
        ("kind='jam', at_s=1, x=3", "radius: a jam without extent"),
        ("kind='cut', at_s=1, robots=[2], others=[2]", "others: a robot is cut from itself"),
        ("kind='cut', at_s=1, robots=[2], direction='out'", "direction: 'out' is unknown; one of"),
        ("kind='freeze', at_s=1, robots=[2]", "kind: 'freeze' is unknown; one of 'kill', 'stop'"),
        ("kind='kill', robots=[2], on='lunch'", "on: 'lunch' is unknown; one of"),
        (
            "kind='kill', robots=[2], on='formed', atfer_s=1",
            "atfer_s: unknown key; did you mean after_s",
        ),
    ],
)
def test_what_is_wrong_with_a_fault_is_one_line_with_its_key(
    tmp_path: Path, fault: str, said: str
) -> None:
    with pytest.raises(ScenarioError) as refused:
        field(tmp_path, f"faults=[{{{fault}}}]")
    assert f"faults[0].{said}" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_fault_as_a_line_of_toml_is_read_back(tmp_path: Path) -> None:
    script = "{kind = 'cut', on = 'formed', nth = 2, robots = [2], others = [3], direction = 'to'}"
    (fault,) = field(tmp_path, f"faults=[{script}]").scenario.faults
    table: dict[str, Any] = {}
    apply_change(table, f"faults=[{in_toml(fault)}]")
    assert field(tmp_path, f"faults=[{in_toml(fault)}]").scenario.faults == (fault,)
