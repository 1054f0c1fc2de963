"""`onehop elect`: leader, shape and slots of a team, as every robot computes them."""

from onehop.commands.numbers import ROBOT, require_within
from onehop.commands.output import emit_json, stdout, table
from onehop.contracts.errors import InputError
from onehop.contracts.sections import MOST_ROBOTS
from robot_agent.core.team.formation import formation


def elect(ids: str, narrow: bool, spacing: float, as_json: bool) -> int:
    """Print the formation of a team; returns the exit status."""
    team = _parse(ids)
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
    for robot in team:
        require_within(ROBOT, "IDS", robot)
    if len(team) > MOST_ROBOTS:
        raise InputError("IDS", f"{len(team)} robots", f"a team of at most {MOST_ROBOTS}")
    if len(set(team)) < len(team):
        raise InputError(f"IDS {ids!r}", "an id stands twice", "name every robot once")
    return team
