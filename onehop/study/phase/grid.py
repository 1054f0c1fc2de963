"""The missions of the phase diagram: k_rho_min by length of the delay, under each policy."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

from onehop.contracts.errors import InputError
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.study.chapter4.missions import HELD, HOLD_AT_S, LINKS, SETUP_TIMEOUT_S
from onehop.study.grid import Cell, KeyValue, cells

K_RHO_MIN = (0.1, 0.2, 0.3, 0.5, 1.0)
HOLD_S = (5.0, 10.0, 15.0, 20.0)
POLICIES = ("constant", "throughput")


@dataclass(frozen=True, slots=True)
class Grid:
    """What is varied. scenario: the mission. policies: the first is what the others are held against.

    Raises InputError for a value that stands twice, and for a single policy.
    """

    scenario: Path
    settings: Sequence[str]
    k_rho_min: Sequence[float] = K_RHO_MIN
    hold_s: Sequence[float] = HOLD_S
    policies: Sequence[str] = POLICIES

    def __post_init__(self) -> None:
        named = (("--k-rho-min", self.k_rho_min), ("--hold", self.hold_s), ("--policies", self.policies))
        for option, values in named:
            if len(set(values)) < len(values):
                raise InputError(f"{option} {_joined(values)}", "a value stands twice", "each once")
        if len(self.policies) < 2:
            where, problem = f"--policies {_joined(self.policies)}", "nothing to compare"
            raise InputError(where, problem, "at least two, e.g. constant,throughput")

    @property
    def places(self) -> list[tuple[float, float]]:
        """Every (k_rho_min [1/s], length of the delay [s])."""
        return list(product(self.k_rho_min, self.hold_s))

    def base(self) -> Bundle:
        """The mission that is varied. Raises InputError."""
        return scenario_file.load(self.scenario, self._settings(self.hold_s[0]))

    def cells(self, seed: int) -> list[Cell]:
        """Every place under each policy. seed: each is tried with it. Raises InputError."""
        return [
            self._cell(k, hold_s, {"policy": policy}, [f"gains.policy={policy}"], seed)
            for k, hold_s in self.places
            for policy in self.policies
        ]

    def bounds(self, seed: int) -> list[Cell]:
        """Every place with a perfect link; and with none each length, for there no gain is in force."""
        perfect, none = LINKS
        alone = [(self.k_rho_min[0], hold_s) for hold_s in self.hold_s]
        return [
            self._cell(
                k,
                hold_s,
                {"link": link},
                [f"gains.policy={self.policies[0]}", f"radio.link={link}"],
                seed,
            )
            for link, places in ((perfect, self.places), (none, alone))
            for k, hold_s in places
        ]

    def _cell(
        self, k: float, hold_s: float, values: dict[str, KeyValue], changes: list[str], seed: int
    ) -> Cell:
        settings = [*self._settings(hold_s), f"gains.k_rho_min={k:g}", *changes]
        (one,) = cells(self.scenario, settings, (), seed)
        return replace(one, values={"k_rho_min": k, "hold_s": hold_s, **values})

    def _settings(self, hold_s: float) -> list[str]:
        hold = f'kind="hold", at_s={HOLD_AT_S:g}, robots={list(HELD)}, duration_s={hold_s:g}'
        return [f"faults=[{{{hold}}}]", f"team.setup_timeout={SETUP_TIMEOUT_S:g}", *self.settings]


def _joined(values: Sequence[object]) -> str:
    return ",".join(map(str, values))
