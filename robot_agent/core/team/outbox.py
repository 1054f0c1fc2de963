"""What a robot has to say in one tick: messages for its NIC, notes for people."""

from collections.abc import Sequence

from onehop.contracts.action_limits import NOTES, ActionLimits
from onehop.contracts.messages import Note, NoteValue, Transmission
from robot_agent.core.team.team_messages import TeamMessage, encode

PROTOCOL_NOTES = NOTES // 2
"""Notes of the protocol that are told in a tick, from the first; the rest is for the way-finding."""


class Outbox:
    """Collects what is said until it is taken, once a tick; no more than a robot may say in one.

    Others could make it say more: every command asks for an answer. lifetime_ns: how long a message is
    of use, unless it says so itself.
    """

    def __init__(self, limits: ActionLimits, lifetime_ns: int) -> None:
        self._limits = limits
        self._lifetime_ns = lifetime_ns
        self._outbox: list[Transmission] = []
        self._notes: list[Note] = []

    def send(self, robot: int, message: TeamMessage, msdu_bytes: int) -> None:
        """Hand a message for one robot, or for everyone, to the NIC."""
        self.send_to((robot,), message, msdu_bytes)

    def send_to(
        self,
        robots: Sequence[int],
        message: TeamMessage,
        msdu_bytes: int,
        lifetime_ns: int | None = None,
    ) -> None:
        """The same message for several robots, in this order.

        msdu_bytes: least size on the air. lifetime_ns: 0 for ever, None as long as others.
        """
        lifetime_ns = self._lifetime_ns if lifetime_ns is None else lifetime_ns
        payload = encode(message)
        size = max(msdu_bytes, len(payload))
        self._outbox += [Transmission(robot, payload, size, lifetime_ns) for robot in robots]

    def note(self, kind: str, **data: NoteValue) -> None:
        """Tell people something."""
        self._notes.append(Note(kind, dict(sorted(data.items()))))

    def take_outbox(self) -> tuple[Transmission, ...]:
        """What is to be sent, once."""
        if not self._outbox:
            return ()
        outbox, self._outbox = self._limits.fitting(self._outbox), []
        return tuple(outbox)

    def take_notes(self) -> tuple[Note, ...]:
        """What is to be told, once."""
        if not self._notes:
            return ()
        notes, self._notes = self._notes[:PROTOCOL_NOTES], []
        return tuple(notes)
