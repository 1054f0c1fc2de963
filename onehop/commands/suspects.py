"""What in a program's module tends to make it depend on more than its briefing and its percepts."""

import ast
import inspect
import sys
from collections.abc import Iterator

from onehop.robot import Program

MODULES = {
    "time": "the wall clock",
    "datetime": "the wall clock",
    "random": "global randomness",
    "secrets": "global randomness",
    "uuid": "global randomness",
    "os": "the machine and its files",
    "pathlib": "files",
    "io": "files",
    "socket": "the network",
    "threading": "threads",
    "asyncio": "threads",
    "multiprocessing": "processes",
    "subprocess": "processes",
}

CALLS = {
    "open": "files",
    "input": "the keyboard",
    "hash": "the seed of hashes",
    "id": "addresses in memory",
}


def suspects(program: type[Program]) -> list[tuple[int, str]]:
    """Lines of the module of a program, and what each may depend on."""
    try:
        tree = ast.parse(inspect.getsource(sys.modules[program.__module__]))
    except (OSError, SyntaxError):
        return []
    return sorted(set(_suspects(tree)))


def _suspects(tree: ast.AST) -> Iterator[tuple[int, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if (top := alias.name.partition(".")[0]) in MODULES:
                    yield node.lineno, f"{alias.name}: {MODULES[top]}"
        elif isinstance(node, ast.ImportFrom) and node.module in MODULES:
            yield node.lineno, f"{node.module}: {MODULES[node.module]}"
        elif isinstance(node, ast.Attribute) and node.attr == "random" and _is_numpy(node.value):
            yield node.lineno, "numpy.random: global randomness"
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in CALLS:
            yield node.lineno, f"{node.func.id}(): {CALLS[node.func.id]}"
        elif isinstance(node, ast.Global):
            yield node.lineno, f"global {', '.join(node.names)}: shared by robots of one process"
        elif isinstance(node, ast.For | ast.comprehension) and _is_set(node.iter):
            yield node.iter.lineno, "a set that is iterated: its order"


def _is_numpy(node: ast.AST) -> bool:
    return isinstance(node, ast.Name) and node.id in ("np", "numpy")


def _is_set(node: ast.AST) -> bool:
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return node.func.id in ("set", "frozenset")
    return isinstance(node, ast.Set | ast.SetComp)
