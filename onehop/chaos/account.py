"""What a campaign has to say when it is over: counts, properties, and what was never tried."""

from dataclasses import dataclass
from typing import Any

from onehop.chaos.hunt import Hunt
from onehop.chaos.properties import PROPERTIES, kind_of
from onehop.chaos.sometimes import SOMETIMES
from onehop.checking.invariants import INVARIANTS


@dataclass(frozen=True, slots=True)
class PropertyLine:
    """One property over all missions. judged: missions in which it was, at least once."""

    name: str
    says: str
    judged: int
    broken: int


def property_lines(hunt: Hunt) -> list[PropertyLine]:
    """Every property that must hold, in the order in which they are told."""
    lines = []
    for name, says in {**INVARIANTS, **PROPERTIES}.items():
        broken = sum(any(one["property"] == name for one in row["failures"]) for row in hunt.rows)
        judged = len(hunt.rows)
        if name in INVARIANTS:
            judged = sum(row["checked"].get(name, 0) > 0 for row in hunt.rows)
        elif name == "same-bytes":
            judged = sum(row["repeat"] != "once" for row in hunt.rows)
        lines.append(PropertyLine(name, says, judged, broken))
    return lines


def never(hunt: Hunt) -> list[str]:
    """What should sometimes happen and did in no mission, and invariants that none has judged."""
    seen = hunt.total("seen")
    unseen = [name for name in SOMETIMES if not seen[name]]
    unjudged = [line.name for line in property_lines(hunt) if not line.judged]
    return unseen + [f"{name} was judged" for name in unjudged]


def exit_status(hunt: Hunt) -> int:
    """That of the worst kind of failure; 0 without any."""
    return max((int(kind_of(one.failure.property)) for one in hunt.found), default=0)


def as_json(hunt: Hunt) -> dict[str, Any]:
    """The JSON object of `onehop chaos`."""
    outcomes: dict[str, int] = {}
    for row in hunt.rows:
        outcomes[row["outcome"]] = outcomes.get(row["outcome"], 0) + 1
    return {
        "runs": len(hunt.rows),
        "violations": len(hunt.found),
        "failures": [
            {
                "seed": one.seed,
                "invariant": one.failure.property,
                "scenario": None if one.scenario is None else str(one.scenario),
                "mission": one.name,
                "tick": one.failure.tick,
                "robots": list(one.failure.robots),
                "what": one.failure.what,
            }
            for one in hunt.found
        ],
        "faults": dict(sorted(hunt.faults().items())),
        "missions_per_s": round(hunt.tried_now / hunt.wall_s, 3) if hunt.wall_s > 0 else 0.0,
        "robot_hours": round(hunt.robot_hours(), 2),
        "outcomes": outcomes,
        "repeated": {
            how: sum(row["repeat"] == how for row in hunt.rows) for how in ("twice", "processes")
        },
        "checked": dict(hunt.total("checked")),
        "sometimes": {name: hunt.total("seen")[name] for name in SOMETIMES},
        "never": never(hunt),
    }
