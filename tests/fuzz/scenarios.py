"""Scenarios: keys that exist with values that may not be, then damage to the text."""

from pathlib import Path
from random import Random

from onehop.scenario import scenario_file
from tests.fuzz.commands import call
from tests.fuzz.damage import NUMBERS, damaged
from tests.onehop.scenario.test_ranges import FAULT, KEYS

_FEW_TICKS = "clock.limit_s=0.15"
"""What a mission that was accepted may run."""

_MISSION = {
    "name": "'field'", "map.width": "40", "map.height": "40",
    "map.obstacles": "[[[18, 24], [24, 24], [24, 30], [18, 30]]]",
    "start.x": "8", "start.y": "8", "goal.x": "30", "goal.y": "14", "team.size": "4",
}  # fmt: skip

_WORDS = {
    "gains.policy": ("throughput", "constant", "smooth", "predictive", "lambda2"),
    "radio.link": ("modelled", "perfect", "none"), "gains.threshold": ("thesis", "ideal"),
    "team.profile": ("team", "thesis"), "team.orphan": ("stop", "solo"),
    "planner.kind": ("escape", "modified", "original"), "radio.preset": ("thesis", "physical", "indoor"),
    "radio.routing": ("direct", "mrsr", "mrdv"), "radio.fading": ("frame", "exchange"),
    "radio.fast_fading": ("none", "rayleigh", "rician"),
}  # fmt: skip
_FAULTS = ("kill", "restart", "hold", "cut", "jam", "heal", "melt")

_OBSTACLES = (
    "[]", "[[]]", "[[[1, 1], [1, 1], [1, 1]]]", "[[[0, 0], [40, 40], [0, 40], [40, 0]]]",
    "[[[1, 1], [2, 2], [3, 3]]]", "[[[20, 20, 1], [21, 20], [21, 21]]]", "[[['a', 1], [2, 2], [3, 3]]]",
    "[" + "[[30, 30], [31, 30], [31, 31]]," * 3000 + "]",
)  # fmt: skip


def make(folder: Path, random: Random) -> None:
    """Write scenario.toml."""
    keys = dict(_MISSION)
    for _ in range(random.choice((0, 1, 1, 2, 4))):
        key, value = random.choice((_number, _number, _word, _shape, _faults))(random)
        keys[key] = value
    text = "".join(f"{key} = {value}\n" for key, value in keys.items()).encode()
    if random.random() < 0.4:
        text = damaged(text, (text, *_examples()), random)
    (folder / "scenario.toml").write_bytes(text)


def read(folder: Path) -> None:
    """Read it as it stands, and run it for a few ticks if it is accepted."""
    path = folder / "scenario.toml"
    scenario_file.load(path)
    arguments = ("--driver", "inline", "--no-record", "--out", folder / "run", "--json")
    call(folder, "run", path, *arguments, "--set", _FEW_TICKS)


def _examples() -> list[bytes]:
    return [path.read_bytes() for path in sorted(Path("scenarios").glob("*.toml"))]


def _value(key: str, random: Random) -> str:
    """A number for a key: an end of its range, one within it, an extreme, or no number."""
    least, most = KEYS[key]
    within = (str(least), str(most), f"{random.uniform(least, min(most, 100 + least)):g}", "1", "2")
    return random.choice((*within, *within, random.choice(NUMBERS).decode(), "'x'", "[]", "true"))


def _number(random: Random) -> tuple[str, str]:
    key = random.choice(sorted(set(KEYS) - set(FAULT)))
    return key, _value(key, random)


def _word(random: Random) -> tuple[str, str]:
    key = random.choice(sorted(_WORDS))
    return key, f"'{random.choice((*_WORDS[key], *_WORDS[key], 'other'))}'"


def _shape(random: Random) -> tuple[str, str]:
    return random.choice(
        (
            ("map.obstacles", random.choice(_OBSTACLES)),
            ("team.ids", random.choice(("[1, 2, 3, 4]", "[7, 3]", "[1, 1]", "[0]", "[1.5]", "3"))),
            ("start.poses", random.choice(("[[8, 8, 0]]", "[[8, 8, 0]," * 4 + "]", "[[8, 8]]"))),
            ("start.poses", "[[8, 8, 0], [8, 12, 90], [12, 8, -90], [12, 12, 360]]"),
            ("map.file", random.choice(("'x.map'", "'/dev/zero'", "'.'", "'\\u0000'", "'a.yaml'"))),
            ("nothing.like.it", "1"),
        )
    )


def _faults(random: Random) -> tuple[str, str]:
    faults = []
    for _ in range(random.choice((1, 2, 50))):
        fault = {"kind": f"'{random.choice(_FAULTS)}'", "at_s": random.choice(("0", "0.05", "0.1"))}
        fault["robots"] = random.choice(("[1]", "[1, 2, 3, 4]", "[4, 4]", "[]", "[9]"))
        fault["radius"] = "10"
        if random.random() < 0.3:
            key = random.choice(sorted(FAULT))
            fault[key.removeprefix("faults.")] = _value(key, random)
        faults.append("{" + ", ".join(f"{name} = {value}" for name, value in fault.items()) + "}")
    return "faults", f"[{', '.join(faults)}]"
