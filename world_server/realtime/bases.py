"""The drivers of real bases: what they measure is taken in when a tick ends, and the newest counts.

Nobody waits for them once the mission has begun. What no base can have measured is dropped, and people
are told of the first. Whose measurement is old does not drive on by it, and who measures nothing sound
for too long has no base any more, and leaves.
"""

import contextlib
import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial

from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.contracts.geometry import STANDSTILL, Twist
from onehop.contracts.hardware import Drive, Measured, Taken
from onehop.contracts.messages import Truth
from onehop.node.bus import Bus
from onehop.wire.codec import decode, encode
from onehop.wire.journal import WireMessage
from world_server.core.bases import Bases
from world_server.mailbox import Mailbox, MissionBrokenError
from world_server.roll_call import RollCall

FIRST_S = 30.0
"""How long the driver of a base may take for its first measurement once it is there [s]."""


@dataclass(slots=True)
class _Base:
    """What the world knows of one. newest: what it has put since the last look, and when that came [s].

    sound_s: when its last sound measurement came [s]. dropped: how many have been since then, and why
    the last one was.
    """

    robot: int
    put: Callable[[bytes], None]
    newest: tuple[bytes, float] | None = None
    sound_s: float = 0.0
    dropped: int = 0
    why: str = ""

    @property
    def name(self) -> str:
        return topics.base_name(self.robot)

    @property
    def excuse(self) -> str:
        """What is to be added where nothing sound has come."""
        if not self.dropped:
            return ""
        how_many = "one measurement was" if self.dropped == 1 else f"{self.dropped} measurements were"
        return f": {how_many} dropped, the last because {self.why}"


class RealTimeBases:
    """All of them. silence_s: how long one may measure nothing [s], hold_s: and be driven all the same.

    open_briefings: lets processes ask for their briefings meanwhile: a driver may come again.
    """

    def __init__(
        self,
        bus: Bus,
        mail: Mailbox,
        roll: RollCall,
        bases: Bases,
        silence_s: float,
        hold_s: float,
        open_briefings: Callable[[], AbstractContextManager[None]],
    ) -> None:
        self._mail = mail
        self._roll = roll
        self._rules = bases
        self._silence_s = silence_s
        self._hold_s = hold_s
        self._open_briefings = open_briefings
        self._briefings: contextlib.ExitStack | None = None
        self._tell = bus.publisher(topics.to(topics.OPERATOR, topics.TOLD))
        self._excused_s = 0.0
        self._taken: dict[int, Measured] = {}
        self._last_taken: Mapping[int, Measured] = {}
        self._bases = [
            _Base(i, bus.publisher(topics.to(topics.base_name(i), topics.DRIVE), may_drop=True))
            for i in bases
        ]
        for base in self._bases:
            mail.read(base.name, topics.MEASURED, partial(self._on_measured, base))

    def await_all(self) -> None:
        """Wait for a sound measurement of each. Raises MissionBrokenError."""
        if not self._mail.wait(self._all_have_measured, FIRST_S):
            base = next(one for one in self._bases if not one.sound_s)
            raise MissionBrokenError(f"{base.name} measured nothing within {FIRST_S:g} s{base.excuse}")

    def _all_have_measured(self) -> bool:
        self._take_in()
        return all(base.sound_s for base in self._bases)

    def take(self) -> Mapping[int, Measured]:
        """The newest measurement of each robot's base that came since the last call, ids ascending."""
        self._take_in()
        taken, self._taken = self._taken, {}
        self._last_taken = taken
        return taken

    def record(self, tick: int, time_ns: int) -> list[WireMessage]:
        """What was taken in last, for the log: it holds from this tick on."""
        return [
            (topics.base(robot), encode(Taken(tick, time_ns, measured)))
            for robot, measured in self._last_taken.items()
        ]

    def drive(self, tick: int, drives: Mapping[int, Twist]) -> None:
        """Tell each by what it is to drive, as this tick has ended; to rest, if it has not measured."""
        now_s = time.monotonic()
        for base in self._bases:
            is_fresh = now_s - base.sound_s <= self._hold_s
            base.put(encode(Drive(tick, drives[base.robot] if is_fresh else STANDSTILL)))

    def fenced(self, truth: Truth) -> dict[int, str]:
        """Robots that have no base any more, and why they leave."""
        self._let_in()
        fenced: dict[int, str] = {}
        present = {one.robot for one in truth.present}
        for base in self._bases:
            if base.robot not in present:
                continue
            if base.name not in self._roll.present:
                fenced[base.robot] = "its base is gone"
            elif time.monotonic() - max(base.sound_s, self._excused_s) > self._silence_s:
                fenced[base.robot] = f"its base is silent for {self._silence_s:g} s{base.excuse}"
        return fenced

    def excuse(self) -> None:
        """Nobody could be heard: the patience with each begins anew."""
        self._excused_s = time.monotonic()

    def _let_in(self) -> None:
        """Answer a driver that comes again, as long as one is missing."""
        is_missing = any(base.name not in self._roll.present for base in self._bases)
        if is_missing and self._briefings is None:
            self._briefings = contextlib.ExitStack()
            self._briefings.enter_context(self._open_briefings())
        elif not is_missing and self._briefings is not None:
            self._briefings.close()
            self._briefings = None

    def _on_measured(self, base: _Base, data: bytes) -> None:
        base.newest = data, time.monotonic()

    def _take_in(self) -> None:
        for base in self._bases:
            if base.newest is None:
                continue
            (data, came_s), base.newest = base.newest, None
            try:
                measured = decode(Measured, data)
                wrong = self._rules.refusal(base.robot, measured)
            except DecodeError as error:
                wrong = str(error)
            if wrong is None:
                base.sound_s, base.dropped = came_s, 0
                self._taken[base.robot] = measured
            else:
                if not base.why:
                    self._tell(f"{base.name}: a measurement is dropped: {wrong}".encode())
                base.dropped, base.why = base.dropped + 1, wrong
