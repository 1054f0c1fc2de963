"""What has been run of chapter 4, and what it says: cells, differences, claims."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from onehop.campaign.lines import Row
from onehop.study.cell_summary import cell, changed
from onehop.study.chapter4 import failing, ways
from onehop.study.chapter4.claims import (
    TO_MRSR,
    TO_VARIABLE,
    ideal_claim,
    policy_claims,
    routing_claims,
)
from onehop.study.claims import Judgement
from onehop.study.comparison import chosen, strata


@dataclass(slots=True)
class Found:
    """Rows of each part, as far as they have been run."""

    delayed: list[Row] = field(default_factory=list)
    undelayed: list[Row] = field(default_factory=list)
    bounds: list[Row] = field(default_factory=list)
    ways: list[Row] = field(default_factory=list)
    failing: list[Row] = field(default_factory=list)

    def judgements(self) -> list[Judgement]:
        """Every claim of chapter 4, and what came of it."""
        found = [*policy_claims(self.delayed), *routing_claims(self.delayed)]
        found.append(ideal_claim(self.undelayed))
        found.append(ways.way_claim(self.ways))
        return [*found, *failing.failing_claims(self.failing)]

    def cells(self) -> list[dict[str, Any]]:
        """The cells of 4.2."""
        return _cells(self.delayed, "map", "routing", "policy")

    def bound_cells(self) -> list[dict[str, Any]]:
        """The same missions with a perfect link, and with none."""
        return _cells(self.bounds, "map", "link")

    def differences(self) -> list[dict[str, Any]]:
        """From constant to variable k_rho, and from MRDV to MRSR, in each cell and over all of them."""
        rows = self.delayed
        found = []
        for key, (before, after), others in (
            ("policy", TO_VARIABLE, ("map", "routing")),
            ("routing", TO_MRSR, ("map", "policy")),
        ):
            every = strata(rows, *others)
            names = {"key": key, "against": before[key], key: after[key]}
            found += [changed({**names, **one}, rows, before, after, [one]) for one in every]
            all_of_them = dict.fromkeys(others, "all")
            found.append(changed({**names, **all_of_them}, rows, before, after, every))
        return found


def _cells(rows: Sequence[Row], *keys: str) -> list[dict[str, Any]]:
    return [cell(where, chosen(rows, where)) for where in strata(rows, *keys)]
