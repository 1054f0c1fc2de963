"""The missions of 4.2: three maps, two routings, two policies, the delay at 60 s; and their bounds.

What the thesis leaves open is chosen here, once, with the reason; `--set` changes any of it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

from onehop.contracts.errors import InputError
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.study.grid import Cell, KeyValue, cells

MAPS = ("map1", "map2", "map3")
ROUTINGS = ("mrsr", "mrdv")

CONSTANT, VARIABLE = "constant", "throughput"
"""`gains.policy` of the thesis's two cases (4.2): constant low k_rho, and variable k_rho."""

POLICIES = (CONSTANT, VARIABLE)

LINKS = ("perfect", "none")
LINK_WORDS = {"perfect": "perfect link", "none": "no link"}
"""`radio.link` of the bounds: every message arrives at once, and none does."""

HOLD_AT_S = 60.0
"""4.2.1: "until second 60 when the delay period was imposed"."""

HOLD_S = 10.0
K_RHO_MIN = 0.1
SETUP_TIMEOUT_S = 120.0
HELD = (1, 2, 4, 5, 6)

CHOICES = (
    (
        "Who is delayed: all five followers, robots 1, 2, 4, 5 and 6.",
        "4.2 speaks of “a delay time for the follower robots”, and loses others on maps 2 and 3 than on "
        "map 1.",
    ),
    (
        f"How long: {HOLD_S:g} s from second {HOLD_AT_S:g} on, in which they stand still.",
        "The second is the thesis's (4.2.1), the length is not given. The leader drives 10 m meanwhile; "
        "after 18 s it would be out of range of the last of them (25 m at 32 dB), and then no gain "
        "could help. onehop study policies varies it.",
    ),
    (
        f"The low k_rho: {K_RHO_MIN:g}/s.",
        "Not given. Under the constant low k_rho follower 2 was below the threshold “as soon as the "
        "leader started moving” (4.2.2). A follower trails its slot by V_L / k_rho: by 10 m at 0.1/s, "
        "which is 14 m to 18 m from its leader, where the mean throughput falls to the threshold; by "
        "3.3 m at 0.3/s, where it does not.",
    ),
    (
        f"Setup may take {SETUP_TIMEOUT_S:g} s.",
        "Not given. At 0.1/s a follower takes more than the 40 s that are the default to creep into its "
        "slot, and would be lost before it has moved.",
    ),
    (
        "The grounds, and the leader's way on each.",
        "The thesis's are pictures. The ways were found once by Algorithm 2 and are driven again in "
        "every mission, as its saved trajectories were.",
    ),
)
"""What the thesis leaves open: the choice, and its reason."""

HOLD = f'faults=[{{kind="hold", at_s={HOLD_AT_S:g}, robots={list(HELD)}, duration_s={HOLD_S:g}}}]'


def bases(folder: Path, settings: Sequence[str]) -> list[Bundle]:
    """The mission of each map, held; settings come last. Raises InputError."""
    return [scenario_file.load(path, _settings(settings)) for path in _paths(folder).values()]


def _settings(settings: Sequence[str]) -> list[str]:
    gain, setup = f"gains.k_rho_min={K_RHO_MIN:g}", f"team.setup_timeout={SETUP_TIMEOUT_S:g}"
    return [HOLD, gain, setup, *settings]


def _paths(folder: Path) -> dict[str, Path]:
    paths = {name: folder / f"{name}.toml" for name in MAPS}
    for path in paths.values():
        if not path.exists():
            remedy = "--scenarios with the folder scenarios/thesis of Onehop's repository"
            raise InputError(str(path), "no such file: a mission of chapter 4 is missing", remedy)
    return paths


def delayed(folder: Path, settings: Sequence[str], seed: int) -> list[Cell]:
    """The twelve cells of 4.2. seed: with which each is tried on its map. Raises InputError."""
    return [
        cell
        for name, path in _paths(folder).items()
        for routing, policy in product(ROUTINGS, POLICIES)
        for cell in _cell(
            path,
            [*_settings(settings), f"radio.routing={routing}", f"gains.policy={policy}"],
            {"map": name, "routing": routing, "policy": policy},
            seed,
        )
    ]


def undelayed(folder: Path, settings: Sequence[str], seed: int) -> list[Cell]:
    """The same missions with variable k_rho, and nobody held: "ideal mission conditions" (4.2)."""
    return [
        cell
        for name, path in _paths(folder).items()
        for routing in ROUTINGS
        for cell in _cell(
            path,
            [*_settings(settings), f"radio.routing={routing}", f"gains.policy={VARIABLE}", "faults=[]"],
            {"map": name, "routing": routing, "policy": VARIABLE},
            seed,
        )
    ]


def bounds(folder: Path, settings: Sequence[str], seed: int) -> list[Cell]:
    """The delayed missions with constant k_rho, over a perfect link and over none."""
    return [
        cell
        for name, path in _paths(folder).items()
        for link in LINKS
        for cell in _cell(
            path,
            [*_settings(settings), f"gains.policy={CONSTANT}", f"radio.link={link}"],
            {"map": name, "link": link},
            seed,
        )
    ]


def _cell(path: Path, settings: Sequence[str], values: dict[str, KeyValue], seed: int) -> Iterator[Cell]:
    for one in cells(path, settings, (), seed):
        yield replace(one, values=values)
