"""The launcher on the bus of a running mission: it shows, restarts, tells of deaths, and stops."""

import math
import signal
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

from onehop.contracts import topics
from onehop.contracts.errors import MissionError
from onehop.contracts.messages import Outcome
from onehop.contracts.operation import Death, End, Progress, Punctuality
from onehop.mission.processes import ProcessGroup
from onehop.mission.stops import StopRequest
from onehop.node.bus import ALIVE, Bus
from onehop.wire.codec import decode, encode

POLL_S = 0.1
"""How often the children are looked at [s]: their end sends no message."""

GONE_S = 1.0
"""How long the world may be gone from the bus, while its process runs, until it is given up [s]."""

ROUTER_GONE_S = 12.0
"""The same where the router is a process of its own [s]: in real time it may come back for 10 s."""

DIGEST_S = 30.0
"""How long the recorder may take for the end of the log [s]."""

STOP_S = 10.0
"""How long the world may take to end the mission when it is told to [s]."""

SIGNALS = {
    topics.STOP: signal.SIGSTOP,
    topics.CONTINUE: signal.SIGCONT,
    topics.KILL: signal.SIGKILL,
}
"""What the world may order for the process of a robot."""

STOPPED = "stopped by the operator"
"""Reason of a mission whose launcher was asked to end."""

LOST_WORD = "the world process ended, and its last word was lost"
"""Reason of a mission of whose end nothing is known."""

CANNOT_RUN = 2
"""Exit status of a process whose last words say what a person has to mend."""


class Ending(NamedTuple):
    """How a mission ended. wall_s: time of its ticks. digest: None if the recorder did not finish.

    punctuality: in real time.
    """

    outcome: Outcome
    wall_s: float
    digest: str | None
    punctuality: Punctuality | None = None


def aborted(reason: str, ticks: int) -> Ending:
    """The end of a mission whose world cannot say any more how it ended."""
    return Ending(Outcome("aborted", reason, (), (), (), ticks, 0.0, 0), 0.0, None)


def ending_by_death(group: ProcessGroup, name: str, ticks: int) -> Ending:
    """The end of a mission by the death of one process, as its account says.

    Raises MissionError when the world has found something that a person has to mend.
    """
    if name == topics.WORLD and group.exit_status(name) == CANNOT_RUN:
        raise MissionError(group.last_words(name))
    return aborted(group.account(name), ticks)


class OperatorSession:
    """One mission from the moment at which its bus is there.

    stop: whether people want it to end. show: takes progress, some times a second. tell: takes lines for
    people. remote: names of processes on other hosts, of which people are told. external: whether the
    router is a process of its own.
    """

    def __init__(
        self,
        group: ProcessGroup,
        bus: Bus,
        stop: StopRequest,
        show: Callable[[Progress], None],
        tell: Callable[[str], None],
        remote: Sequence[str] = (),
        external: bool = False,
    ) -> None:
        self._external = external
        self._group = group
        self._bus = bus
        self._stop = stop
        self._show = show
        self._tell = tell
        self._tick = 0
        self._end: End | None = None
        self._end_s = math.inf
        self._digest: str | None = None
        self._unreported: list[Death] = []
        self._world_listens = False
        self._gone_s = math.inf
        self._stop_told = False
        self._control = bus.publisher(topics.by(topics.OPERATOR, topics.CONTROL))
        self._pace = bus.publisher(topics.by(topics.OPERATOR, topics.PACE))
        self._report = bus.publisher(topics.by(topics.OPERATOR, topics.DIED))
        self._remote = {topics.alive(name): name for name in remote}
        self._missing = list(remote)
        bus.watch("*" if remote else topics.WORLD)

    def until_end(self) -> Ending:
        """Watch over the mission to its end. Raises MissionError when it could not be run."""
        self._watch()
        return self._ending()

    def _watch(self) -> None:
        """Until outcome and digest are there, or nothing more can come."""
        while self._end is None or self._digest is None:
            received = self._bus.receive_by(time.monotonic() + POLL_S)
            self._look_at_children()
            self._pass_on_stop()
            if received is not None:
                self._take(*received)
            elif self._is_all_over(time.monotonic()):
                return

    def _look_at_children(self) -> None:
        """Tell people and the world of children that have died."""
        for death in self._group.deaths():
            self._tell(death.account)
            self._unreported.append(death)
        if self._world_listens:
            for death in self._unreported:
                self._report(encode(death))
            self._unreported.clear()

    def _pass_on_stop(self) -> None:
        """Tell the world, once, that the mission is to end."""
        if self._stop.number is not None and self._world_listens and not self._stop_told:
            self._stop_told = True
            self._control(b"stop")

    def _take(self, what: str, data: bytes) -> None:
        if what == topics.PROGRESS:
            progress = decode(Progress, data)
            self._tick = progress.tick
            self._show(progress)
        elif what == topics.TOLD:
            self._tell(data.decode())
        elif what == topics.PACE:
            self._pace(data)
        elif what == topics.RESTART:
            self._restart(int(data))
        elif what in SIGNALS:
            self._group.send(topics.robot_name(int(data)), SIGNALS[what])
        elif what == topics.END and data:
            self._end, self._end_s = decode(End, data), time.monotonic()
        elif what == topics.DIGEST:
            self._digest = data.decode()
        elif what == topics.alive(topics.WORLD):
            self._world_listens = data == ALIVE
            self._gone_s = math.inf if self._world_listens else time.monotonic()
        elif what in self._remote:
            self._tell_of_remote(self._remote[what], data == ALIVE)

    def _restart(self, robot: int) -> None:
        name = topics.robot_name(robot)
        if self._group.is_here(name):
            self._group.start_robot(robot)
        else:
            self._tell(f"{name} is to be started again, on its host")

    def _tell_of_remote(self, name: str, is_there: bool) -> None:
        """Say that a process on another host has come or gone, and who is still missing."""
        if is_there and name in self._missing:
            self._missing.remove(name)
            rest = f"; waiting for {', '.join(self._missing)}" if self._missing else ""
            self._tell(f"{name} is there{rest}")
        elif self._end is None and not is_there:
            self._missing.append(name)
            self._tell(f"{name} is gone from the bus")

    def _is_all_over(self, now: float) -> bool:
        """Whether nothing more can come, now that nothing has."""
        if self._group.exit_status(topics.WORLD) is not None or self._given_up(now) is not None:
            return True
        recorder_ended = self._group.exit_status(topics.RECORDER) is not None
        return self._end is not None and (recorder_ended or now - self._end_s > DIGEST_S)

    def _given_up(self, now: float) -> str | None:
        """Why a world that has said nothing of an end is not waited for any more."""
        gone_for_s = now - self._gone_s
        if self._external:
            has_ended = self._group.exit_status(topics.WORLD) is not None
            if gone_for_s > (0.0 if has_ended else ROUTER_GONE_S):
                return "the router, or the world process, is gone from the bus: stopped, or cut off"
        elif gone_for_s > GONE_S:
            return "the world process is gone from the bus: stopped, or cut off"
        if self._stop.number is not None and now - self._stop.at_s > STOP_S:
            return f"{STOPPED}, and the world did not end the mission"
        return None

    def _ending(self) -> Ending:
        if self._end is not None:
            end = self._end
            return Ending(end.outcome, end.wall_s, self._digest, end.punctuality)
        if self._group.exit_status(topics.WORLD):
            return ending_by_death(self._group, topics.WORLD, self._tick)
        return aborted(self._given_up(time.monotonic()) or LOST_WORD, self._tick)
