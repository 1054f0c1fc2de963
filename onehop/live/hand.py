"""The hand that people lay on a mission that runs: faults as by `onehop fault`, and its pace."""

import contextlib
import threading
from collections.abc import Iterator, Sequence

from onehop.contracts.errors import MissionError
from onehop.contracts.fault_section import FaultSection, fault_in_words
from onehop.contracts.operation import Pace
from onehop.mission.injection import inject
from onehop.mission.launcher import Running


class Hand:
    """words: the command that has started the mission, by which it is started again.

    pace: the one in force; a mission goes as fast as it can until it is told otherwise.
    is_paced: whether it heeds a pace, as one in lock-step does.
    """

    def __init__(self, words: Sequence[str], is_paced: bool = True) -> None:
        self.words = tuple(words)
        self.is_paced = is_paced
        self.pace = Pace(0.0, False, 0)
        self._running: Running | None = None
        self._one_at_a_time = threading.Lock()

    @contextlib.contextmanager
    def attend(self, running: Running) -> Iterator[None]:
        """Have the mission in hand meanwhile."""
        self._running = running
        try:
            yield
        finally:
            self._running = None

    @property
    def holds(self) -> bool:
        """Whether there is a mission that can be laid hands on."""
        return self._running is not None

    def order(self, fault: FaultSection) -> tuple[bool, str]:
        """Whether a fault took effect, and when, or why not. It waits for the tick."""
        running = self._running
        if running is None:
            return False, "no mission runs any more"
        try:
            with self._one_at_a_time:
                answer = inject(running.way_in, fault)
        except MissionError as error:
            return False, str(error)
        if answer.refusal:
            return False, answer.refusal
        return True, f"{fault_in_words(answer.fault)}: took effect at {answer.fault.at_s or 0.0:g} s"

    def set_pace(self, pace: Pace) -> None:
        running = self._running
        if running is not None and self.is_paced:
            self.pace = pace
            running.set_pace(pace)
