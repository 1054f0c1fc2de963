"""Scripted faults: which are due, and which are in force.

Kill and restart are instants, and the world carries them out on its robots. Hold, cut and jam last for
their duration, or to the next heal, or to the end. Everything changes at tick boundaries only.
"""

from dataclasses import dataclass

from onehop.contracts.messages import Cut, Jam
from onehop.contracts.sections import FaultSection


@dataclass(frozen=True, slots=True)
class _Lasting:
    fault: FaultSection
    end_ns: int | None


class Faults:
    """The faults of one mission. robots: everyone in the team."""

    def __init__(self, script: tuple[FaultSection, ...], robots: tuple[int, ...]) -> None:
        self._waiting = sorted(script, key=lambda fault: fault.at_s)
        self._robots = robots
        self._lasting: list[_Lasting] = []
        self._publish()

    def due(self, time_ns: int) -> tuple[FaultSection, ...]:
        """Faults of the script whose time has come, each returned once, now in force."""
        due: list[FaultSection] = []
        while self._waiting and _ns(self._waiting[0].at_s) <= time_ns:
            fault = self._waiting.pop(0)
            due.append(fault)
            self._begin(fault, _ns(fault.at_s))
        return tuple(due)

    @property
    def will_restart(self) -> bool:
        """Whether the script has yet to restart somebody."""
        return any(fault.kind == "restart" for fault in self._waiting)

    def _begin(self, fault: FaultSection, time_ns: int) -> None:
        """Put one fault into force as of time_ns; a heal ends what it names, or everything."""
        if fault.kind == "heal":
            self._lasting = [lasting for lasting in self._lasting if not _heals(fault, lasting.fault)]
        elif fault.kind in ("hold", "cut", "jam"):
            end_ns = time_ns + _ns(fault.duration_s) if fault.duration_s else None
            self._lasting.append(_Lasting(fault, end_ns))
        self._publish()

    def expire(self, time_ns: int) -> None:
        """End what has lasted its time."""
        if any(lasting.end_ns is not None and lasting.end_ns <= time_ns for lasting in self._lasting):
            self._lasting = [
                lasting
                for lasting in self._lasting
                if lasting.end_ns is None or lasting.end_ns > time_ns
            ]
            self._publish()

    def _publish(self) -> None:
        """held: robots that stand still; released: those of them whose hold ends by itself."""
        force = self._lasting
        held: dict[int, bool] = {}
        for lasting in force:
            if lasting.fault.kind == "hold":
                for robot in lasting.fault.robots:
                    held[robot] = held.get(robot, True) and lasting.end_ns is not None
        self.held = frozenset(held)
        self.released = frozenset(robot for robot, ends in held.items() if ends)
        self.cuts = tuple(self._cut(one.fault) for one in force if one.fault.kind == "cut")
        self.jams = tuple(_jam(one.fault) for one in force if one.fault.kind == "jam")

    def _cut(self, fault: FaultSection) -> Cut:
        side = tuple(sorted(set(fault.robots)))
        rest = fault.others or tuple(i for i in self._robots if i not in side)
        return Cut(side_a=side, side_b=tuple(sorted(set(rest))))


def _jam(fault: FaultSection) -> Jam:
    return Jam(x=fault.x, y=fault.y, radius=fault.radius, noise_dbm=fault.noise_dbm)


def _heals(heal: FaultSection, fault: FaultSection) -> bool:
    """A heal without robots ends everything; one with robots ends their holds and cuts."""
    if not heal.robots:
        return True
    return bool({*fault.robots, *fault.others} & set(heal.robots))


def _ns(seconds: float) -> int:
    return round(seconds * 1e9)
