"""`onehop verify`: what makes a program fickle is found, in which tick and field."""

import json
from pathlib import Path
from typing import Any

import pytest

from tests.onehop.command_line import in_shell as onehop

pytestmark = pytest.mark.live

EXAMPLES = Path(__file__).parents[2] / "examples"


def verify(program: str, *words: str) -> tuple[dict[str, Any], int]:
    done = onehop("verify", f"tests.onehop.programs.{program}", "--missions", "1", "--json", *words)
    assert done.stdout, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer, done.returncode


def test_a_sound_program_is_said_to_be_one() -> None:
    answer, status = verify("samples:Seeker", "--set", "team.parameters.speed=2")
    assert (answer["deterministic"], answer["first"], answer["failures"]) == (True, None, [])
    assert 0.0 < answer["step_ms_p50"] <= answer["step_ms_p99"] < 50.0
    assert status == 0


@pytest.mark.parametrize(
    ("name", "how"),
    [
        ("ByClock", "run again"),
        ("ByChance", "run again"),
        ("ByOrder", "run again"),
        ("ByOthers", "run as processes"),
    ],
)
def test_a_fickle_program_is_found_out_with_the_first_tick(name: str, how: str) -> None:
    answer, status = verify(f"fickle:{name}")
    assert answer["how"] == how
    first = answer["first"]
    assert (first["tick"], first["robot"], first["channel"]) == (7, 1, "/wire/out/1")
    assert first["field"] == "values.level"
    assert first["recorded"] != first["replayed"]
    assert status == 1


def test_a_program_that_fails_is_not_sound_however_often_it_does() -> None:
    answer, status = verify("fickle:Failing")
    assert answer["deterministic"]
    (why,) = answer["failures"]
    assert why.startswith("its program failed: ZeroDivisionError: ")
    assert status == 1


def test_a_step_that_takes_longer_than_a_tick_is_too_slow() -> None:
    answer, status = verify("fickle:Slow", "--set", "clock.period_ms=1", "--set", "clock.limit_s=0.2")
    assert answer["step_ms_p50"] > answer["period_ms"] == 1.0
    assert answer["deterministic"]
    assert status == 1


@pytest.mark.parametrize("program", ["flocking:Flocking", "relay:Relay", "mapless:Mapless"])
def test_the_worked_examples_say_the_same_every_time(program: str) -> None:
    done = onehop("verify", program, "--missions", "1", "--json", cwd=EXAMPLES)
    assert done.stdout, done.stderr
    answer = json.loads(done.stdout)
    assert (answer["deterministic"], answer["first"], answer["failures"]) == (True, None, [])
