"""The two ways in which a mission passes its time, each put together from its parts."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass

from onehop.contracts.scenario import Scenario
from onehop.node import startup
from onehop.node.bus import Bus
from world_server.core.command_hold import CommandHold
from world_server.core.world import World
from world_server.fault_orders import FaultOrders
from world_server.lockstep import LockStep
from world_server.mailbox import Mailbox
from world_server.pace import PaceKeeper
from world_server.process_faults import ProcessFaults
from world_server.progress import ProgressReports
from world_server.realtime.bases import RealTimeBases
from world_server.realtime.faults import RealTimeFaults
from world_server.realtime.mission import RealTime
from world_server.realtime.radio import RealTimeRadio
from world_server.realtime.recording import RealTimeRecording
from world_server.realtime.robots import RealTimeRobots
from world_server.realtime.schedule import Schedule
from world_server.recording import Recording
from world_server.remote_radio import RemoteRadio
from world_server.remote_robots import RemoteRobots
from world_server.roll_call import RollCall


@dataclass(frozen=True, slots=True)
class Parts:
    """What either is made of. open_briefings: lets processes ask for their briefings meanwhile."""

    bus: Bus
    mail: Mailbox
    roll: RollCall
    world: World
    scenario: Scenario
    open_briefings: Callable[[], AbstractContextManager[None]]


def lock_step(parts: Parts) -> LockStep:
    """Everyone waits for its inputs of a tick, and for nothing else."""
    bus, mail, roll = parts.bus, parts.mail, parts.roll
    robots, silence_s = parts.scenario.team.robots, parts.scenario.clock.silence_s
    recording = Recording(bus, mail, silence_s)
    orders = FaultOrders(bus, mail, robots)
    return LockStep(
        parts.world,
        RemoteRadio(bus, mail, silence_s),
        RemoteRobots(bus, mail, roll, robots, silence_s),
        ProcessFaults(bus, mail, roll, robots, parts.open_briefings, silence_s),
        orders,
        recording,
        ProgressReports(bus),
        PaceKeeper(mail, recording, orders),
    )


def real_time(parts: Parts) -> RealTime:
    """Nobody waits for anybody."""
    startup.be_on_time()
    bus, mail, roll, clock = parts.bus, parts.mail, parts.roll, parts.scenario.clock
    ids = parts.scenario.team.robots
    schedule = Schedule(clock.period_ns / 1e9 / clock.speed, clock.speed)

    def lied(robot: int) -> None:
        robots.refuse(robot, "named receptions that it was not given")

    recording = RealTimeRecording(bus, mail, roll, clock.period_ns, lied)
    radio = RealTimeRadio(bus, mail, roll, schedule, recording.take, clock.silence_s)
    robots = RealTimeRobots(bus, mail, roll, ids, clock.silence_s, radio.hand_over)
    return RealTime(
        parts.world,
        mail,
        roll,
        schedule,
        CommandHold(parts.scenario),
        radio,
        robots,
        RealTimeBases(
            *(bus, mail, roll, parts.world.bases),
            *(clock.silence_s, clock.hold_s, parts.open_briefings),
        ),
        RealTimeFaults(bus, mail, roll, ids, parts.open_briefings),
        FaultOrders(bus, mail, ids),
        recording,
        ProgressReports(bus),
    )
