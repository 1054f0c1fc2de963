"""Names of the bus keys and of the log channels. They stand here and nowhere else.

Every process has a name. It hears what lies under `to/<name>`, all of it through one subscription, and
speaks under `from/<name>`; the world hears all that is said there. Bus keys lie under one mission
prefix, so that missions on one machine never hear each other.
"""

from collections.abc import Iterable
from functools import lru_cache

WORLD, RADIO, RECORDER, OPERATOR = "world", "radio", "recorder", "operator"

INJECTOR = "injector"
"""Who orders faults by hand (`onehop fault`): it may say nothing else."""

_remembered = lru_cache(maxsize=4096)
"""For names that are asked for at every tick."""


@_remembered
def robot_name(robot: int | str) -> str:
    """Name of a robot's process, liveliness token and identity: robot-3."""
    return f"robot-{robot}"


@_remembered
def base_name(robot: int | str) -> str:
    """The same of the process that drives a robot's real base: base-3."""
    return f"base-{robot}"


def clients(robots: Iterable[int], bases: Iterable[int] = ()) -> tuple[str, ...]:
    """Everyone on the bus of a mission but the world. bases: robots that have a real one."""
    own = *map(robot_name, robots), *map(base_name, bases)
    return (RADIO, RECORDER, OPERATOR, INJECTOR, *own)


def to(name: str, what: str) -> str:
    """Key of a message to a process."""
    return f"to/{name}/{what}"


def by(name: str, what: str) -> str:
    """Key of a message from a process to the world."""
    return f"from/{name}/{what}"


def heard(name: str) -> str:
    """The expression that a process hears."""
    return "from/**" if name == WORLD else f"to/{name}/**"


PERCEPT = "percept"
"""World to robot: its observation and its inbox of tick k."""

ARRIVAL = "arrival"
"""Robot to world: a process of this robot is there, and waits for its briefing."""

OUT = "out"
"""Robot to world: its action of tick k."""

PART = "part"
"""To or from a robot: the beginning of a message that is longer than its link carries."""

OBSERVATION = "observation"
"""World to robot, in real time: its observation of a tick."""

HEARD = "heard"
"""Radio to robot, in real time: a reception, when it is due."""

ACTED = "acted"
"""Robot to world, in real time: its action, and what it has heard for it."""

PLACED = "placed"
"""World to radio, in real time: ground truth of a tick."""

HANDED = "handed"
"""World to radio, in real time: what a robot hands to its NIC."""

MEASURED = "measured"
"""Base to world: its pose, twist and scan as they are now."""

DRIVE = "drive"
"""World to base: the twist by which it is to drive."""

KILL = "kill"
"""World to robot: a kill by a fault, which the robot's process carries out on itself; world to operator:
the same of a process that is stopped."""

STOP = "stop"
"""World to robot: you will be stopped; then world to operator: stop this robot's process (SIGSTOP)."""

CONTINUE = "continue"
"""World to operator: let the process of this robot go on (SIGCONT)."""

WAKE = "wake"
"""World to robot: say that you are awake."""

AWAKE = "awake"
"""Robot to world: the answer to either."""

CARRIED = "carried"
"""Radio to world: the inboxes of tick k of every present robot, and the record of the tick."""

TICKS = "ticks"
"""World to recorder: all wire messages of a few ticks."""

RECORDED = "recorded"
"""Recorder to world: the last tick that is in the file."""

FAILED = "failed"
"""Recorder to world: it cannot write any more, and why; robot to world: the same of its program."""

END = "end"
"""World to all: the mission is over, and how."""

PROGRESS = "progress"
"""World to operator: a few numbers for people, some times a second."""

CONTROL = "control"
"""Operator to world: end the mission now."""

PACE = "pace"
"""Operator to world: how fast it is to go from tick to tick, or that it is to wait."""

DIED = "died"
"""Operator to world: a process has died, and how."""

RESTART = "restart"
"""World to operator: start the process of this robot again."""

FAULT = "fault"
"""Injector to world: an order of a fault."""

ANSWER = "answer"
"""World to injector: at which tick it took effect, or why it is refused."""

TOLD = "told"
"""World to operator: a line for people."""

DIGEST = "digest"
"""Recorder to operator: the digest of the finished log."""

PULSE = "pulse"
"""What a process tells itself to look at the clock."""


def alive(name: str) -> str:
    """Liveliness token of a process, and what others tell themselves when it comes or goes."""
    return f"alive/{name}"


def config(name: str) -> str:
    """Query a process asks the world at its start: its briefing."""
    return f"config/{name}"


TRUTH = "truth"
"""World to radio, and log channel: ground truth of tick k, and what robots handed to their NICs."""

RADIO_RECORD = "radio"
"""Log channel of the radio's verdicts; on the bus they travel in `carried`."""


LATE = "late"
"""Log channel of ticks of real time that began late."""


@_remembered
def obs(robot: int | str) -> str:
    """Log channel of a robot's observation of tick k; on the bus it travels in its percept."""
    return f"obs/{robot}"


@_remembered
def rx(robot: int | str) -> str:
    """Log channel of a robot's inbox of tick k; on the bus it travels in `carried` and its percept."""
    return f"rx/{robot}"


@_remembered
def out(robot: int | str) -> str:
    """Log channel of a robot's action of tick k."""
    return f"out/{robot}"


@_remembered
def base(robot: int | str) -> str:
    """Log channel of the measurement of a real base that the world took in at tick k."""
    return f"base/{robot}"


def wire(key: str) -> str:
    """Name in the file of a log channel."""
    return f"/wire/{key}"
