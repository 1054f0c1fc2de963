"""4.3 and figures 3.3 and 3.4: robots that fail, and who leads whom in which shape after it."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from onehop.campaign.lines import Row
from onehop.contracts.messages import Action, Carriage
from onehop.contracts.team import Status
from onehop.drivers import inline
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.study.claims import Claim, Expects, Judgement, judge
from onehop.study.statistics import estimate
from world_server.core.world import World


class Expected(NamedTuple):
    """What the thesis says comes of it, and where."""

    what: str
    leader: int
    shape: str
    members: tuple[int, ...]
    source: str


EXPECTED: dict[str, Expected] = {
    "follower-5-lost": Expected(
        "follower 5 of six fails", 3, "wedge", (1, 2, 3, 4, 6), "3.3.5 I, fig. 3.3"
    ),
    "followers-6-and-1-lost": Expected(
        "followers 6 and 1 of six fail", 3, "diamond", (2, 3, 4, 5), "4.3, fig. 4.21"
    ),
    "leader-3-lost": Expected("leader 3 of six stops", 4, "wedge", (1, 2, 4, 5, 6), "4.3, fig. 4.22"),
    "leader-3-cut-off": Expected(
        "leader 3 of six is cut off, and lives", 4, "wedge", (1, 2, 4, 5, 6), "4.3"
    ),
    "leader-3-of-five-lost": Expected(
        "leader 3 of five fails", 2, "diamond", (1, 2, 4, 5), "3.3.5 II, fig. 3.4 a"
    ),
    "follower-4-of-five-lost": Expected(
        "follower 4 of five fails", 2, "diamond", (1, 2, 3, 5), "3.3.5 II, fig. 3.4 b"
    ),
}
"""By scenario file."""


@dataclass(frozen=True, slots=True)
class FailingOrder:
    """One mission to run. name: of its row. scenario: its key in EXPECTED."""

    name: str
    scenario: str
    bundle: Bundle


def orders(folder: Path, seeds: Sequence[int]) -> Iterator[FailingOrder]:
    """Each scenario with each seed. Raises InputError."""
    bundles = {name: scenario_file.load(folder / f"{name}.toml") for name in EXPECTED}
    for seed in seeds:
        for name, bundle in bundles.items():
            seeded = Bundle(replace(bundle.scenario, seed=seed), bundle.files)
            yield FailingOrder(f"{name} seed={seed}", name, seeded)


class _LastSaid:
    """What each robot says of its team in the last tick."""

    def __init__(self) -> None:
        self.status: dict[int, Status] = {}

    def watch(self, _: World, actions: Mapping[int, Action], __: Carriage) -> None:
        self.status = {
            robot: action.status for robot, action in actions.items() if action.status is not None
        }


def run_failing(order: FailingOrder) -> Row:
    """Run a mission, and say who leads the largest team at its end."""
    said = _LastSaid()
    outcome = inline.run(order.bundle, None, said.watch)
    leader = leader_of_most(said.status)
    members = tuple(sorted(robot for robot, one in said.status.items() if one.leader == leader))
    shape = str(said.status[leader].shape) if leader in said.status else ""
    expected = EXPECTED[order.scenario]
    as_reported = (leader, shape, members) == (expected.leader, expected.shape, expected.members)
    return {
        "name": order.name,
        "values": {"scenario": order.scenario},
        "seed": order.bundle.scenario.seed,
        "outcome": outcome.outcome,
        "sim_s": outcome.sim_s,
        "leader": leader,
        "shape": shape,
        "members": list(members),
        "as_reported": int(as_reported),
    }


def leader_of_most(status: Mapping[int, Status]) -> int:
    """Whom most robots obey; of several the lowest id."""
    counted = Counter(one.leader for one in status.values())
    return min(counted, key=lambda leader: (-counted[leader], leader), default=0)


def failing_claims(rows: Sequence[Row]) -> Iterator[Judgement]:
    """Of each scenario in how many missions leader, shape and team were not the thesis's."""
    for name, expected in EXPECTED.items():
        own = [row for row in rows if row["values"]["scenario"] == name]
        if not own:
            continue
        team = ", ".join(map(str, expected.members))
        says = f"If {expected.what}, robot {expected.leader} leads a {expected.shape} of {team}."
        claim = Claim(says, expected.source, "other_team", Expects.NONE, "of the missions")
        yield judge(claim, estimate([1 - row["as_reported"] for row in own]), len(own))
