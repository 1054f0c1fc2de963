"""`profile = "thesis"` at the top of a scenario: the thesis's own stack, as defaults of its sections.

A profile fills in what the file leaves out, section by section; a key that is given wins. All that it
switches on has a key of its own (docs/thesis.md), so a log's scenario says the whole of it, and reading
that again changes nothing.
"""

from typing import Any

NEXT_PERIOD = 2.0
"""T of the thesis [s] (3.3.2, 4.3), if the scenario gives no team.next_period."""


def with_profile(table: dict[str, Any]) -> dict[str, Any]:
    """The table of a scenario with what its profile adds; the table itself stays as it is."""
    if table.get("profile") != "thesis":
        return table
    given = {name: table.get(name, {}) for name in ("team", "gains", "planner")}
    if not all(isinstance(section, dict) for section in given.values()):
        return table
    return table | {name: _THESIS[name](section) | section for name, section in given.items()}


def _team(given: dict[str, Any]) -> dict[str, Any]:
    """3.3.3: one missing acknowledgement is a lost follower; 4.3: T after the target is reached."""
    silence = given.get("next_period", NEXT_PERIOD)
    return {"profile": "thesis", "lost_after": 1, "target_timeout": silence}


def _gains(_: dict[str, Any]) -> dict[str, Any]:
    """3.5: two-valued k_rho, driving backwards by eq. 3.10; 3.8.3: a threshold for each slot."""
    return {"policy": "throughput", "threshold": "slot", "reverse": True}


def _planner(given: dict[str, Any]) -> dict[str, Any]:
    """3.4: Algorithm 2, which classifies obstacles all the time; 4.2: a saved path, if there is one."""
    return {"kind": "path" if given.get("path") else "modified", "classify": "driving"}


_THESIS = {"team": _team, "gains": _gains, "planner": _planner}
