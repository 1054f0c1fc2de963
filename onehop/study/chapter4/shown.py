"""Which missions of 4.2 are drawn: of each map and routing one seed, under both policies."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from onehop.analysis.log import Log, open_log
from onehop.campaign.lines import Row
from onehop.campaign.workers import Crash, Run
from onehop.contracts.errors import InputError, MissionError
from onehop.study.chapter4.missions import CONSTANT, VARIABLE
from onehop.study.comparison import chosen
from onehop.study.grid import Cell
from onehop.study.mission import MissionOrder, run_mission
from onehop.wire.output_folder import explained

Place = tuple[str, str]
"""Map and routing."""


def typical_seed(rows: Sequence[Row], place: Place) -> int:
    """The first seed that loses as many robots, under constant and under variable k_rho, as most do."""
    ground, routing = place
    lost: dict[str, dict[int, int]] = {
        policy: {
            row["seed"]: row["lost"]
            for row in chosen(rows, {"map": ground, "routing": routing, "policy": policy})
        }
        for policy in (CONSTANT, VARIABLE)
    }
    both = {
        seed: (lost[CONSTANT][seed], lost[VARIABLE][seed])
        for seed in sorted(lost[CONSTANT].keys() & lost[VARIABLE].keys())
    }
    counted = Counter(both.values())
    return min(both, key=lambda seed: (-counted[both[seed]], seed))


def logs(
    cells: Sequence[Cell], rows: Sequence[Row], folder: Path, workers: Run
) -> dict[Place, dict[str, Log]]:
    """The log of each mission that is drawn, by place and policy; run once more if it is not there.

    Raises InputError if a mission is not the one that was measured, MissionError if it crashes.
    """
    with explained(folder, "a folder that can be written, with room for logs"):
        folder.mkdir(exist_ok=True)
    paths: dict[Place, dict[str, Path]] = {}
    orders, digests = [], {}
    for cell in cells:
        ground, routing, policy = (str(cell.values[key]) for key in ("map", "routing", "policy"))
        seed = typical_seed(rows, (ground, routing))
        path = folder / f"{ground}-{routing}-{policy}-{seed}.mcap"
        (measured,) = [row for row in chosen(rows, cell.values) if row["seed"] == seed]
        digests[path] = measured["digest"]
        paths.setdefault((ground, routing), {})[policy] = path
        orders.append(
            MissionOrder(path.stem, cell.values, cell.with_seed(seed), "all", path.absolute(), False)
        )
    for done in workers(run_mission, [order for order in orders if not order.log.exists()]):
        if isinstance(done.result, Crash):
            raise MissionError(f"{done.item.name}: {done.result.why}")
    return {
        place: {policy: _measured(path, digests[path]) for policy, path in of_policy.items()}
        for place, of_policy in paths.items()
    }


def _measured(path: Path, digest: str) -> Log:
    """The log, if it is of the mission with this digest."""
    log = open_log(path)
    if log.summary is None or log.summary["digest"] != digest:
        remedy = "give another --out: the results there are of other programs"
        raise InputError(str(path), "is not the mission that was measured", remedy)
    return log


def by_map(shown: Mapping[Place, Mapping[str, Log]]) -> dict[str, dict[str, Mapping[str, Log]]]:
    """The same by map, and then by routing."""
    found: dict[str, dict[str, Mapping[str, Log]]] = {}
    for (ground, routing), of_policy in shown.items():
        found.setdefault(ground, {})[routing] = of_policy
    return found
