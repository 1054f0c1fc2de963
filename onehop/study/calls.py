"""The studies as calls, for notebooks: what `onehop study` runs, and the object that `--json` prints."""

import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from onehop.campaign.workers import workers
from onehop.study.chapter4.study import Asked, ThesisStudy
from onehop.study.phase.grid import HOLD_S, K_RHO_MIN, POLICIES, Grid
from onehop.study.phase.study import PolicyStudy
from onehop.study.sweeping import Nobody
from onehop.wire.output_folder import held


def thesis(
    *,
    out: Path | str,
    scenarios: Path | str = Path("scenarios") / "thesis",
    seeds: int = 20,
    first_seed: int = 1,
    settings: Iterable[str] = (),
    jobs: int | None = None,
    dask: str | None = None,
) -> dict[str, Any]:
    """Chapter 4 of the thesis again; figures and page are in `out`, which is gone on with if it has any.

    scenarios: folder of the missions. settings: "key.path=value", for those of 4.2. jobs, dask: as in
    `study.sweep`. Raises InputError; warns of missions that have crashed.
    """
    folder, asked = Path(out), Asked(Path(scenarios), tuple(settings), _range(seeds, first_seed))
    study = ThesisStudy(asked, folder, workers(jobs, dask), _unheard)
    return _run(study, folder)


def policies(
    scenario: Path | str,
    *,
    out: Path | str,
    policies: Sequence[str] = POLICIES,
    k_rho_min: Sequence[float] = K_RHO_MIN,
    hold_s: Sequence[float] = HOLD_S,
    seeds: int = 20,
    first_seed: int = 1,
    settings: Iterable[str] = (),
    jobs: int | None = None,
    dask: str | None = None,
) -> dict[str, Any]:
    """Where a gain policy matters; heat maps and page are in `out`, which is gone on with.

    policies: the first is what the others are held against. k_rho_min [1/s], hold_s: for how long the
    followers are held [s]. The rest as in `study.thesis`. Raises InputError; warns of missions that have
    crashed.
    """
    gains, holds = [float(k) for k in k_rho_min], [float(value) for value in hold_s]
    grid = Grid(Path(scenario), tuple(settings), gains, holds, tuple(policies))
    folder, seeded = Path(out), _range(seeds, first_seed)
    return _run(PolicyStudy(grid, seeded, folder, workers(jobs, dask), _unheard), folder)


def _run(study: ThesisStudy | PolicyStudy, folder: Path) -> dict[str, Any]:
    with held(folder):
        study.run()
        study.draw()
    if study.crashed:
        first = study.crashed[0]
        warnings.warn(f"{len(study.crashed)} missions crashed; {first.name}: {first.why}", stacklevel=3)
    return study.summary or {}


def _range(seeds: int, first: int) -> range:
    return range(first, first + seeds)


def _unheard(_: str, __: int) -> Nobody:
    return Nobody()
