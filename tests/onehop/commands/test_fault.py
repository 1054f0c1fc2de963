"""`onehop fault`: what was typed wrong is said in one line, before any mission is looked for."""

from typing import Any

import pytest

from onehop.commands.fault import OPTIONS, fault
from onehop.contracts.errors import InputError
from onehop.contracts.fault_section import KINDS, OWN_KEYS, TIMING, FaultSection, fault_in_words


def order(kind: str, robots: str = "", others: str = "", **given: Any) -> None:
    fault(kind, robots, others, None, given, as_json=False)


@pytest.mark.parametrize(
    ("arguments", "given", "said"),
    [
        (("freeze", "3"), {}, "fault freeze: no kind of fault; one of kill, stop, continue"),
        (("kill",), {}, "fault kill: ROBOTS: kill of nobody; name at least one robot"),
        (("kill", "3;4"), {}, "ROBOTS 3;4: not ids of robots; whole numbers, e.g. 3 or 1,4"),
        (("kill", "0"), {}, "fault kill: ROBOTS: 0 is out of range; a number from 1 to"),
        (("kill", "3"), {"duration_s": 2.0}, "fault kill: takes no --for; it takes ROBOTS"),
        (("kill", "3", "4"), {}, "fault kill: takes no --others; it takes ROBOTS"),
        (("stop", "3"), {"duration_s": -1.0}, "fault stop: --for: -1.0 is out of range"),
        (("kidnap", "3"), {"x": 3.0}, "fault kidnap: --y is missing; where [m]"),
        (("kidnap", "3,4"), {"x": 3.0, "y": 3.0}, "fault kidnap: ROBOTS: 2 robots to one place"),
        (("jam",), {"x": 3.0, "y": 3.0}, "fault jam: --radius: a jam without extent"),
        (("slow", "3"), {}, "fault slow: --delay: slow by no tick"),
        (("cut", "3"), {"direction": "out"}, "fault cut: --direction: 'out' is unknown; one of both"),
        (("corrupt",), {"probability": float("nan")}, "fault corrupt: --probability: nan is out"),
    ],
)
def test_what_is_typed_wrong_is_one_line_with_its_option(
    arguments: tuple[str, ...], given: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError) as refused:
        order(*arguments, **given)
    assert str(refused.value).startswith(said)
    assert "\n" not in str(refused.value)


def test_every_key_of_every_kind_has_an_option() -> None:
    assert set(OWN_KEYS) == set(KINDS)
    assert {key for keys in OWN_KEYS.values() for key in keys} == set(OPTIONS)
    assert not set(OPTIONS) & set(TIMING)


@pytest.mark.parametrize(
    ("one", "words"),
    [
        (FaultSection("kill", 1.0, robots=(3, 4)), "kill 3, 4"),
        (FaultSection("stop", 1.0, robots=(3,), duration_s=2.5), "stop 3, 2.5 s"),
        (FaultSection("kidnap", 1.0, robots=(3,), x=4.0, y=5.5), "kidnap 3 to (4, 5.5)"),
        (FaultSection("slow", 1.0, robots=(3,), delay_ticks=4), "slow 3 by 4 ticks"),
        (FaultSection("cut", 1.0, robots=(3,)), "cut 3 from the rest"),
        (FaultSection("cut", 1.0, robots=(3,), direction="from"), "cut 3 one way to the rest"),
        (
            FaultSection("cut", 1.0, robots=(3,), others=(1, 2), direction="to"),
            "cut 3 one way from 1, 2",
        ),
        (FaultSection("corrupt", 1.0, probability=0.25), "corrupt 25 % of what everyone receives"),
        (FaultSection("jam", 1.0, x=1.0, y=2.0, radius=8.0), "jam within 8 m of (1, 2)"),
        (FaultSection("heal", 1.0), "heal everything"),
    ],
)
def test_a_fault_in_words(one: FaultSection, words: str) -> None:
    assert fault_in_words(one) == words
