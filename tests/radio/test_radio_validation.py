"""What stands beside ns-3: statistics, geometry, tables of bench/ns3.py. No ns-3 is needed here."""

import math
import subprocess
import sys
from itertools import combinations
from pathlib import Path
from statistics import fmean, stdev

import pytest

from bench.radio_validation import cases, ours
from bench.radio_validation.cases import Run
from bench.radio_validation.measures import Ratio, measures, paired_ratio, percentile, ratio, student_t
from bench.radio_validation.peer import NOT_INSTALLED
from bench.radio_validation.tables import Row, markdown, verdict

BENCH = Path(__file__).parents[2] / "bench"
CASES = {case.name: case for case in cases.every_case()}


@pytest.mark.parametrize(
    ("freedom", "quantile"), [(1, 12.706), (4, 2.776), (9, 2.262), (18, 2.101), (1000, 1.962)]
)
def test_student_t_is_that_of_the_tables(freedom: int, quantile: float) -> None:
    assert student_t(freedom) == pytest.approx(quantile, abs=1e-3)


def test_interval_against_an_exact_peer_is_that_of_one_sample() -> None:
    ours_seen = [0.9, 1.0, 1.1, 1.05, 0.98]
    found = ratio(ours_seen, [2.0] * 5)
    assert found is not None
    error = student_t(4) * stdev(ours_seen) / math.sqrt(5) / fmean(ours_seen)
    assert found.value == pytest.approx(fmean(ours_seen) / 2.0)
    assert found.high / found.value == pytest.approx(math.exp(error))
    assert found.value / found.low == pytest.approx(math.exp(error))


def test_interval_of_two_equal_samples_has_both_their_freedoms() -> None:
    """Welch and Satterthwaite: 2 (n - 1) for samples of one size and variance."""
    seen = [0.9, 1.0, 1.1, 1.05, 0.98]
    found = ratio(seen, seen)
    assert found is not None
    error = student_t(8) * stdev(seen) * math.sqrt(2.0 / 5.0) / fmean(seen)
    assert found.high == pytest.approx(math.exp(error))


@pytest.mark.parametrize("sample", [[1.0], [0.0, 0.0]])
def test_there_is_no_ratio_of_one_run_or_of_nothing(sample: list[float]) -> None:
    assert ratio(sample, [1.0, 1.1]) is None
    assert ratio([1.0, 1.1], sample) is None


def test_paired_ratio_does_not_see_what_topologies_differ_in() -> None:
    found = paired_ratio([(0.2, 0.1), (2.0, 1.0), (20.0, 10.0)])
    assert found is not None
    assert (found.low, found.value, found.high) == pytest.approx((2.0, 2.0, 2.0))


def test_percentile_is_a_value_that_was_seen() -> None:
    values = [float(v) for v in range(20, 0, -1)]
    assert [percentile(values, share) for share in (0.5, 0.95, 0.99)] == [10.0, 19.0, 20.0]
    assert percentile([], 0.5) is None


def test_within_asks_for_the_whole_interval() -> None:
    assert Ratio(1.0, 0.98, 1.02).within(0.03)
    assert not Ratio(1.0, 0.96, 1.02).within(0.03)
    assert not Ratio(1.0, 0.98, 1.04).within(0.03)


def test_flows_are_counted_hop_by_hop_and_end_to_end() -> None:
    run = Run(seed=1, seconds=2.0, places=((0.0, 0.0),) * 3, paths=((0, 1, 2),))
    figures = measures(run, {"received": [300, 200, 0], "delays_ms": [[5.0, 7.0]]})
    assert figures["mbps"] == pytest.approx(500 * 6400 / 2e6)
    assert figures["end_to_end_mbps"] == pytest.approx(2 * 6400 / 2e6)
    assert figures["p50_ms"] == 5.0


def test_repair_is_measured_on_what_was_offered_after_the_relay_left() -> None:
    run = Run(
        seed=1,
        seconds=9.0,
        places=(),
        protocol="aodv",
        messages=tuple((float(at), 0, 1) for at in range(5)),
        leaves=((1, 2.0),),
    )
    said = {"arrivals_s": [0.5, 1.1, None, 3.7, 4.2], "routing_bytes": 9, "source_route_bytes": 0}
    figures = measures(run, said)
    assert figures["delivered"] == pytest.approx(2 / 3)
    assert figures["first_ms"] == pytest.approx(500.0)
    assert figures["repair_ms"] == pytest.approx(1700.0)
    assert figures["p95_ms"] == pytest.approx(700.0)


def test_names_of_cases_are_unique() -> None:
    assert len(CASES) == len(cases.every_case())


@pytest.mark.parametrize("name", [name for name in CASES if name.startswith("hidden/")])
def test_hidden_senders_reach_the_receiver_but_not_each_other(name: str) -> None:
    run = CASES[name].of(1)
    snr_db = run.snr_db()
    assert snr_db[0][2] is None
    assert snr_db[2][0] is None
    assert min(snr_db[0][1] or 0.0, snr_db[2][1] or 0.0) >= run.receive_threshold_db


@pytest.mark.parametrize("name", [name for name in CASES if ", hidden, " in name])
def test_in_a_hidden_chain_two_hops_are_sensed_and_three_only_heard(name: str) -> None:
    run = CASES[name].of(1)
    (one, two, three) = (snr for snr in run.snr_db()[0][1:4] if snr is not None)
    assert one >= run.receive_threshold_db > two >= run.carrier_sense_db > three > 0.0


def test_exposed_senders_sense_each_other_and_receivers_hear_their_own_only() -> None:
    run = CASES["exposed/1 Mb/s, basic"].of(1)
    snr_db = run.snr_db()
    (near, far) = run.paths
    assert (snr_db[near[0]][far[0]] or 0.0) >= run.carrier_sense_db
    assert snr_db[near[1]][far[0]] is None
    assert snr_db[far[1]][near[0]] is None


@pytest.mark.parametrize("seed", range(1, 11))
def test_random_topologies_are_connected_and_differ(seed: int) -> None:
    places = cases.scattered(seed)
    near = [pair for pair in combinations(range(10), 2) if math.dist(*(places[i] for i in pair)) <= 25.0]
    reached = {0}
    for _ in places:
        reached |= {there for pair in near if reached & set(pair) for there in pair}
    assert len(reached) == len(places)
    assert places != cases.scattered(seed + 1)


@pytest.mark.parametrize("name", [name for name in CASES if CASES[name].of(1).protocol])
def test_messages_are_handed_over_at_ticks_one_robot_at_a_time(name: str) -> None:
    times = [at_s for at_s, *_ in CASES[name].of(1).messages]
    ticks = [round(at_s / cases.TICK_S) for at_s in times]
    assert times == pytest.approx([tick * cases.TICK_S for tick in ticks])
    assert len(set(ticks)) == len(ticks)


def test_onehop_carries_a_saturated_flow_over_static_routes() -> None:
    """One hop .784 Mb/s with 28 B of header; two hops in one cell share it."""
    places = ((0.0, 0.0), (10.0, 0.0), (20.0, 0.0))
    one, two = (
        measures(run, ours.simulate(run))
        for run in (
            Run(seed=1, seconds=4.0, places=places, paths=path, fading_db=0.0)
            for path in (((0, 1),), ((0, 1, 2),))
        )
    )
    assert one["mbps"] == one["end_to_end_mbps"] == pytest.approx(0.784, abs=0.005)
    assert two["mbps"] == pytest.approx(0.795, abs=0.01)
    assert two["end_to_end_mbps"] == pytest.approx((two["mbps"] or 0.0) / 2.0, rel=0.1)


@pytest.mark.parametrize(("protocol", "least_ms"), [("aodv", 15.398), ("dsr", 15.718)])
def test_onehop_carries_messages_over_its_routing_protocols(protocol: str, least_ms: float) -> None:
    """Two hops as ns-3's AODV has them; MRSR adds 16 and 20 B of source route, 0.16 ms a hop."""
    run = Run(
        seed=1,
        seconds=3.0,
        places=((0.0, 0.0), (20.0, 0.0), (40.0, 0.0)),
        protocol=protocol,
        messages=tuple((1.0 + 0.25 * k, 0, 2) for k in range(5)),
    )
    figures = measures(run, ours.simulate(run))
    assert figures["delivered"] == 1.0
    assert figures["p50_ms"] == pytest.approx(least_ms, abs=0.002)
    assert (figures["first_ms"] or 0.0) > least_ms


def test_who_leaves_is_out_of_reach_from_then_on() -> None:
    run = Run(
        seed=1,
        seconds=4.0,
        places=((0.0, 0.0), (10.0, 0.0)),
        protocol="dsr",
        messages=((1.0, 0, 1), (2.5, 0, 1)),
        leaves=((1, 2.0),),
    )
    first, second = ours.simulate(run)["arrivals_s"]
    assert first == pytest.approx(1.02, abs=0.02)
    assert second is None


def row(theirs: list[float], own: list[float]) -> Row:
    return Row("hidden/x", tuple({"mbps": v} for v in theirs), tuple({"mbps": v} for v in own))


@pytest.mark.parametrize(
    ("own", "says"),
    [
        ([1.0, 1.001, 0.999], "yes"),
        ([1.2, 1.201, 1.199], "no"),
        ([1.0, 1.05, 0.95], "not sure"),
    ],
)
def test_verdict_is_of_the_whole_interval(own: list[float], says: str) -> None:
    assert verdict(row([1.0, 1.001, 0.999], own), "mbps")[1] == says


def test_nothing_on_both_sides_is_said() -> None:
    assert verdict(row([0.0, 0.0], [0.0, 0.0]), "mbps")[1] == "both 0"
    assert verdict(row([0.0, 0.0], [1.0, 1.0]), "mbps")[1] == "–"


def test_a_run_that_ended_ns3_is_counted_in_the_table() -> None:
    table = "\n".join(markdown([Row("hidden/x", ({"mbps": 1.0}, {}), ({"mbps": 1.0}, {"mbps": 1.0}))]))
    assert "1 of 2 runs ended ns-3" in table


@pytest.mark.live
def test_without_ns3_the_benchmark_says_so_in_one_line(tmp_path: Path) -> None:
    nothing = ["--python", str(tmp_path / "python"), "--ns3-results", str(tmp_path / "none.jsonl")]
    done = subprocess.run(
        [sys.executable, str(BENCH / "ns3.py"), "exposed/*", *nothing],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == NOT_INSTALLED
    assert "not installed" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert done.stdout == ""
