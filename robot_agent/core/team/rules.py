"""What differs between the profiles: the thesis alone, and a team under loss (docs/modes.md).

Pure answers to the protocol's questions; the protocol is the same for both.
"""

from enum import Enum
from typing import Protocol

from onehop.contracts.sections import TeamSection
from onehop.contracts.serial_numbers import newer
from onehop.contracts.units import nanoseconds
from robot_agent.core.team.part import Following, Joining, Leading, Part, Waiting
from robot_agent.core.team.roster import Roster


class Meeting(Enum):
    """What to do about another leader in reach whose roster is not obeyed."""

    IGNORE = "ignore"
    MERGE = "form the union of both rosters"
    ASK = "ask it to take this robot in"


class Rules(Protocol):
    """One profile.

    beacons: leaders are heard by everyone in range, and robots ask to join. trail: a Next tells the
    leader's way; followers form up on its course, settle beside slots that cannot be had, and make
    room. repeats_handover: until the new leader is heard. calls: a robot that lost its leader says so.
    successor_patience_ns: silence of an elected leader until it is given up too. orphan_stops: who hears
    nobody any more stops; otherwise it goes on alone.
    """

    beacons: bool
    trail: bool
    repeats_handover: bool
    calls: bool
    orphan_stops: bool
    successor_patience_ns: int

    def obeys(self, part: Part, mine: Roster, source: int, roster: Roster, overdue: bool) -> bool:
        """Whether to obey a roster that lists this robot, said by its leader `source`.

        mine: roster in force. overdue: the present leader has missed a Next.
        """
        ...

    def accepts_handover(self, mine: Roster, source: int, roster: Roster) -> bool:
        """Whether to believe `source` that this roster, with another leader, is in force now."""
        ...

    def on_meeting(self, part: Part, source: int, mine: Roster) -> Meeting:
        """What to do about the leader `source`, which is not obeyed."""
        ...

    def lost_at_setup(self, missing: tuple[int, ...]) -> tuple[int, ...]:
        """Who of those that are not in position when setup times out is lost."""
        ...


class ThesisRules:
    """The rules of the thesis alone (3.3.3 to 3.3.5, 3.8.1)."""

    beacons = trail = repeats_handover = calls = False

    def __init__(self, team: TeamSection) -> None:
        self.successor_patience_ns = nanoseconds(team.leader_timeout)
        self.orphan_stops = team.orphan == "stop"

    def obeys(self, part: Part, mine: Roster, source: int, roster: Roster, overdue: bool) -> bool:  # noqa: ARG002
        """Nobody obeys a stranger while it hears its own leader, and a leader obeys nobody."""
        return not isinstance(part, Leading) and (
            not isinstance(part, Following) or source == mine.leader
        )

    def accepts_handover(self, mine: Roster, source: int, roster: Roster) -> bool:  # noqa: ARG002
        """Lost_Follower counts from the own leader only."""
        return source == mine.leader

    def on_meeting(self, part: Part, source: int, mine: Roster) -> Meeting:  # noqa: ARG002
        """Teams do not merge."""
        return Meeting.IGNORE

    def lost_at_setup(self, missing: tuple[int, ...]) -> tuple[int, ...]:
        """All of them (3.3.3)."""
        return missing


class TeamRules:
    """Epochs, yielding, merging and joining.

    A roster without the leader that this robot hears is not obeyed, whatever its
    epoch, because one robot that was cut off for long would otherwise tear the team apart. The two
    leaders merge as soon as they hear each other.
    """

    beacons = trail = repeats_handover = calls = True
    orphan_stops = False

    def __init__(self, team: TeamSection) -> None:
        self.successor_patience_ns = nanoseconds(team.successor_timeout)

    def obeys(self, part: Part, mine: Roster, source: int, roster: Roster, overdue: bool) -> bool:  # noqa: ARG002
        """The better roster; who waits obeys any that is not older, who joins any that lists it."""
        if roster == mine or isinstance(part, Joining):
            return True
        if isinstance(part, Following) and mine.leader not in roster.members and not overdue:
            return False
        waits = isinstance(part, Waiting) and not newer(mine.epoch, roster.epoch)
        return waits or roster.beats(mine)

    def accepts_handover(self, mine: Roster, source: int, roster: Roster) -> bool:  # noqa: ARG002
        """From anyone, if the roster is better."""
        return roster.beats(mine)

    def on_meeting(self, part: Part, source: int, mine: Roster) -> Meeting:
        """Leaders merge with strangers; who hears no leader asks."""
        if isinstance(part, Leading):
            return Meeting.IGNORE if source in mine.members else Meeting.MERGE
        return Meeting.IGNORE if isinstance(part, Following) else Meeting.ASK

    def lost_at_setup(self, missing: tuple[int, ...]) -> tuple[int, ...]:  # noqa: ARG002
        """Nobody: one that answers and is still on its way can be led.

        Differs: the thesis loses it.
        """
        return ()


def make_rules(team: TeamSection) -> Rules:
    """The rules of the profile that a scenario names."""
    return TeamRules(team) if team.profile == "team" else ThesisRules(team)
