"""The mission in lock-step: onehop/drivers/inline.py with processes in the places of radio and robots.

Everyone waits for its inputs of a tick and for nothing else, so the result cannot depend on timing. A
robot that gives no action is fenced: the truth of the next tick leaves it out.
"""

from dataclasses import dataclass

from onehop.contracts import topics
from onehop.contracts.messages import Outcome
from onehop.wire.codec import encode
from world_server.core.world import World
from world_server.fault_orders import FaultOrders
from world_server.pace import PaceKeeper
from world_server.process_faults import ProcessFaults
from world_server.progress import ProgressReports
from world_server.recording import Recording
from world_server.remote_radio import RemoteRadio
from world_server.remote_robots import RemoteRobots


@dataclass(frozen=True, slots=True)
class LockStep:
    """One mission and everyone who takes part in it."""

    world: World
    radio: RemoteRadio
    robots: RemoteRobots
    faults: ProcessFaults
    orders: FaultOrders
    recording: Recording
    progress: ProgressReports
    pace: PaceKeeper

    def run(self) -> Outcome:
        """Tick until the mission has an outcome. Raises MissionBrokenError."""
        outcome = None
        while outcome is None:
            outcome = self._tick()
        return outcome

    def broken_off(self, reason: str) -> Outcome:
        """The account of a mission that is broken off now."""
        return self.world.aborted(reason)

    @property
    def punctuality(self) -> None:
        """There is no schedule."""

    def _tick(self) -> Outcome | None:
        world = self.world
        truth = world.truth()
        self.faults.carry_out(truth, self.orders.arrived)
        encoded_truth = encode(truth)
        self.radio.send(encoded_truth)
        self.recording.hand_over_batch()
        observations = [(topics.obs(i), encode(seen)) for i, seen in world.observe().items()]
        carried = self.radio.carried(truth.tick)
        answers = self.robots.step(truth, dict(observations), dict(carried))
        self.recording.add(
            truth.tick, [(topics.TRUTH, encoded_truth), *carried, *observations, *answers.wire]
        )
        self.pace.hold()
        world.advance(answers.actions, self.orders.take(world))
        for robot, why in answers.fenced.items():
            world.fence(robot, why)
        self.orders.confirm(world)
        self.progress.report(truth, answers.actions)
        return world.outcome()
