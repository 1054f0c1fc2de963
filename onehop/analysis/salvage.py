"""A sound log from a torn or damaged one: every whole tick that can be read, once and in its order.

Records are copied, not understood, so that a viewer layer or metadata of a later version survive too.
Behind a damaged place the log goes on with the next chunk that is sound; what is missing between is said
whenever the saved log is opened, and a re-execution ends there. Beside a damaged place and at a tear a
tick is given up unless everything that world, radio and robots owe each other in it is there.
"""

from dataclasses import dataclass
from pathlib import Path

from mcap.records import Message

from onehop.analysis.copying import LogCopy, parsed
from onehop.analysis.survey import Survey, survey, tick_of
from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import Truth, running
from onehop.wire.audit import audit
from onehop.wire.codec import decode
from onehop.wire.contents import records_of
from onehop.wire.log_reader import LogFile
from onehop.wire.selection import WIRE


@dataclass(frozen=True, slots=True)
class Salvage:
    """What was saved and what was lost. ticks: how many were saved. last_tick: -1 when none was.

    given_up: messages of ticks that were not whole. copies: messages that were there twice.
    unread_bytes: bytes of the file that belong to no sound record. damage: what is wrong with it, where.
    flaws: what the saved log lacks of what was recorded. ended: the outcome is there.
    """

    ticks: int
    last_tick: int
    messages: int
    given_up: int
    copies: int
    unread_bytes: int
    damage: list[str]
    flaws: list[str]
    ended: bool


def salvage(torn: Path, out: Path) -> Salvage:
    """Write a sound log to `out`. Raises LogError when `torn` is no log of ours at all."""
    clock = LogFile(torn).bundle.scenario.clock
    found = survey(torn, clock.period_ns)
    with LogCopy(out, "salvaged") as copy, torn.open("rb") as stream:
        copy.take_apart(stream, found.apart)
        for schema in found.schemas:
            copy.take_schema(schema)
        for channel in found.channels.values():
            copy.take_channel(channel)
        rescue = _Rescue(copy, found, clock.is_realtime)
        for piece in found.pieces:
            rescue.begin(piece.first_tick)
            for record in parsed(records_of(piece.stretch, stream)):
                if isinstance(record, Message):
                    rescue.take(tick_of(record, clock.period_ns), record)
        rescue.end()
        copy.finish()
    saved = LogFile(out)
    return Salvage(
        ticks=rescue.ticks,
        last_tick=rescue.last_tick,
        messages=rescue.messages,
        given_up=rescue.given_up,
        copies=rescue.copies,
        unread_bytes=sum(loss.length for loss in found.losses),
        damage=[f"damaged near byte {loss.at}: {loss.why}" for loss in found.losses],
        flaws=audit(saved),
        ended=saved.summary is not None,
    )


class _Tick:
    """The messages of one tick; wire: bytes by bus key."""

    def __init__(self) -> None:
        self.messages: list[Message] = []
        self.wire: dict[str, bytes] = {}

    def truth(self) -> Truth | None:
        """Its ground truth, None if it is not there."""
        try:
            return decode(Truth, self.wire.get(topics.TRUTH, b""))
        except DecodeError:
            return None


class _Rescue:
    """Collects messages tick by tick, and copies those of whole ticks."""

    def __init__(self, copy: LogCopy, found: Survey, in_real_time: bool) -> None:
        self._is_whole = _is_whole_in_real_time if in_real_time else _is_whole
        self._copy = copy
        self._is_sound = found.ended and not found.losses
        self._ended = found.ended
        self._pending: dict[int, _Tick] = {}
        self.ticks, self.last_tick = 0, -1
        self.messages, self.given_up, self.copies = 0, 0, 0

    def begin(self, first_tick: int) -> None:
        """From now on no message comes of a tick before first_tick."""
        for tick in sorted(self._pending):
            if tick + 1 < first_tick:
                self._settle(tick)

    def take(self, tick: int, message: Message) -> None:
        """A message; of several of one wire channel and tick the first counts."""
        pending = self._pending.setdefault(tick, _Tick())
        topic = self._copy.topics[message.channel_id]
        if topic.startswith(WIRE):
            key = topic.removeprefix(WIRE)
            if key in pending.wire:
                self.copies += 1
                return
            pending.wire[key] = message.data
        pending.messages.append(message)

    def end(self) -> None:
        """No message comes any more."""
        for tick in sorted(self._pending):
            self._settle(tick)

    def _settle(self, tick: int) -> None:
        """Copy a tick, or give it up. Those after it are still there."""
        one = self._pending.pop(tick)
        is_last = not self._pending and self._ended
        if one.wire and not (
            self._is_sound or self._is_whole(one, self._pending.get(tick + 1), is_last)
        ):
            self.given_up += len(one.messages)
            return
        if one.wire and tick != self.last_tick + 1:
            self._copy.settle()
        for message in one.messages:
            self._copy.take_message(message)
        self.messages += len(one.messages)
        if one.wire:
            self.ticks += 1
            self.last_tick = tick


def _is_whole(one: _Tick, following: _Tick | None, is_last: bool) -> bool:
    """Whether everything is there that was said in a tick.

    A robot may owe its action if it leaves with the tick that follows, or if none follows because the
    mission ended: it died before it could act.
    """
    truth = one.truth()
    if truth is None or topics.RADIO_RECORD not in one.wire:
        return False
    after = None if following is None else following.truth()
    gone = set() if after is None else {departure.robot for departure in after.departures}
    present = [presence.robot for presence in running(truth)]
    return all(
        topics.rx(robot) in one.wire
        and topics.obs(robot) in one.wire
        and (topics.out(robot) in one.wire or robot in gone or is_last)
        for robot in present
    )


def _is_whole_in_real_time(one: _Tick, following: _Tick | None, is_last: bool) -> bool:
    """The same where any robot may owe its action: only what follows tells that none is lost."""
    truth = one.truth()
    if truth is None or topics.RADIO_RECORD not in one.wire:
        return False
    present = [presence.robot for presence in running(truth)]
    return (following is not None or is_last) and all(
        topics.obs(robot) in one.wire
        and (topics.rx(robot) in one.wire) == (topics.out(robot) in one.wire)
        for robot in present
    )
