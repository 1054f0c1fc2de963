"""What each process is told when it asks at its start: no robot learns the map, or others' poses."""

from collections import Counter
from collections.abc import Callable

from onehop.contracts import topics
from onehop.contracts.arrays import FloatArray
from onehop.contracts.briefings import LogBriefing, radio_briefing, robot_briefing
from onehop.contracts.hardware import BaseBriefing
from onehop.scenario.bundle import Bundle
from onehop.scenario.link_trace import link_trace
from onehop.wire.codec import encode

ANSWERS = 20
"""How often one process is answered. It asks again when an answer is late, every 2 s for 30 s."""


class Briefings:
    """Answers for one mission.

    walls: (n, 4) segments [m]. driver: what the log calls this way of running. incarnation: how often
    the process of a name has been started again.
    """

    def __init__(
        self, bundle: Bundle, walls: FloatArray, driver: str, incarnation: Callable[[str], int]
    ) -> None:
        self._scenario = bundle.scenario
        self._incarnation = incarnation
        self._answered: Counter[tuple[str, int]] = Counter()
        self._robots = {topics.config(topics.robot_name(i)): i for i in bundle.scenario.team.robots}
        files = tuple(sorted(bundle.files.items()))
        log = LogBriefing(driver, bundle.scenario_json(), files, bundle.folder)
        self._others = {
            topics.config(topics.RADIO): encode(
                radio_briefing(bundle.scenario, walls, link_trace(bundle))
            ),
            topics.config(topics.RECORDER): encode(log),
        }
        scenario, clock = bundle.scenario, bundle.scenario.clock
        for i in scenario.bases:
            base = BaseBriefing(i, clock.period_ns, clock.silence_s, scenario.body_of(i))
            self._others[topics.config(topics.base_name(i))] = encode(base)

    def answer(self, key: str) -> bytes | None:
        """The briefing that a process asks for under this key, None if there is none or it asks on."""
        robot = self._robots.get(key)
        incarnation = 0 if robot is None else self._incarnation(topics.robot_name(robot))
        self._answered[key, incarnation] += 1
        if self._answered[key, incarnation] > ANSWERS:
            return None
        if robot is None:
            return self._others.get(key)
        return encode(robot_briefing(self._scenario, robot, incarnation))
