"""Faults of processes, carried out on the processes of robots: kill, restart, stop, continue.

The world holds its tick meanwhile, so a run with such faults is as reproducible as one without. A
robot's process kills itself; to stop it, to let it go on, to kill it while it is stopped and to start it
again is the operator's part, and where there is none (containers) a stopped robot is only not asked.
"""

from collections.abc import Callable, Set
from contextlib import AbstractContextManager
from functools import partial

from onehop.contracts import topics
from onehop.contracts.messages import Truth
from onehop.node.bus import Bus
from world_server.mailbox import Mailbox
from world_server.roll_call import RollCall

RESTART_S = 20.0
"""How long the end of a process may take, and the start of the next one [s]."""

ASK_S = 0.2
"""How often a process that has been stopped is asked whether it is awake [s]: while it was stopped its
session may have been given up, and until it has come back what it is asked is lost."""


class ProcessFaults:
    """What faults do to processes.

    robots: ids of the team. open_briefings: lets processes ask for their briefings meanwhile. silence_s:
    how long a process that goes on may take to answer [s].
    """

    def __init__(
        self,
        bus: Bus,
        mail: Mailbox,
        roll: RollCall,
        robots: tuple[int, ...],
        open_briefings: Callable[[], AbstractContextManager[None]],
        silence_s: float,
    ) -> None:
        self._open_briefings = open_briefings
        self._bus = bus
        self._mail = mail
        self._roll = roll
        self._silence_s = silence_s
        self._kill = {i: bus.publisher(topics.to(topics.robot_name(i), topics.KILL)) for i in robots}
        self._ask = {
            (what, i): bus.publisher(topics.to(topics.robot_name(i), what))
            for what in (topics.STOP, topics.WAKE)
            for i in robots
        }
        self._order = {
            what: bus.publisher(topics.to(topics.OPERATOR, what))
            for what in (topics.RESTART, topics.STOP, topics.CONTINUE, topics.KILL)
        }
        self._stopped: set[int] = set()
        self._awake: set[int] = set()
        for i in robots:
            mail.read(topics.robot_name(i), topics.AWAKE, partial(self._on_awake, i))

    def carry_out(self, truth: Truth, arrived: Set[int]) -> None:
        """Do to the processes what begins and ends with this truth. Raises MissionBrokenError.

        arrived: robots whose processes have been started again by somebody else.
        """
        if not (truth.faults or truth.departures or truth.stopped or self._stopped):
            return
        incarnations = {presence.robot: presence.incarnation for presence in truth.present}
        for departure in truth.departures:
            if departure.robot not in incarnations:
                self._end(departure.robot)
        for fault in truth.faults:
            if fault.kind == "restart":
                for robot in fault.robots:
                    restart = self._let_take_part if robot in arrived else self._restart
                    restart(robot, incarnations[robot])
        self._stop_and_wake(truth.stopped)

    def _stop_and_wake(self, stopped: tuple[int, ...]) -> None:
        for robot in stopped:
            if robot not in self._stopped:
                self._stopped.add(robot)
                self._await_answer(topics.STOP, robot)
                self._tell(topics.STOP, robot)
        for robot in sorted(self._stopped.difference(stopped)):
            self._stopped.discard(robot)
            self._tell(topics.CONTINUE, robot)
            self._await_answer(topics.WAKE, robot)

    def _end(self, robot: int) -> None:
        """End a process, and one that is stopped too."""
        self._kill[robot](b"")
        if robot in self._stopped:
            self._stopped.discard(robot)
            self._tell(topics.KILL, robot)

    def _restart(self, robot: int, incarnation: int) -> None:
        name = topics.robot_name(robot)
        self._roll.expect_again(name, incarnation)
        self._end(robot)
        if not self._mail.wait(lambda: name not in self._roll.present, RESTART_S):
            self._tell(topics.KILL, robot)  # a process of somebody else's making need not obey
            self._mail.wait(lambda: name not in self._roll.present, RESTART_S)
        self._bus.let_in(name)
        self._tell(topics.RESTART, robot)
        with self._open_briefings():
            self._roll.gather([name], RESTART_S)

    def _let_take_part(self, robot: int, incarnation: int) -> None:
        """Brief a process that is there; if it is gone by now it will be missed."""
        name = topics.robot_name(robot)
        self._roll.expect_again(name, incarnation)
        with self._open_briefings():
            self._mail.wait(lambda: name in self._roll.present, RESTART_S)

    def _await_answer(self, what: str, robot: int) -> None:
        """Say something to a robot until it answers; if its process is dead it will be missed."""
        name = topics.robot_name(robot)
        self._awake.discard(robot)
        for _ in range(round(self._silence_s / ASK_S)):
            self._ask[what, robot](b"")
            if self._mail.wait(lambda: self._hears(robot, name) or self._roll.has_died(name), ASK_S):
                return

    def _hears(self, robot: int, name: str) -> bool:
        """Whether a process is awake, and its session is there (again)."""
        return robot in self._awake and name in self._roll.present

    def _tell(self, what: str, robot: int) -> None:
        self._order[what](str(robot).encode())

    def _on_awake(self, robot: int, _: bytes) -> None:
        self._awake.add(robot)
