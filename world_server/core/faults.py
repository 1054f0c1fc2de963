"""Faults by script and by hand: which begin with a tick, and which are in force.

Kill, restart, kidnap and continue are instants; the world carries out what of them concerns its robots.
The others last for their duration, or to the next heal, or to the end. Everything changes at tick
boundaries only.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from onehop.contracts.fault_section import FaultSection
from onehop.contracts.messages import Corruption, Cut, Jam, Slow
from world_server.core.mission_events import MissionEvent

OF_ONE_ROBOT = frozenset(("hold", "stop", "blind", "slow"))
"""Lasting faults that each robot suffers by itself; the others are of a link or a place."""

LASTING = OF_ONE_ROBOT | {"cut", "corrupt", "jam"}


@dataclass(frozen=True, slots=True)
class _Lasting:
    fault: FaultSection
    end_ns: int | None


class _Waiting(NamedTuple):
    """A fault whose time is known. number: its place in the script."""

    time_ns: int
    number: int
    fault: FaultSection


class Faults:
    """The faults of one mission. robots: everyone in the team."""

    def __init__(self, script: tuple[FaultSection, ...], robots: tuple[int, ...]) -> None:
        self._robots = robots
        self._waiting: list[_Waiting] = []
        self._on_event: list[tuple[int, FaultSection]] = []
        self._seen: Counter[str] = Counter()
        for number, fault in enumerate(script):
            if fault.at_s is None:
                self._on_event.append((number, fault))
            else:
                self._waiting.append(_Waiting(_ns(fault.at_s), number, fault))
        self._lasting: list[_Lasting] = []
        self._publish()

    @property
    def will_restart(self) -> bool:
        """Whether the script is sure to restart somebody yet."""
        return any(waiting.fault.kind == "restart" for waiting in self._waiting)

    def on_event(self, event: MissionEvent, time_ns: int) -> None:
        """Something has happened that faults may follow, each once."""
        self._seen[event.what] += 1
        still: list[tuple[int, FaultSection]] = []
        for number, fault in self._on_event:
            if (fault.on, fault.nth) == (event.what, self._seen[event.what]):
                who = fault if fault.robots else replace(fault, robots=_actor(fault, event))
                self._waiting.append(_Waiting(time_ns + _ns(fault.after_s), number, who))
            else:
                still.append((number, fault))
        self._on_event = still

    def due(self, time_ns: int, by_hand: Sequence[FaultSection] = ()) -> tuple[FaultSection, ...]:
        """The faults that begin now, in the order of the script, then by hand; equal ones count once."""
        if not (self._waiting or by_hand):
            return ()
        at_s = time_ns / 1e9
        due = [one for one in self._waiting if one.time_ns <= time_ns]
        self._waiting = [one for one in self._waiting if one.time_ns > time_ns]
        scripted = [one.fault for one in sorted(due, key=lambda one: one.number)]
        return tuple(dict.fromkeys(fault.begun(at_s) for fault in (*scripted, *by_hand)))

    def begin(self, fault: FaultSection, time_ns: int) -> None:
        """Put a fault into force that lasts, or end what one heals."""
        if fault.kind == "heal":
            self._lasting = list(_healed(self._lasting, fault.robots, None))
        elif fault.kind == "continue":
            self._lasting = list(_healed(self._lasting, fault.robots, "stop"))
        elif fault.kind in LASTING:
            end_ns = time_ns + _ns(fault.duration_s) if fault.duration_s else None
            self._lasting.append(_Lasting(fault, end_ns))
        self._publish()

    def expire(self, time_ns: int) -> None:
        """End what has lasted its time."""
        if not self._lasting:
            return
        if any(lasting.end_ns is not None and lasting.end_ns <= time_ns for lasting in self._lasting):
            self._lasting = [
                lasting
                for lasting in self._lasting
                if lasting.end_ns is None or lasting.end_ns > time_ns
            ]
            self._publish()

    def forget(self, robot: int) -> None:
        """The process of a robot is another one, or gone: what had stopped or slowed it is over."""
        self._lasting = [
            kept
            for one in self._lasting
            for kept in (_healed((one,), (robot,), one.fault.kind) if _of_process(one) else (one,))
        ]
        self._publish()

    def _publish(self) -> None:
        """held, stopped, blind: robots. resting: those held or stopped whose rest ends by itself.

        delays: of slow robots [ticks].
        """
        force = [one.fault for one in self._lasting]
        self.held, self.stopped, self.blind = (_whom(force, kind) for kind in ("hold", "stop", "blind"))
        endless = [one.fault for one in self._lasting if one.end_ns is None]
        self.resting = (self.held | self.stopped) - _whom(endless, "hold") - _whom(endless, "stop")
        self.delays: dict[int, int] = {}
        for fault in force:
            if fault.kind == "slow":
                for robot in fault.robots:
                    self.delays[robot] = max(self.delays.get(robot, 0), fault.delay_ticks)
        self.slow = tuple(Slow(*delay) for delay in sorted(self.delays.items()))
        self.cuts = tuple(self._cut(fault) for fault in force if fault.kind == "cut")
        self.jams = tuple(_jam(fault) for fault in force if fault.kind == "jam")
        self.corruptions = tuple(
            Corruption(fault.robots or self._robots, fault.probability)
            for fault in force
            if fault.kind == "corrupt"
        )

    def _cut(self, fault: FaultSection) -> Cut:
        rest = fault.others or tuple(i for i in self._robots if i not in fault.robots)
        if fault.direction == "to":
            return Cut(side_a=rest, side_b=fault.robots, one_way=True)
        return Cut(side_a=fault.robots, side_b=rest, one_way=fault.direction == "from")


def _actor(fault: FaultSection, event: MissionEvent) -> tuple[int, ...]:
    """Whom a fault concerns that names nobody and follows an event."""
    return () if fault.kind in ("jam", "heal", "corrupt") else (event.robot,)


def _jam(fault: FaultSection) -> Jam:
    return Jam(x=fault.x, y=fault.y, radius=fault.radius, noise_dbm=fault.noise_dbm)


def _whom(faults: Sequence[FaultSection], kind: str) -> frozenset[int]:
    return frozenset(robot for fault in faults if fault.kind == kind for robot in fault.robots)


def _of_process(lasting: _Lasting) -> bool:
    return lasting.fault.kind in ("stop", "slow")


def _healed(
    lasting: Iterable[_Lasting], robots: tuple[int, ...], kind: str | None
) -> Iterable[_Lasting]:
    """What stays in force when robots (empty: everybody) are healed of a kind, or of all (None).

    What a robot suffers by itself ends for these robots alone, a cut or a corruption of theirs as a
    whole, and a jam only when everything is healed.
    """
    for one in lasting:
        fault = one.fault
        if kind not in (None, fault.kind):
            yield one
        elif robots and fault.kind in OF_ONE_ROBOT:
            left = tuple(robot for robot in fault.robots if robot not in robots)
            if left:
                yield replace(one, fault=replace(fault, robots=left))
        elif robots and not {*fault.robots, *fault.others} & set(robots):
            yield one


def _ns(seconds: float) -> int:
    return round(seconds * 1e9)
