"""The part that a robot plays in its team, as one table of transitions (thesis 3.3, 4.3).

Theory of operation. A robot is always in exactly one mode. What happens to it is told as an event, and
the table below says which mode follows; an event that the table does not give for a mode is a bug of
ours and raises. The thesis's modes are here under their names: Setup, Next (`leading`, `following`),
Narrow, Lost_Leader. Its Lost_Follower is no mode but a command: the receiver goes on in the mode that
the new roster gives it.

A first incarnation starts in `setup`; a restarted one in `joining`, because it has no roster and must
not act on an old one. Three families of modes follow:
- acting as leader: `leading`, or `alone` when it is the only member;
- following: `following`, `narrow` in the column, `border following` while an obstacle lies between the
  robot and its slot (it interrupts Algorithm 1 and resumes it, thesis 3.3.4), `giving way` while the
  leader wants a lane kept clear (lane.py);
- without a leader: `lost leader` while the elected one is not heard, `joining` while it asks to be
  taken in.
`stopped` is where a mission ends: the leader at its goal, a follower in its last slot, or a robot of
profile `thesis` that hears nobody and is told to stop.
"""

from collections.abc import Iterable
from enum import StrEnum

from onehop.contracts.team import Mode


class ModeEvent(StrEnum):
    """What can happen to a robot's part in the team."""

    FORMED = "formed"  # the leader's setup is over
    TOLD_SETUP = "told setup"  # obeys a command of a team that still gathers
    TOLD_NEXT = "told next"  # obeys a command to drive in the open
    TOLD_NARROW = "told narrow"  # obeys a command to drive in column
    TOLD_TO_MAKE_ROOM = "told to make room"  # obeys a command to keep a lane clear
    OBSTRUCTED = "obstructed"  # an obstacle lies between it and its slot
    CLEARED = "cleared"  # back in the clear, in the open
    CLEARED_NARROW = "cleared in column"  # back in the clear, in column
    LEADER_SILENT = "leader silent"  # its leader was given up, another one is elected
    ELECTED = "elected"  # leads the roster in force
    LEFT_ALONE = "left alone"  # is the only member of the roster in force
    GAVE_WAY = "gave way"  # handed the team over to another leader
    LEFT_OUT = "left out"  # its leader's roster lacks it
    ARRIVED = "arrived"  # at the goal, or in the last slot, or at the end of all ways
    ORPHANED = "orphaned"  # hears nobody, and stops (profile thesis, orphan = stop)


START, RESTART = Mode.SETUP, Mode.JOINING
"""Mode of a first incarnation, and of any later one."""

_ANY = {
    ModeEvent.TOLD_SETUP: Mode.SETUP,
    ModeEvent.TOLD_NEXT: Mode.FOLLOWING,
    ModeEvent.TOLD_NARROW: Mode.NARROW,
    ModeEvent.TOLD_TO_MAKE_ROOM: Mode.GIVING_WAY,
    ModeEvent.ELECTED: Mode.LEADING,
    ModeEvent.LEFT_ALONE: Mode.ALONE,
    ModeEvent.GAVE_WAY: Mode.FOLLOWING,
}
_LED = {
    **_ANY,
    ModeEvent.LEADER_SILENT: Mode.LOST_LEADER,
    ModeEvent.LEFT_OUT: Mode.JOINING,
    ModeEvent.ORPHANED: Mode.STOPPED,
}
_ON_THE_WAY = {**_LED, ModeEvent.OBSTRUCTED: Mode.BORDER, ModeEvent.ARRIVED: Mode.STOPPED}

TABLE: dict[Mode, dict[ModeEvent, Mode]] = {
    Mode.SETUP: {**_LED, ModeEvent.FORMED: Mode.LEADING, ModeEvent.ARRIVED: Mode.STOPPED},
    Mode.LEADING: {**_ANY, ModeEvent.ARRIVED: Mode.STOPPED, ModeEvent.ORPHANED: Mode.STOPPED},
    Mode.ALONE: {**_ANY, ModeEvent.ARRIVED: Mode.STOPPED},
    Mode.FOLLOWING: _ON_THE_WAY,
    Mode.NARROW: _ON_THE_WAY,
    Mode.BORDER: {
        **_ON_THE_WAY,
        ModeEvent.TOLD_NEXT: Mode.BORDER,
        ModeEvent.TOLD_NARROW: Mode.BORDER,
        ModeEvent.OBSTRUCTED: Mode.BORDER,
        ModeEvent.CLEARED: Mode.FOLLOWING,
        ModeEvent.CLEARED_NARROW: Mode.NARROW,
    },
    Mode.GIVING_WAY: {**_LED, ModeEvent.ARRIVED: Mode.STOPPED},
    Mode.LOST_LEADER: _LED,
    Mode.JOINING: {**_ANY, ModeEvent.ORPHANED: Mode.STOPPED},
    Mode.STOPPED: {**_LED, ModeEvent.ARRIVED: Mode.STOPPED},
}
"""mode -> event -> next mode: the whole state machine."""


def next_mode(mode: Mode, event: ModeEvent) -> Mode:
    """The mode that follows; LookupError when the table has no such transition (a bug of ours)."""
    try:
        return TABLE[mode][event]
    except KeyError:
        raise LookupError(f"no transition from {mode.value} on {event.value}") from None


def diagram() -> str:
    """The table as a Mermaid state diagram.

    What leads to the same mode from everywhere is drawn once, from `any_mode`; a mode that answers such
    an event in another way has an edge of its own. Other edges from a mode to itself are left out.
    """

    def name(mode: Mode) -> str:
        return mode.value.replace(" ", "_")

    lines = ["stateDiagram-v2", f"    [*] --> {name(START)}", f"    [*] --> {name(RESTART)}: restarted"]
    lines += _edges("any_mode", _ANY.items())
    for mode, row in TABLE.items():
        own = [
            (event, target)
            for event, target in row.items()
            if (_ANY[event] is not target if event in _ANY else target is not mode)
        ]
        lines += _edges(name(mode), own)
    return "\n".join(lines) + "\n"


def _edges(source: str, transitions: Iterable[tuple[ModeEvent, Mode]]) -> list[str]:
    """One line of the diagram for each mode that these transitions lead to."""
    events: dict[Mode, list[str]] = {}
    for event, target in transitions:
        events.setdefault(target, []).append(event.value)
    return [
        f"    {source} --> {target.value.replace(' ', '_')}: {', '.join(names)}"
        for target, names in events.items()
    ]
