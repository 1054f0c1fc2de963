"""What a robot does in a tick of real time for which it has said nothing: it goes on for a moment.

Bases have such a command timeout (ROS 2 diff_drive_controller: `cmd_vel_timeout`, 0.5 s). It goes on
with its last twist, with nothing to send and nothing to note, and then it rests. The rule depends on
what was said and on the truth alone, so a log shows the rest.
"""

from collections.abc import Mapping

from msgspec.structs import replace

from onehop.contracts.messages import Action, Truth, running
from onehop.contracts.scenario import Scenario


class CommandHold:
    """The last word of each robot, for as long as it holds."""

    def __init__(self, scenario: Scenario) -> None:
        clock = scenario.clock
        self._is_realtime = clock.is_realtime
        self._ticks = round(clock.hold_s * 1e9 / clock.period_ns)
        self._last: dict[int, tuple[int, Action]] = {}

    def filled(self, truth: Truth, actions: Mapping[int, Action]) -> Mapping[int, Action]:
        """The actions of this tick, and those that go on. In lock-step there are no others."""
        if not self._is_realtime:
            return actions
        filled = {}
        for one in running(truth):
            i, tick = one.robot, truth.tick
            if i in actions:
                self._last[i] = tick, actions[i]
                filled[i] = actions[i]
            elif i in self._last:
                said_at, last = self._last[i]
                if last.incarnation == one.incarnation and tick - said_at <= self._ticks:
                    filled[i] = replace(last, tick=tick, outbox=(), notes=(), values={})
        return filled
