"""Nothing that a mission's digest comes from takes its last place from the processor."""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path
from textwrap import indent
from typing import Any

import pytest

from tests.arithmetic import Finding, findings

ROOT = Path(__file__).parents[1]

ANY = "*"

ALLOWED = [
    ("elementary", ANY, ANY, "the place where such results are rounded until all libraries agree"),
    ("closed_forms", ANY, ANY, "formulas for tables and tests; no mission imports them"),
    ("tangent_bug", ANY, ANY, "the baseline of a benchmark; no mission imports it"),
    (
        "randomness",
        "normals",
        "stream.standard_normal(count)",
        "rounded to a multiple of 2**-20 at once",
    ),
    ("reception", ANY, "self._draws.normal()", "the rounded draws of `Draws`, not those of a generator"),
    (
        "view",
        "shows",
        "np.arctan2(left, ahead)",
        "becomes the number of a beam; what lies right on a beam is a millionth of a beam off the edge",
    ),
    ("graymap", "_plain_values", ANY, "reads whole numbers"),
    (
        "laser",
        "_look_at_disc",
        "math.atan2(cy, cx)",
        "with a margin selects the beams that are tested, each by +, -, * and sqrt",
    ),
    (
        "laser",
        "_look_at_disc",
        "math.asin(radius / math.sqrt(squared))",
        "with a margin selects the beams that are tested, each by +, -, * and sqrt",
    ),
]
"""Module, function, expression, and why it may stay."""


def _settings() -> dict[str, Any]:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    found: dict[str, Any] = settings["tool"]["importlinter"]
    return found


def _pure() -> list[Path]:
    """Folders and modules of what decides, which lint-imports keeps pure as well."""
    (rule,) = (each for each in _settings()["contracts"] if each["name"].startswith("What decides"))
    places = [ROOT.joinpath(*name.split(".")) for name in rule["source_modules"]]
    return [place if place.is_dir() else place.with_suffix(".py") for place in places]


def _sources(places: list[Path]) -> Iterator[Path]:
    for place in places:
        modules = [place] if place.is_file() else sorted(place.rglob("*.py"))
        assert modules, f"{place} has no modules"
        yield from modules


def _all_findings() -> list[Finding]:
    programs = [ROOT / name for name in (*_settings()["root_packages"], "bench")]
    pure = list(_sources(_pure()))
    found = [one for path in pure for one in findings(path.read_text(), path.stem)]
    for path in _sources(programs):
        if path not in pure:
            found += findings(path.read_text(), path.stem, compiled_only=True)
    return found


def _covers(entry: tuple[str, str, str, str], found: Finding) -> bool:
    module, function, expression, _ = entry
    if expression != ANY:
        expression = ast.unparse(ast.parse(expression))  # as this version of Python writes it
    return (
        found.module == module
        and function in (ANY, found.function)
        and expression in (ANY, found.expression)
    )


def test_what_decides_calculates_the_same_on_every_processor() -> None:
    wrong = [str(one) for one in _all_findings() if not any(_covers(entry, one) for entry in ALLOWED)]
    assert not wrong, "take it from contracts/elementary, or multiply:\n" + "\n".join(wrong)


def test_every_exception_is_still_needed() -> None:
    found = _all_findings()
    assert not [entry for entry in ALLOWED if not any(_covers(entry, one) for one in found)]


def _found(text: str, compiled_only: bool = False) -> list[str]:
    return [one.expression for one in findings(text, "snippet", compiled_only)]


IMPORTS = """
import cmath, math, operator
import math as m
import numpy as np
import numpy
import numpy.linalg as la
from math import sin, exp as e_to, sqrt
from numpy import arctan2 as direction
from numpy import linalg
alias = np
"""


@pytest.mark.parametrize(
    "expression",
    [
        "x ** 2", "x ** 0.5", "2 ** x", "2.0 ** x", "10.0 ** -3", "0.1 ** 2", "2 ** 0.5", "pow(x, 2)",
        "x @ y", "x.dot(y)", "f(x).dot(y)", "x.__pow__(2)", "operator.pow(x, 2)",
        "operator.matmul(x, y)", "math.sin(x)", "math.atan2(y, x)", "math.pow(x, 2)", "math.log1p(x)",
        "math.erf(x)", "math.gamma(x)", "math.exp2(x)", "math.cbrt(x)", "m.cos(x)", "sin(x)", "e_to(x)",
        "map(math.sin, x)", "cmath.exp(x)", "np.sin(x)", "numpy.sin(x)", "np.arcsin(x)", "np.exp(x)",
        "np.power(x, 2)", "np.float_power(x, 2)", "np.hypot(x, y)", "np.log10(x)", "direction(y, x)",
        "alias.tan(x)", "np.linalg.norm(x)", "la.norm(x)", "linalg.det(x)", "np.dot(x, y)",
        "np.matmul(x, y)", "np.einsum('i,i', x, y)", "np.inner(x, y)", "np.vdot(x, y)",
        "np.tensordot(x, y)", "np.convolve(x, y)", "np.correlate(x, y)", "np.a_name_not_looked_up(x)",
        "rng.standard_normal(3)", "rng.exponential()",
    ],
)  # fmt: skip
def test_what_may_differ_is_found(expression: str) -> None:
    assert len(_found(f"{IMPORTS}def f(x, y, rng):\n    return {expression}\n")) == 1
    assert len(_found(f"{IMPORTS}value = {expression}")) == 1


@pytest.mark.parametrize("statement", ["x **= 2", "x @= y", "from numpy import *", "from math import *"])
def test_statements_that_may_differ_are_found(statement: str) -> None:
    assert _found(IMPORTS + statement) == [statement]


def test_a_name_given_to_a_function_is_seen_through() -> None:
    assert _found(f"{IMPORTS}sine = np.sin\ny = sine(x)") == ["np.sin", "sine(x)"]


@pytest.mark.parametrize(
    "expression",
    [
        "x * x", "2**62", "2.0**-20", "10**9", "-(2**31)", "f(**x)", "math.sqrt(x)", "sqrt(x)",
        "math.hypot(x, y)", "math.dist(x, y)", "math.remainder(x, y)", "math.fmod(x, y)",
        "math.floor(x)", "math.copysign(x, y)", "math.radians(x)", "2.0 * math.pi", "np.sqrt(x)",
        "np.sum(x)", "x.sum(axis=1)", "x.mean()", "np.interp(x, y, y)", "np.linspace(x, y, 3)",
        "np.zeros(3, np.float64)", "np.random.Generator(x)", "rng.random(3)", "rng.integers(3)",
        "elementary.sin(x)", "elementary.exp(x)", "error.beta", "request.normal",
    ],
)  # fmt: skip
def test_what_is_exact_is_not_found(expression: str) -> None:
    imports = f"{IMPORTS}from onehop.contracts import elementary\n"
    assert _found(f"{imports}def f(x, y, rng):\n    return {expression}\n") == []


COMPILERS = """
import math
import numba
from numba import njit
from numba import njit as quick
from onehop.contracts.kernels import kernel
ready = njit(cache=True)
"""
LENGTH = """
def f(x, y):
    return math.hypot(x, y) + math.sin(x) + math.sqrt(x) + abs(y)
"""


@pytest.mark.parametrize(
    "decorator",
    [
        "@numba.njit",
        "@numba.njit(cache=True)",
        "@njit",
        "@quick",
        "@ready",
        "@numba.vectorize",
        "@kernel()",
        '@kernel(error_model="numpy")',
    ],
)
def test_a_compiled_function_is_held_to_more_and_anywhere(decorator: str) -> None:
    outside = "def g(x):\n    return math.sin(x) ** 2\n"
    compiled = f"{decorator}{LENGTH}"
    expected = ["math.hypot(x, y)", "math.sin(x)"]
    assert _found(f"{COMPILERS}{compiled}{outside}", compiled_only=True) == expected
    within = f"def g(x):\n{indent(compiled, '    ')}    return x ** 2\n"
    assert _found(f"{COMPILERS}{within}", compiled_only=True) == expected
    assert _found(f"{COMPILERS}{LENGTH}") == ["math.sin(x)"]


@pytest.mark.parametrize(
    ("option", "count"),
    [("fastmath=True", 1), ("parallel=True", 1), ("fastmath=False", 0), ("cache=True", 0)],
)
def test_a_compiler_that_may_reorder_is_found(option: str, count: int) -> None:
    for compiler in ("numba.njit", "kernel"):
        text = f"{COMPILERS}@{compiler}({option})\ndef f(x):\n    return x\n"
        assert len(_found(text, compiled_only=True)) == count


def test_a_finding_names_its_place() -> None:
    inner = "        def g(y):\n            return math.sin(y)\n"
    (found,) = findings(f"import math\nclass A:\n    def f(self, x):\n{inner}", "snippet")
    assert (found.module, found.function, found.line) == ("snippet", "g", 5)
    assert findings("import math\nX = math.sin(1.0)\n", "snippet")[0].function == ""
