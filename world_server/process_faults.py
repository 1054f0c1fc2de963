"""Scripted kills and restarts, carried out on the processes of robots.

The world holds its tick meanwhile, so a run with kills and restarts is as reproducible as one without.
"""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager

from onehop.contracts import topics
from onehop.contracts.messages import Truth
from onehop.contracts.sections import FaultSection
from onehop.node.bus import Bus
from world_server.mailbox import Mailbox
from world_server.roll_call import RollCall

RESTART_S = 20.0
"""How long the end of a process may take, and the start of the next one [s]."""


class ProcessFaults:
    """What the script does to processes.

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
        self._open_briefings = open_briefings
        self._bus = bus
        self._mail = mail
        self._roll = roll
        self._kill = {i: bus.publisher(topics.to(topics.robot_name(i), topics.KILL)) for i in robots}
        self._put_restart = bus.publisher(topics.to(topics.OPERATOR, topics.RESTART))

    def carry_out(self, truth: Truth, due: Sequence[FaultSection]) -> None:
        """End the processes of those who departed, and start those anew that a fault restarts.

        due: faults that this truth shows for the first time. Raises MissionBrokenError.
        """
        incarnations = {presence.robot: presence.incarnation for presence in truth.present}
        for departure in truth.departures:
            if departure.robot not in incarnations:
                self._kill[departure.robot](b"")
        for fault in due:
            if fault.kind == "restart":
                for robot in sorted(fault.robots):
                    self._restart(robot, incarnations[robot])

    def _restart(self, robot: int, incarnation: int) -> None:
        name = topics.robot_name(robot)
        self._roll.expect_again(name, incarnation)
        self._kill[robot](b"")
        self._mail.wait(lambda: name not in self._roll.present, RESTART_S)
        self._bus.let_in(name)
        self._put_restart(str(robot).encode())
        with self._open_briefings():
            self._roll.gather([name], RESTART_S)
