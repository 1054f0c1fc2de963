"""Errors by whose fault they are.

Loss, timeout and "no path" are values, not exceptions (style rule 3). What is left: something that a
person typed, something that a peer sent, or a bug of ours. Bugs raise plain exceptions and crash.
"""


class OnehopError(Exception):
    """Base of every error that a person is told about in one line."""


class InputError(OnehopError):
    """A file, key or value that a person gave cannot be used.

    where: the file and key, e.g. "scenarios/map1.toml: gains.k_beta".
    problem: what is wrong with it.
    remedy: what would be right.
    """

    def __init__(self, where: str, problem: str, remedy: str) -> None:
        super().__init__(f"{where}: {problem}; {remedy}")
        self.where = where
        self.problem = problem
        self.remedy = remedy


class ScenarioError(InputError):
    """A scenario file has a wrong key, type, unit or value."""


class MapError(InputError):
    """A map file cannot be read as the format that it claims."""


class LogError(InputError):
    """A log cannot be read, or is of a version that this program does not know."""


class DecodeError(OnehopError):
    """A peer sent bytes that are not the message they should be: count, drop, go on."""


class MissionError(OnehopError):
    """The mission could not be run to an outcome on this machine."""
