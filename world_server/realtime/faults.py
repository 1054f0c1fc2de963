"""Faults of processes while the mission goes on: what they do takes the time that it takes.

A robot whose process is started again takes part from the tick of the fault on, as one that says
nothing until its process is there. A robot that is stopped is told so before, and nobody waits until it
has heard.
"""

import contextlib
import time
from collections.abc import Callable, Set
from contextlib import AbstractContextManager

from onehop.contracts import topics
from onehop.contracts.messages import Truth
from onehop.node.bus import Bus
from world_server.mailbox import Mailbox
from world_server.process_faults import RESTART_S
from world_server.roll_call import RollCall


class RealTimeFaults:
    """What faults do to processes.

    robots: ids of the team. open_briefings: lets processes ask for their briefings meanwhile.
    """

    def __init__(
        self,
        bus: Bus,
        mail: Mailbox,
        roll: RollCall,
        robots: tuple[int, ...],
        open_briefings: Callable[[], AbstractContextManager[None]],
    ) -> None:
        self._bus = bus
        self._roll = roll
        self._open_briefings = open_briefings
        self._briefings = contextlib.ExitStack()
        self._say = {
            (what, i): bus.publisher(topics.to(topics.robot_name(i), what))
            for what in (topics.KILL, topics.STOP, topics.WAKE)
            for i in robots
        }
        self._order = {
            what: bus.publisher(topics.to(topics.OPERATOR, what))
            for what in (topics.RESTART, topics.STOP, topics.CONTINUE, topics.KILL)
        }
        self._stopped: set[int] = set()
        self._ending: dict[int, float] = {}
        self._starting: dict[int, float] = {}
        for i in robots:
            mail.read(topics.robot_name(i), topics.AWAKE, lambda _: None)

    @property
    def starting(self) -> Set[int]:
        """Robots that take part, and whose process is yet to come."""
        return self._ending.keys() | self._starting.keys()

    def carry_out(self, truth: Truth, arrived: Set[int]) -> None:
        """Begin to do to the processes what begins and ends with this truth.

        arrived: robots whose processes have been started again by somebody else.
        """
        incarnations = {presence.robot: presence.incarnation for presence in truth.present}
        for departure in truth.departures:
            if departure.robot not in incarnations:
                self._end(departure.robot)
                self._ending.pop(departure.robot, None)
                self._starting.pop(departure.robot, None)
        for fault in truth.faults:
            if fault.kind == "restart":
                for robot in fault.robots:
                    self._restart(robot, incarnations[robot], is_there=robot in arrived)
        for robot in truth.stopped:
            if robot not in self._stopped:
                self._stopped.add(robot)
                self._say[topics.STOP, robot](b"")
                self._tell(topics.STOP, robot)
        for robot in sorted(self._stopped.difference(truth.stopped)):
            self._stopped.discard(robot)
            self._tell(topics.CONTINUE, robot)

    def go_on(self) -> dict[int, str]:
        """What has come of it meanwhile; robots whose process did not come again, and why they leave."""
        now_s = time.monotonic()
        for robot, deadline_s in list(self._ending.items()):
            name = topics.robot_name(robot)
            if name not in self._roll.present:
                del self._ending[robot]
                self._bus.let_in(name)
                self._await(robot)
                self._tell(topics.RESTART, robot)
            elif now_s > deadline_s:
                self._ending[robot] = now_s + RESTART_S
                self._tell(topics.KILL, robot)  # a process of somebody else's making need not obey
        failed: dict[int, str] = {}
        for robot, deadline_s in list(self._starting.items()):
            name = topics.robot_name(robot)
            if name in self._roll.present or now_s > deadline_s or self._roll.has_died(name):
                del self._starting[robot]
                if name not in self._roll.present:
                    failed[robot] = "its process died"
        if not self._starting:
            self._briefings.close()
        return failed

    def _restart(self, robot: int, incarnation: int, is_there: bool) -> None:
        self._roll.expect_again(topics.robot_name(robot), incarnation)
        if is_there:
            self._await(robot)
            return
        self._end(robot)
        self._starting.pop(robot, None)
        self._ending[robot] = time.monotonic() + RESTART_S

    def _await(self, robot: int) -> None:
        if not self._starting:
            self._briefings.enter_context(self._open_briefings())
        self._starting[robot] = time.monotonic() + RESTART_S

    def _end(self, robot: int) -> None:
        """End a process, and one that is stopped too."""
        self._say[topics.KILL, robot](b"")
        if robot in self._stopped:
            self._stopped.discard(robot)
            self._tell(topics.KILL, robot)

    def _tell(self, what: str, robot: int) -> None:
        self._order[what](str(robot).encode())
