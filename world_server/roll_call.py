"""Who takes part at this moment, and what it means when somebody is missing.

A process is present while its liveliness token is. Without radio or recorder a mission has no meaning,
and a start or restart has none without those whom it waits for: then the mission is broken off. The
launcher learns how a process ended, and says so; a token that vanishes says only that its process is
gone, so its loss counts a moment later.

If the router is a process of its own it may go, and come back. All tokens vanish with it, the world's
own too: that tells it from the end of one process. Whoever was there is out of sight then, and not gone.
In real time a radio whose token vanishes is so, too: nothing can happen without it.
"""

import time
from collections.abc import Callable, Iterable, Set
from functools import partial

from onehop.contracts import topics
from onehop.contracts.operation import Death
from onehop.node.bus import ALIVE
from onehop.wire.codec import decode
from world_server.mailbox import Mailbox, MissionBrokenError

ACCOUNT_S = 1.0
"""Time for a launcher to say how a process ended, until the loss of its token is the reason [s]."""

BLINK_S = 0.1
"""How long after a token it may turn out that the router has gone with it [s]: all vanish at once."""

INDISPENSABLE = frozenset((topics.RADIO, topics.RECORDER))


class RollCall:
    """Presence of radio, recorder, robots and real bases. robots: ids of the team.

    recorder_away_s: how long the recorder may be gone from the bus while its process lives [s].
    bases: robots with a real one.
    radio_may_be_away, router_may_go: whether the mission can wait for either.
    """

    def __init__(
        self,
        mail: Mailbox,
        robots: Iterable[int],
        recorder_away_s: float = ACCOUNT_S,
        bases: Iterable[int] = (),
        radio_may_be_away: bool = False,
        router_may_go: bool = False,
    ) -> None:
        self._mail = mail
        self._radio_may_be_away = radio_may_be_away
        self._router_may_go = router_may_go
        self.router_is_gone = False
        self._vanished: dict[str, float] = {}
        self._out_of_sight: set[str] = set()
        self._on_reunion: Callable[[str], None] = lambda _: None
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
        mail.read(topics.WORLD, topics.alive(topics.WORLD), self._on_own_token)
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

    def when_seen_again(self, act: Callable[[str], None]) -> None:
        """Call `act` with the name of each process that was out of sight and is not any more."""
        self._on_reunion = act

    def settle(self) -> bool:
        """Whether nobody is out of sight. Whose token has vanished without the router's is gone now."""
        if self.router_is_gone or self._out_of_sight:
            return False
        due_s = time.monotonic() - BLINK_S
        for name in [name for name, at_s in self._vanished.items() if at_s <= due_s]:
            del self._vanished[name]
            self._lose(name)
        return True

    def give_up(self) -> None:
        """Who is out of sight is gone."""
        for name in sorted(self._out_of_sight):
            self._lose(name)
        self._out_of_sight.clear()

    def wait_for_nobody(self) -> None:
        """From now on who is gone from the bus is gone: the mission is over."""
        self._radio_may_be_away = self._router_may_go = self.router_is_gone = False
        for name in (*self._vanished, *sorted(self._out_of_sight)):
            self._lose(name)
        self._vanished.clear()
        self._out_of_sight.clear()

    def gather(self, names: Iterable[str], limit_s: float) -> None:
        """Wait until all of these are present. Raises MissionBrokenError when one dies or is late."""
        self._awaited = frozenset(names)
        if not self._mail.wait(self._all_are_there, limit_s):
            missing = ", ".join(sorted(self._awaited - self._present))
            raise MissionBrokenError(f"not started within {limit_s:g} s: {missing}")
        self._awaited = frozenset()

    def _all_are_there(self) -> bool:
        return self.settle() and self._awaited <= self._present

    def _is_needed(self, name: str) -> bool:
        return name in INDISPENSABLE or name in self._awaited

    def _on_token(self, name: str, data: bytes) -> None:
        if data == ALIVE:
            self._vanished.pop(name, None)
            self._present.add(name)
            self._mail.call_off(_gone(name))
            self._on_return.get(name, lambda: None)()
            if name in self._out_of_sight:
                self._out_of_sight.discard(name)
                self._on_reunion(name)
        elif self.router_is_gone or (self._radio_may_be_away and name == topics.RADIO):
            self._out_of_sight.add(name)
        elif self._router_may_go:
            self._vanished[name] = time.monotonic()
        else:
            self._lose(name)

    def _on_own_token(self, data: bytes) -> None:
        self.router_is_gone = self._router_may_go and data != ALIVE
        if self.router_is_gone:
            self._out_of_sight.update(self._vanished)
            self._vanished.clear()

    def _lose(self, name: str) -> None:
        self._present.discard(name)
        if self._is_needed(name):
            self._mail.break_off(_gone(name), after_s=self._away_s.get(name, ACCOUNT_S))

    def _on_death(self, data: bytes) -> None:
        death = decode(Death, data)
        self._died[death.name] = death.incarnation
        if self._is_needed(death.name) and death.incarnation == self._incarnations[death.name]:
            self._mail.break_off(death.account)


def _gone(name: str) -> str:
    return f"the {name} process is gone from the bus: killed, stopped or cut off"
