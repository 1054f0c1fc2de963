"""Names of the bus keys and of the log channels. They stand here and nowhere else.

Bus keys lie under one mission prefix, so that missions on one machine never hear each other.
"""

ROBOT_NAME = "robot-{}"
WORLD, RADIO, RECORDER, OPERATOR = "world", "radio", "recorder", "operator"


def robot_name(robot: int) -> str:
    """Name of a robot's process, liveliness token and identity: robot-3."""
    return ROBOT_NAME.format(robot)


def percept(robot: int | str) -> str:
    """World to robot: its observation and its inbox of tick k."""
    return f"percept/{robot}"


def obs(robot: int | str) -> str:
    """Log channel of a robot's observation of tick k; on the bus it travels in its percept."""
    return f"obs/{robot}"


def rx(robot: int | str) -> str:
    """Log channel of a robot's inbox of tick k; on the bus it travels in air and in its percept."""
    return f"rx/{robot}"


def out(robot: int | str) -> str:
    """Robot to world: its action of tick k."""
    return f"out/{robot}"


def fate(robot: int | str) -> str:
    """World to robot: a scripted kill, which the robot's process carries out on itself."""
    return f"fate/{robot}"


TRUTH = "truth"
"""World to radio: ground truth of tick k, and what was offered to the air."""

AIR = "air"
"""Radio to world: the inboxes of tick k of every present robot, and the record of the tick."""

ETHER = "ether"
"""Log channel of the radio's verdicts; on the bus they travel in air."""

END = "end"
"""World to all: the mission is over, and how."""

PROGRESS = "progress"
"""World to operator: a few numbers for people, some times a second."""

CONTROL = "control"
"""Operator to world: end the mission now."""

RESTART = "restart"
"""World to operator: start the process of this robot again."""

RESULT = "result"
"""Recorder to operator: summary of the finished log."""


def alive(name: str) -> str:
    """Liveliness token of a process."""
    return f"alive/{name}"


def config(name: str) -> str:
    """Query a process asks the world at its start: its briefing."""
    return f"config/{name}"


RECORD = "record"
"""World to recorder: all wire messages of one tick."""

RECORDED = "recorded"
"""Recorder to world: the last tick that is in the file."""


def wire(key: str) -> str:
    """Log channel of a bus key."""
    return f"/wire/{key}"
