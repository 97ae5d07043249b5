"""The Python target: a module of plain functions over floats that imports ``math`` alone.

``math`` raises where IEEE 754 has a value, and so does division; helper functions, written only
where they are used, give NaN and infinity as C and NumPy do.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.program import Program
from codegen.ir.stumpff import SERIES
from codegen.targets.render import ARITHMETIC, Body, Template, calls, table_names
from codegen.targets.target import (
    Target,
    bodies,
    name_tables,
    nested,
    used_helpers,
    used_tables,
    words,
)
from eom.tables import Table

TEMPLATES: dict[str, Template] = {
    **ARITHMETIC,
    **calls("_{}", "div pow sqrt sin cos tan asin acos sinh cosh acosh atanh exp expm1 log log1p"),
    **calls("_{}", "sign min max floor mod stumpff"),
    **calls("math.{}", "atan tanh asinh atan2 hypot erf erfc"),
    **calls("{}", "abs"),
    "table": Template("{data}({0})"),
    "factor": Template("{v} = _factor({n}, {symmetric}, [{entries}])"),
    "back": Template("{v} = _back({factor}, [{entries}])"),
    "item": Template("{0}[{data}]"),
    "lt": Template("(1.0 if {0} < {1} else 0.0)", 100, (6, 6)),
    "le": Template("(1.0 if {0} <= {1} else 0.0)", 100, (6, 6)),
    "eq": Template("(1.0 if {0} == {1} else 0.0)", 100, (6, 6)),
    "and": Template("(1.0 if {0} and {1} else 0.0)", 100, (6, 6)),
    "or": Template("(1.0 if {0} or {1} else 0.0)", 100, (6, 6)),
    "not": Template("(0.0 if {0} else 1.0)", 100, (6,)),
    "select": Template("({1} if {0} else {2})", 100, (6, 6, 6)),
}
"""Conditions are floats, 0 or 1; as in C, NaN counts as true."""

_TRIED = """\
def {name}(a):
    try:
        return math.{function}(a)
    except {error}:
        return {otherwise}
"""


def _tried(function: str, error: str, otherwise: str) -> str:
    return _TRIED.format(name=f"_{function}", function=function, error=error, otherwise=otherwise)


_SERIES = "\n".join(f"        {row!r}," for row in SERIES.values())
_HELPERS: dict[str, str] = {
    "_div": """\
def _div(a, b):
    try:
        return a / b
    except ZeroDivisionError:
        return a * math.copysign(math.inf, b)
""",
    "_pow": """\
def _pow(a, b):
    try:
        return math.pow(a, b)
    except OverflowError:
        return -math.inf if a < 0.0 and b % 2.0 == 1.0 else math.inf
    except ValueError:
        if a != 0.0:
            return math.nan
        return math.copysign(math.inf, a) if b % 2.0 == 1.0 else math.inf
""",
    **{f"_{f}": _tried(f, "ValueError", "math.nan") for f in ("sqrt", "sin", "cos", "tan")},
    **{f"_{f}": _tried(f, "ValueError", "math.nan") for f in ("asin", "acos", "acosh")},
    "_sinh": _tried("sinh", "OverflowError", "math.copysign(math.inf, a)"),
    "_cosh": _tried("cosh", "OverflowError", "math.inf"),
    "_atanh": _tried("atanh", "ValueError", "a * math.inf if abs(a) == 1.0 else math.nan"),
    "_exp": _tried("exp", "OverflowError", "math.inf"),
    "_expm1": _tried("expm1", "OverflowError", "math.inf"),
    "_log": _tried("log", "ValueError", "-math.inf if a == 0.0 else math.nan"),
    "_log1p": _tried("log1p", "ValueError", "-math.inf if a == -1.0 else math.nan"),
    "_sign": """\
def _sign(a):
    return 1.0 if a > 0.0 else -1.0 if a < 0.0 else a + 0.0
""",
    "_min": """\
def _min(a, b):
    return a if a < b or a != a else b
""",
    "_max": """\
def _max(a, b):
    return a if a > b or a != a else b
""",
    "_floor": """\
def _floor(a):
    return a // 1.0 if math.isfinite(a) else a
""",
    "_mod": """\
def _mod(a, b):
    try:
        return a % b
    except ZeroDivisionError:
        return math.nan
""",
    "_factor": """\
def _factor(n, symmetric, entries):
    # P A = L U by rows, with the order of the rows; a symmetric A is given as its upper triangle
    a = [[0.0] * n for _ in range(n)]
    entries = iter(entries)
    for i in range(n):
        for j in range(i if symmetric else 0, n):
            a[i][j] = next(entries)
            if symmetric:
                a[j][i] = a[i][j]
    order = list(range(n))
    for k in range(n):
        best = max(range(k, n), key=lambda i: abs(a[i][k]))
        a[k], a[best] = a[best], a[k]
        order[k], order[best] = order[best], order[k]
        for i in range(k + 1, n):
            a[i][k] = _div(a[i][k], a[k][k])
            for j in range(k + 1, n):
                a[i][j] -= a[i][k] * a[k][j]
    return a, order
""",
    "_back": """\
def _back(factor, right):
    a, order = factor
    n = len(order)
    x = [right[k] for k in order]
    for i in range(n):
        x[i] -= sum(a[i][j] * x[j] for j in range(i))
    for i in range(n - 1, -1, -1):
        x[i] = _div(x[i] - sum(a[i][j] * x[j] for j in range(i + 1, n)), a[i][i])
    return x
""",
    "_stumpff": f"""\
def _stumpff(k, z):
    # sum over j of (-z)**j / (2*j + k)!: a series near zero, sine or sinh and a recurrence elsewhere
    k = int(k)
    end, terms = (
{_SERIES}
    )[k - 1]
    if abs(z) < end:
        c = 1.0
        for j in range(terms, 0, -1):
            c = 1.0 - z * c / ((2.0 * j + k - 1.0) * (2.0 * j + k))
        return c / math.factorial(k)
    s = math.sqrt(abs(z))
    angle = s if k % 2 else 0.5 * s
    try:
        c = (math.sin(angle) if z > 0.0 else math.sinh(angle)) / s
    except (ValueError, OverflowError):
        c = math.nan if z > 0.0 else math.inf
    c = c if k % 2 else 2.0 * c * c
    for n in range(2 - k % 2, k, 2):
        c = (1.0 / math.factorial(n) - c) / z
    return c
""",
}

_DOCSTRING = '''\
"""{title}: equations of motion, generated by eom.

Every function takes time t, states x, parameters p and inputs u, a number and sequences of
numbers, and returns a list of floats. Nothing raises for values: what is not a real number is
nan, and what is too large is inf.
"""

import math
'''
_LOADS = {"t": "float(t)", **{a: f"[*map(float, {a})]" for a in "xpu"}}
"""Arguments may be whole numbers or NumPy's; arithmetic is on floats."""


def files(program: Program, layout: Layout) -> Mapping[str, str]:
    """Return the generated module by file name; the same input gives the same bytes."""
    return {f"{identifier(layout.name)}.{PYTHON.extension}": module(program, layout)}


def module(program: Program, layout: Layout) -> str:
    """Return the module: one function a group of results, and the names of everything."""
    written = bodies(PYTHON, program, layout)
    title = comment(layout.title).replace('"', "'")
    names = [f"{key} = {names!a}" for key, names in name_tables(layout).items()]
    head = "\n".join([_DOCSTRING.format(title=title), *names, ""])
    functions = [_function(group, body) for group, body in written.items()]
    helpers = [*used_helpers(PYTHON, written), *used_tables(PYTHON, table_names(program), written)]
    return "\n\n".join([head, *helpers, *functions])


def _table(name: str, table: Table) -> str:
    """Return the function of a table: a binary search, then a polynomial by Horner's rule."""
    first, last = table.breakpoints[0], table.breakpoints[-1]
    inside = f"{first!r} if x < {first!r} else {last!r} if x > {last!r} else x"
    rows = "\n".join(f"        {row!r}," for row in table.rows)
    return f"""\
def {name}(x):
    # Table {comment(table.label)}: {table.kind}; outside: {table.outside}.
    start = {table.breakpoints!r}
    rows = (
{rows}
    )
    low, high = 0, {len(table.breakpoints)}
    while low < high:
        middle = (low + high) // 2
        if start[middle] <= x:
            low = middle + 1
        else:
            high = middle
    c = rows[low]
    h = ({inside if table.flat_outside else "x"}) - start[max(low - 1, 0)]
    return {nested(len(table.rows[0]))}
"""


def _function(group: str, body: Body) -> str:
    used = words(body)
    lines = [f"def {group}(t, x, p=(), u=()):"]
    lines += [f"    {name} = {load}" for name, load in _LOADS.items() if name in used]
    for line in body.lines:
        text = line.expression if line.room else f"{line.variable} = {line.expression}"
        lines.append(f"    {text}" + (f"  # {line.comment}" if line.comment else ""))
    results = [f"        {result}," for result in body.results]
    return "\n".join([*lines, "    return [", *results, "    ]", ""])


PYTHON = Target(
    name="python",
    extension="py",
    templates=TEMPLATES,
    slots={"time": "t", "state": "x[{0}]", "parameter": "p[{0}]", "input": "u[{0}]"},
    numbers={"inf": "math.inf", "-inf": "(-math.inf)", "nan": "math.nan"},
    files=files,
    helpers=_HELPERS,
    unsupported=dict.fromkeys(("besselj", "bessely"), "choose target c or numpy"),
    table=_table,
)


Array = NDArray[np.float64]
Scalar = Callable[[float, Sequence[float], Sequence[float], Sequence[float]], Sequence[float]]


def over_columns(function: Scalar) -> Callable[[Any, Array, Array, Array, Array], None]:
    """Return a kernel that fills ``out``, (k,) or (k, N), by one call a point."""

    def run(t: Any, x: Array, p: Array, u: Array, out: Array) -> None:
        if out.ndim == 1:
            out[:] = function(t, x.tolist(), p.tolist(), u.tolist())
            return
        count = out.shape[1]
        times = np.broadcast_to(t, count).tolist()
        columns = (_columns(a, count) for a in (x, p, u))
        for k, arguments in enumerate(zip(times, *columns, strict=True)):
            out[:, k] = function(*arguments)

    return run


def _columns(array: Array, count: int) -> list[list[float]]:
    """Return the values of each of ``count`` points; one column serves all."""
    if array.ndim == 1:
        return [array.tolist()] * count
    columns: list[list[float]] = array.T.tolist()
    return columns
