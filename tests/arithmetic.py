"""Finds arithmetic whose last place depends on the processor, in the text of a module.

+, -, *, / and the square root have one right answer (IEEE 754), and so has what is made of them in a
fixed order. The C library, NumPy and BLAS have other code for a processor with FMA or AVX than for one
without, and its results differ in the last place. `onehop/contracts/elementary.py` has what to take
instead. Of `math` and `numpy` every name is a finding that is not listed here as exact; what was looked
up for the lists:

- NumPy's sums (`sum`, `mean`, `var`, `std`) add in an order of their own, eight numbers at once and then
  in pairs. It is written out in C (`pairwise_sum` in loops_utils.h.src: "allows vectorization with avx
  without changing summation ordering"), the same in every copy that is compiled for another processor,
  and has no product that could be fused with a sum. `cumsum` and `bincount` add one by one.
- NumPy has other code with AVX-512 for arcsin, arctan2, power, log1p and most others of their kind
  (loops_umath_fp.dispatch.c.src), and with FMA for sin, cos, exp and log. `dot`, `@`, `convolve` and
  `correlate` end in BLAS. `einsum` and complex products multiply and add at once where the code's copy
  may (`npyv_muladd`).
- `interp` is (y1 - y0) / (x1 - x0) * (x - x0) + y0, compiled once for all x86-64 processors, and so
  without FMA. `linspace` and `radians` are products and sums of whole arrays, one at a time.
- An array to the power 2 is a product in NumPy, a number to the power 2 is the C library's `pow`. The
  text does not say which of them it is: both are findings.
- CPython computes `math.hypot`, `dist` and `fsum` itself; `fmod` and `remainder` are exact by their
  definition. A compiled function (numba) calls the C library's `hypot`: there it is a finding.
- A generator's uniform numbers, whole numbers and permutations are exact; its normal and exponential
  ones take a logarithm in their tail.

Not seen: a module that is handed on as a value or looked up by a string, and what a called function of
another module does. Names are those of a module as a whole: scopes are not told apart.
"""

import ast
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


EXACT_COMPILED = _words(
    """
    ceil copysign degrees e fabs floor fmod inf isfinite isinf isnan nan pi radians sqrt tau trunc
    """
)
"""Of `math` in a function that numba compiles."""

EXACT_MATH = EXACT_COMPILED | _words(
    """
    comb dist factorial frexp fsum gcd hypot isclose isqrt lcm ldexp modf nextafter perm prod remainder
    ulp
    """
)

EXACT_NUMPY = _words(
    """
    bool_ dtype errstate float32 float64 int16 int32 int64 int8 integer intp ndarray newaxis typing
    uint32 uint8
    random.Generator random.PCG64 random.SeedSequence e inf nan pi
    arange array array_equal asarray ascontiguousarray broadcast_to column_stack concatenate copy empty
    empty_like eye frombuffer fromiter full full_like hstack linspace meshgrid ones ones_like pad repeat
    moveaxis reshape roll stack tile vstack zeros zeros_like
    all any argmax argmin argsort argwhere bincount clip count_nonzero diff digitize flatnonzero flip
    isin lexsort
    nonzero searchsorted sort split take unique where
    abs absolute add ceil cumsum divide equal floor floor_divide greater isfinite isinf isnan less
    logical_and logical_not logical_or max maximum mean min minimum mod multiply negative prod remainder
    rint round sign sqrt square std subtract sum trunc var
    degrees interp radians
    """
)

INEXACT_METHODS = _words(
    """
    __ipow__ __imatmul__ __matmul__ __pow__ dot
    beta binomial chisquare dirichlet exponential gamma geometric gumbel laplace logistic lognormal
    normal pareto poisson rayleigh standard_exponential standard_gamma standard_normal vonmises wald
    weibull
    """
)
"""Of an array or a generator, told by their names alone when they are called."""

POWERS_AND_PRODUCTS = _words("pow ipow matmul imatmul")
"""Of the module `operator`; the first one is a builtin function as well."""

INEXACT_MODULES = ("cmath", "scipy")

COMPILERS = ("numba.", "onehop.contracts.kernels.kernel")
"""What makes a compiled function of another: beginnings of full names."""


@dataclass(frozen=True)
class Finding:
    """An expression that may have another last place elsewhere. function: "" outside of functions."""

    module: str
    function: str
    expression: str
    line: int
    why: str

    def __str__(self) -> str:
        return f"{self.module}.py:{self.line}: {self.function}: {self.expression}: {self.why}"


def findings(source: str, module: str, compiled_only: bool = False) -> list[Finding]:
    """What is found in a module's text, in the functions that numba compiles or everywhere."""
    tree = ast.parse(source)
    finder = _Finder(module, _imported(tree), compiled_only)
    finder.visit(tree)
    return finder.found


def _imported(tree: ast.Module) -> dict[str, str]:
    """What names of this module stand for, as full names: imports, and other names given to them."""
    names = {"pow": "builtins.pow"}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for each in node.names:
                root = each.name.partition(".")[0]
                names[each.asname or root] = each.name if each.asname else root
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names |= {each.asname or each.name: f"{node.module}.{each.name}" for each in node.names}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            meant = node.value.func if isinstance(node.value, ast.Call) else node.value
            full = _full_name(meant, names)
            if full and (meant is node.value or full.startswith(COMPILERS)):
                names[node.targets[0].id] = full
    return names


def _full_name(node: ast.expr, names: dict[str, str]) -> str | None:
    """What an expression stands for, if it is an imported name or an attribute of one."""
    if isinstance(node, ast.Name):
        return names.get(node.id)
    if isinstance(node, ast.Attribute):
        before = _full_name(node.value, names)
        return f"{before}.{node.attr}" if before else None
    return None


def _number(node: ast.expr) -> int | float | None:
    """The value of a written number."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        value = _number(node.operand)
        return None if value is None else -value
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return node.value  # type: ignore[return-value]
    return None


def _is_exact_power(base: ast.expr, exponent: ast.expr) -> bool:
    """Whether both are written numbers and the power has no rest to be rounded: 2**62, 2.0**-20."""
    x, n = _number(base), _number(exponent)
    if x is None or n is None or n != int(n):
        return False
    if type(x) is type(n) is int and n >= 0:
        return True
    try:
        power = Fraction(x) ** int(n)
        return Fraction(float(power)) == power
    except (ZeroDivisionError, OverflowError):
        return False


def _why(full: str, compiled: bool) -> str | None:
    """What is wrong with a name; None if nothing is."""
    module, _, rest = full.partition(".")
    first = rest.partition(".")[0]
    if module in INEXACT_MODULES:
        return f"{module} is the C library's"
    if module in ("builtins", "operator") and first in POWERS_AND_PRODUCTS:
        return "a power or a matrix product"
    if module == "math" and rest and first not in (EXACT_COMPILED if compiled else EXACT_MATH):
        return "the C library's"
    if module == "numpy" and rest:
        second = ".".join(rest.split(".")[:2])
        if first not in EXACT_NUMPY and second not in EXACT_NUMPY:
            return "NumPy's, not known to be exact"
    return None


class _Finder(ast.NodeVisitor):
    def __init__(self, module: str, names: dict[str, str], compiled_only: bool) -> None:
        self.found: list[Finding] = []
        self._module = module
        self._names = names
        self._compiled_only = compiled_only
        self._function = ""
        self._compiled = False

    def _note(self, node: ast.expr | ast.stmt, why: str | None) -> None:
        if why and (self._compiled or not self._compiled_only):
            expression = ast.unparse(node)
            self.found.append(Finding(self._module, self._function, expression, node.lineno, why))

    def _visit_all(self, nodes: Iterable[ast.AST]) -> None:
        for node in nodes:
            self.visit(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        outer = self._function, self._compiled
        self._function = node.name
        for decorator in node.decorator_list:
            named = decorator.func if isinstance(decorator, ast.Call) else decorator
            if (_full_name(named, self._names) or "").startswith(COMPILERS):
                self._compiled = True
        self.generic_visit(node)
        self._function, self._compiled = outer

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        if node.module in ("math", "numpy", *INEXACT_MODULES) and node.names[0].name == "*":
            self._note(node, "imports names that are not seen")

    def visit_BinOp(self, node: ast.BinOp) -> None:
        if isinstance(node.op, ast.Pow) and not _is_exact_power(node.left, node.right):
            self._note(node, "a power")
        elif isinstance(node.op, ast.MatMult):
            self._note(node, "a matrix product")
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        if isinstance(node.op, ast.Pow | ast.MatMult):
            self._note(node, "a power or a matrix product")
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        self._look_at_options(node)
        full = _full_name(node.func, self._names)
        why = _why(full, self._compiled) if full else None
        if not full and isinstance(node.func, ast.Attribute) and node.func.attr in INEXACT_METHODS:
            why = "by its name a product, a power or a draw that is not exact"
        self._note(node, why)
        if full:
            self._visit_all((*node.args, *node.keywords))
        else:
            self.generic_visit(node)

    def _look_at_options(self, node: ast.Call) -> None:
        """A compiler that may reorder, or add up in threads, has no fixed order."""
        if not (_full_name(node.func, self._names) or "").startswith(COMPILERS):
            return
        for option in node.keywords:
            loose = not (isinstance(option.value, ast.Constant) and option.value.value is False)
            if option.arg in ("fastmath", "parallel") and loose:
                outer, self._compiled = self._compiled, True
                self._note(node, f"{option.arg} lets the compiler choose the order")
                self._compiled = outer

    def visit_Attribute(self, node: ast.Attribute) -> None:
        full = _full_name(node, self._names)
        if full:
            self._note(node, _why(full, self._compiled))
        else:
            self.generic_visit(node)

    def visit_Name(self, node: ast.Name) -> None:
        full = _full_name(node, self._names)
        if full and isinstance(node.ctx, ast.Load):
            self._note(node, _why(full, self._compiled))
