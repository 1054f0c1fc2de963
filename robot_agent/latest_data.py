"""One robot in real time: it steps on the newest observation, with all that has come from the radio.

Observations that have come meanwhile are passed over; nothing from the radio is. The answer names what
went into it, so that the step can be re-executed from the log.
"""

from collections import deque
from collections.abc import Callable

from onehop.contracts.messages import Observation, percept
from onehop.contracts.realtime import Acted, Heard
from onehop.programs.host import Host
from onehop.wire.codec import decode, encode
from onehop.wire.heard import inbox_of

KEPT_ANSWERS = 16
"""Answers that are kept to be said again: more than there are questions on their way at a time."""


class LatestData:
    """Keeps what comes until it is asked to step. put: takes an encoded `Acted`.

    is_used: whether the mission has turned out to be in real time.
    """

    def __init__(self, host: Host, put: Callable[[bytes], None]) -> None:
        self._host = host
        self._put = put
        self.is_used = False
        self._steps = 0
        self._observation: bytes | None = None
        self._heard: list[Heard] = []
        self._said: deque[bytes] = deque(maxlen=KEPT_ANSWERS)

    def on_observation(self, data: bytes) -> None:
        """The world's word; an older one that has not been used is of no use any more."""
        self.is_used = True
        self._observation = data

    def on_heard(self, data: bytes) -> None:
        """The radio's word."""
        self._heard.append(decode(Heard, data))

    @property
    def can_step(self) -> bool:
        """Whether there is an observation that has not been used."""
        return self._observation is not None

    def step(self) -> None:
        """Use what is there. Raises ProgramError."""
        assert self._observation is not None
        seen = decode(Observation, self._observation)
        inbox = inbox_of(seen.tick, seen.time_ns, self._heard)
        self._observation, self._heard = None, []
        said = self._host.step(percept(seen, inbox))
        self._steps += 1
        acted = encode(Acted(self._steps, inbox.heard, said))
        self._said.append(acted)
        self._put(acted)

    def say_again(self) -> None:
        """The bus was gone: answers may be lost. The world knows which it has."""
        for acted in self._said:
            self._put(acted)
