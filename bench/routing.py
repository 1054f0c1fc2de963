"""What MRSR and MRDV cost a mission: `python bench/routing.py` prints one JSON object.

Whole missions, world and robots included, that force messages over relays or keep routing busy. The
thesis says that MRSR has a little less overhead, because it caches, and a little more delay, because its
messages carry source routes (4.2). Each figure is a mean over missions; `seeds_as_in_the_thesis` says in
how many pairs of missions of one seed MRSR had less, or more.

routing_bytes: routing packets, every hop of each. with_source_routes: and what source routes add to
data. ms_a_hop: of delivered Next messages, from service to arrival without discovery, their median in a
mission; ms_a_hop_in_all: the mean, with discovery.
"""

import argparse
import json
import statistics
import sys
from pathlib import Path

from onehop.contracts import topics
from onehop.contracts.messages import DeliveryStatus, RadioRecord
from onehop.drivers import inline
from onehop.scenario import scenario_file
from onehop.wire.codec import decode
from onehop.wire.journal import Journal

SCENARIOS = Path(__file__).parents[1] / "scenarios"
PROTOCOLS = ("mrsr", "mrdv")
NEXT_BYTES = 800


def cut(at_s: float, robots: str, others: str) -> str:
    """A cut of 15 s as an inline table."""
    return f'{{kind="cut", at_s={at_s}, robots=[{robots}], others=[{others}], duration_s=15}}'


FOLLOWERS_CUT = ", ".join(
    cut(at_s, robots, "3")
    for at_s, robots in ((30, "1"), (47, "5, 6"), (64, "2, 4"), (81, "1, 6"), (98, "2, 5"))
)
MISSIONS: dict[str, tuple[str, ...]] = {
    "followers_cut_from_their_leader": ("map1.toml", f"faults=[{FOLLOWERS_CUT}]"),
    "only_a_chain_is_left": (
        "map1.toml",
        f"faults=[{cut(30, '3, 4', '1, 6')}, {cut(60, '3', '1, 2, 6')}]",
    ),
    "formation_as_wide_as_the_range": ("map3.toml", "team.spacing=8"),
    "a_jam_on_the_way": (
        "map1.toml",
        'faults=[{kind="jam", at_s=20, x=30, y=30, radius=12, noise_dbm=-62}]',
    ),
    "leaders_die": (
        "map1.toml",
        "team.size=9",
        'faults=[{kind="kill", at_s=30, robots=[5]}, {kind="kill", at_s=60, robots=[4]}, '
        '{kind="kill", at_s=90, robots=[6]}]',
    ),
    "twelve_robots": ("map2.toml", "team.size=12"),
}


def mission(scenario: str, settings: tuple[str, ...], routing: str, seed: int) -> dict[str, float]:
    """Run one and take its measures."""
    records: list[RadioRecord] = []
    journal = Journal(
        lambda _, record: records.append(decode(RadioRecord, dict(record)[topics.RADIO_RECORD]))
    )
    every = [f"seed={seed}", "clock.limit_s=120", f'radio.routing="{routing}"', *settings]
    inline.run(scenario_file.load(SCENARIOS / scenario, every), journal)
    nexts = [
        verdict for record in records for verdict in record.verdicts if verdict.msdu_bytes == NEXT_BYTES
    ]
    arrived = [verdict for verdict in nexts if verdict.status is DeliveryStatus.DELIVERED]
    hops = [len(verdict.path) - 1 for verdict in arrived]
    taken = [verdict.arrival_ns - verdict.service_start_ns for verdict in arrived]
    moving = [time - verdict.discovery_ns for time, verdict in zip(taken, arrived, strict=True)]
    counted = records[-1].control_bytes
    total = sum(counted.values())
    return {
        "routing_bytes": total - counted.get("source_route", 0),
        "with_source_routes": total,
        "ms_a_hop": statistics.median(t / n for t, n in zip(moving, hops, strict=True)) / 1e6,
        "ms_a_hop_in_all": sum(taken) / sum(hops) / 1e6,
        "hops": sum(hops) / len(hops),
        "delivered_share": len(arrived) / len(nexts),
    }


def compare(name: str, seeds: int) -> dict[str, object]:
    """Both protocols through the same missions."""
    scenario, *settings = MISSIONS[name]
    rows: dict[str, list[dict[str, float]]] = {routing: [] for routing in PROTOCOLS}
    for seed in range(1, seeds + 1):
        for routing in PROTOCOLS:
            rows[routing].append(mission(scenario, tuple(settings), routing, seed))
        print(f"{name}: seed {seed} of {seeds}", file=sys.stderr, flush=True)
    pairs = list(zip(rows["mrsr"], rows["mrdv"], strict=True))
    return {
        **{
            routing: {key: round(statistics.fmean(row[key] for row in own), 3) for key in own[0]}
            for routing, own in rows.items()
        },
        "seeds_as_in_the_thesis": {
            "fewer_routing_bytes": sum(s["routing_bytes"] < v["routing_bytes"] for s, v in pairs),
            "more_ms_a_hop": sum(s["ms_a_hop"] > v["ms_a_hop"] for s, v in pairs),
        },
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--mission", choices=sorted(MISSIONS), action="append")
    options = parser.parse_args()
    names = options.mission or list(MISSIONS)
    report = {name: compare(name, options.seeds) for name in names}
    print(json.dumps({"seeds": options.seeds, "missions": report}, indent=1))


if __name__ == "__main__":
    main()
