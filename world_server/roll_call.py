"""Who takes part at this moment, and what it means when somebody is missing.

A process is present while its liveliness token is. Without radio or recorder a mission has no meaning,
and a start or restart has none without those whom it waits for: then the mission is broken off. The
launcher learns how a process ended, and says so; a token that vanishes says only that its process is
gone, so its loss counts a moment later.
"""

from collections.abc import Callable, Iterable, Set
from functools import partial

from onehop.contracts import topics
from onehop.contracts.operation import Death
from onehop.node.bus import ALIVE
from onehop.wire.codec import decode
from world_server.mailbox import Mailbox, MissionBrokenError

ACCOUNT_S = 1.0
"""Time for a launcher to say how a process ended, until the loss of its token is the reason [s]."""

INDISPENSABLE = frozenset((topics.RADIO, topics.RECORDER))


class RollCall:
    """Presence of radio, recorder, robots and real bases. robots: ids of the team.

    recorder_away_s: how long the recorder may be gone from the bus while its process lives [s].
    bases: robots with a real one.
    """

    def __init__(
        self,
        mail: Mailbox,
        robots: Iterable[int],
        recorder_away_s: float = ACCOUNT_S,
        bases: Iterable[int] = (),
    ) -> None:
        self._mail = mail
        self._away_s = {topics.RECORDER: recorder_away_s}
        self._on_return: dict[str, Callable[[], None]] = {}
        own = *map(topics.robot_name, robots), *map(topics.base_name, bases)
        self.everyone = (topics.RADIO, topics.RECORDER, *own)
        self._present: set[str] = set()
        self._awaited: frozenset[str] = frozenset()
        self._incarnations = dict.fromkeys(self.everyone, 0)
        self._died: dict[str, int] = {}
        for name in self.everyone:
            mail.read(topics.WORLD, topics.alive(name), partial(self._on_token, name))
        mail.read(topics.OPERATOR, topics.DIED, self._on_death)

    @property
    def present(self) -> Set[str]:
        """Names of the processes that are present: always this moment's."""
        return self._present

    def incarnation(self, name: str) -> int:
        """How often this process has been started again."""
        return self._incarnations[name]

    def has_died(self, name: str) -> bool:
        """Whether the launcher has told of the end of the present process of this name."""
        return self._died.get(name) == self._incarnations[name]

    def expect_again(self, name: str, incarnation: int) -> None:
        """The process of this name is about to be started again."""
        self._incarnations[name] = incarnation

    def when_present(self, name: str, act: Callable[[], None]) -> None:
        """Call `act` whenever this process comes to the bus, or comes back."""
        self._on_return[name] = act

    def gather(self, names: Iterable[str], limit_s: float) -> None:
        """Wait until all of these are present. Raises MissionBrokenError when one dies or is late."""
        self._awaited = frozenset(names)
        if not self._mail.wait(lambda: self._awaited <= self._present, limit_s):
            missing = ", ".join(sorted(self._awaited - self._present))
            raise MissionBrokenError(f"not started within {limit_s:g} s: {missing}")
        self._awaited = frozenset()

    def _is_needed(self, name: str) -> bool:
        return name in INDISPENSABLE or name in self._awaited

    def _on_token(self, name: str, data: bytes) -> None:
        reason = f"the {name} process is gone from the bus: killed, stopped or cut off"
        if data == ALIVE:
            self._present.add(name)
            self._mail.call_off(reason)
            self._on_return.get(name, lambda: None)()
            return
        self._present.discard(name)
        if self._is_needed(name):
            self._mail.break_off(reason, after_s=self._away_s.get(name, ACCOUNT_S))

    def _on_death(self, data: bytes) -> None:
        death = decode(Death, data)
        self._died[death.name] = death.incarnation
        if self._is_needed(death.name) and death.incarnation == self._incarnations[death.name]:
            self._mail.break_off(death.account)
