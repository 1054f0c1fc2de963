"""`onehop elect`: leader, shape and slots of a team, as every robot computes them."""

from onehop.commands.output import emit_json, stdout, table
from onehop.contracts.errors import InputError
from robot_agent.core.team.formation import formation


def elect(ids: str, narrow: bool, spacing: float, as_json: bool) -> int:
    """Print the formation of a team; returns the exit status."""
    team = _parse(ids)
    if not spacing > 0:
        raise InputError(f"--spacing {spacing}", "is not positive", "metres between neighbours, e.g. 4")
    made = formation(team, narrow, spacing)
    slots = [
        {"robot": slot.robot, "x": round(slot.x, 6) + 0.0, "y": round(slot.y, 6) + 0.0}
        for slot in made.slots
    ]
    if as_json:
        emit_json({"leader": made.leader, "shape": made.shape.value, "slots": slots})
        return 0
    print(f"leader {made.leader}, {made.shape.value} of {len(team)}")
    if slots:
        rows = table("Slots in the leader's frame", "robot", "x forward m", "y left m")
        for slot in slots:
            rows.add_row(str(slot["robot"]), f"{slot['x']:.2f}", f"{slot['y']:.2f}")
        stdout().print(rows)
    return 0


def _parse(ids: str) -> tuple[int, ...]:
    try:
        team = tuple(sorted(int(part) for part in ids.split(",")))
    except ValueError:
        raise InputError(f"IDS {ids!r}", "is not a list of robot ids", "e.g. 1,2,4,5") from None
    if team[0] < 1:
        raise InputError(f"IDS {ids!r}", f"id {team[0]}", "ids are 1 or more")
    if len(set(team)) < len(team):
        raise InputError(f"IDS {ids!r}", "an id stands twice", "name every robot once")
    return team
