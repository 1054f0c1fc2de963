"""What single robots of a mission have of their own: program, parameters, body and laser."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Literal

from onehop.contracts.problems import Problem
from onehop.contracts.program_section import RobotId, parameter_problems, program_problems
from onehop.contracts.sections import (
    Field,
    LaserBeams,
    LaserRange,
    Noise,
    Radius,
    RobotSection,
    Speed,
    TurnRate,
)


@dataclass(frozen=True, slots=True)
class OwnBody:
    """Of one robot's body and laser what is not as section [robot] says, key by key; None: as there."""

    radius: Radius | None = None
    leader_speed: Speed | None = None
    max_speed: Speed | None = None
    max_turn_rate: TurnRate | None = None
    laser_range: LaserRange | None = None
    laser_beams: LaserBeams | None = None
    laser_fov_deg: Field | None = None
    pose_noise: Noise | None = None
    heading_noise_deg: Noise | None = None
    laser_noise: Noise | None = None

    def of(self, team: RobotSection) -> RobotSection:
        """The whole body of this robot. team: section [robot]."""
        return replace(team, **{key: value for key, value in asdict(self).items() if value is not None})


@dataclass(frozen=True, slots=True)
class RobotEntry:
    """What one robot has of its own.

    program: empty for that of the team. parameters: with a program of its own all that it is given;
    without one in place of those of the team that have the same names. body: keys of [robot]. command:
    starts a process that speaks as this robot in place of ours, in any language (docs/wire.md): a
    program and its words. base: whether the world moves its body, or a real base does, which measures
    where it is (docs/hardware.md). base_command: starts the driver of that base here; without it
    somebody starts it where the base is.
    """

    id: RobotId
    program: str = ""
    parameters: dict[str, Any] = field(default_factory=dict)
    body: OwnBody = field(default_factory=OwnBody)
    command: tuple[str, ...] = ()
    base: Literal["simulated", "hardware"] = "simulated"
    base_command: tuple[str, ...] = ()

    @property
    def is_hardware(self) -> bool:
        return self.base == "hardware"

    def problems(self) -> Iterator[Problem]:
        for key, command in (("command", self.command), ("base_command", self.base_command)):
            if command and not (command[0] and all("\0" not in word for word in command)):
                yield Problem(key, "names no program", 'a program and its words, ["./my_robot", "-v"]')
        if self.base_command and not self.is_hardware:
            yield Problem("base_command", "a simulated base has no driver", 'base = "hardware" with it')
        if self.program:
            yield from program_problems(self.program)
        yield from parameter_problems(self.parameters)
