"""A self-checking C program beside generated C: every function against 50 digits.

The program needs nothing but the generated files and a C compiler, so that it tests them where they
run: on another machine, with another compiler and other options.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from codegen.frontend.layout import Layout, names_of
from codegen.ir.interpret import Bounded, Point, interpret, interpret_with_bound
from codegen.ir.names import comment, identifier
from codegen.ir.ops import BLOCKS, Instruction
from codegen.ir.program import Program

RANDOM_POINTS = 4
_NEAR = 10
"""Within so many errors of an edge it is open on which side of it a computation in doubles is."""

_UNDERFLOW = 1e-300


@dataclass(frozen=True)
class Expected:
    """A result at a point: what it is, and how far from it a computation in doubles may be.

    A value that is not finite must be met as it is; an infinite bound compares nothing.
    """

    value: float
    bound: float


def checks(program: Program, layout: Layout) -> Mapping[str, str]:
    """Return the C program NAME_test.c, which prints a line a function and exits with 0 or 1.

    It calls every function one point at a time and for all points together: at a typical point, at
    zero states and inputs, and at `RANDOM_POINTS` random points. Expected values have 50 digits and
    are rounded once; each has the bound that `interpret_with_bound` gives. Where the value is not
    finite, the kind is compared. Where it is open on which side of a jump or of the border of a
    domain a computation in doubles is, and where it over- or underflows on the way, nothing is.
    """
    at = points(layout)
    expected = [expect(program, point) for point in at]
    name = identifier(layout.name)
    parts = [_head(layout, len(at)), *_arrays(layout, at), _WITHIN]
    parts += [_function(name, layout, g, [e[g] for e in expected]) for g in layout.sizes]
    calls = " + ".join(f"{name}_test_{group}()" for group in layout.sizes)
    parts.append(f"int main(void) {{\n    return {calls} > 0;\n}}\n")
    return {f"{name}_test.c": "\n".join(parts)}


# --- points and expected values ------------------------------------------------------------------------


def points(layout: Layout) -> list[Point]:
    """Return a typical point, zero states and inputs, and random points; the same each time."""
    draw = random.Random(0)  # noqa: S311 - reproducible points
    positive = [bool(q.symbol.is_positive) for q in layout.parameters]
    typical = [(1.0 if plus else 0.2) + 0.1 * (k % 7) for k, plus in enumerate(positive)]
    first = Point(
        0.5,
        [0.3 + 0.1 * (k % 7) for k in range(len(layout.states))],
        [round(v, 6) for v in typical],
        [0.1 * (1 + k % 5) for k in range(len(layout.inputs))],
    )
    zero = Point(0.0, [0.0] * len(layout.states), first.p, [0.0] * len(layout.inputs))

    def values(count: int, low: float, high: float) -> list[float]:
        return [round(draw.uniform(low, high), 6) for _ in range(count)]

    drawn = [
        Point(
            round(draw.uniform(0, 3), 6),
            values(len(layout.states), -2, 2),
            [values(1, 1.1, 2.0)[0] if plus else values(1, -0.5, 0.5)[0] for plus in positive],
            values(len(layout.inputs), -1, 1),
        )
        for _ in range(RANDOM_POINTS)
    ]
    return [first, zero, *drawn]


def expect(program: Program, point: Point) -> dict[str, list[Expected]]:
    """Return what each result must be at a point."""
    numbers = [k for k, i in enumerate(program.instructions) if i.op not in BLOCKS]
    every = Program(program.instructions, {"": tuple(numbers)})
    exact = [Bounded(0.0, 0.0)] * len(program.instructions)
    doubles = [0.0] * len(program.instructions)
    found = interpret_with_bound(every, point)[""], interpret(every, point)[""]
    for k, bounded, double in zip(numbers, *found, strict=True):
        exact[k], doubles[k] = bounded, double
    open_ = _open(program, exact)
    return {
        group: [
            Expected(0.0, math.inf) if open_[k] else _expected(exact[k], doubles[k])
            for k in numbers
        ]
        for group, numbers in program.results.items()
    }


def _expected(exact: Bounded, double: float) -> Expected:
    """Join what 50 digits say with what doubles make of it where it is not finite."""
    value = float(exact.value)
    if not math.isfinite(value) and not math.isfinite(double):
        return Expected(double, 0.0)
    bound = exact.error + math.ulp(value) / 2
    if not math.isfinite(bound) or not abs(double - value) <= bound:
        return Expected(0.0, math.inf)
    return Expected(value, bound)


def _open(program: Program, exact: Sequence[Bounded]) -> list[bool]:
    """Tell for each value whether an edge is so near that its errors may cross it, here or before."""
    errors = [_error(i, e) for i, e in zip(program.instructions, exact, strict=True)]
    found: list[bool] = []
    for op, args, _ in program.instructions:
        near = any(found[a] for a in args)
        if not near and op in _EDGES:
            which, edges = _EDGES[op]
            error = _NEAR * sum(errors[args[k]] for k in which)
            values = edges(*(exact[a].value for a in args)) if 0 < error < math.inf else ()
            near = any(abs(edge) <= error for edge in values)
        found.append(near)
    return found


def _error(instruction: Instruction, exact: Bounded) -> float:
    """Return the error of a value; a constant that is a double has none.

    Nor has a zero whose error is what the bound allows for underflow: the points are of size one.
    """
    rounded = float(exact.value)
    is_const = instruction.op == "const" and math.isfinite(rounded)
    is_double = is_const and Fraction(rounded) == instruction.value
    return 0.0 if is_double or exact.error < _UNDERFLOW else exact.error


def _whole(value: Any) -> Any:
    return value - value.context.nint(value)


_EDGES: dict[str, tuple[tuple[int, ...], Callable[..., Iterable[Any]]]] = {
    **dict.fromkeys(("sqrt", "log", "sign", "not"), ((0,), lambda a: (a,))),
    **dict.fromkeys(("asin", "acos", "atanh"), ((0,), lambda a: (a - 1, a + 1))),
    **dict.fromkeys(("lt", "le", "eq"), ((0, 1), lambda a, b: (a - b,))),
    **dict.fromkeys(("and", "or"), ((0, 1), lambda a, b: (a, b))),
    "acosh": ((0,), lambda a: (a - 1,)),
    "log1p": ((0,), lambda a: (a + 1,)),
    "div": ((1,), lambda a, b: (b,)),
    "pow": ((0,), lambda a, b: (a,)),
    "atan2": ((0,), lambda y, x: (y,) if x <= 0 else ()),
    "floor": ((0,), lambda a: (_whole(a),)),
    "mod": ((0, 1), lambda a, b: (b, _whole(a / b)) if b else (b,)),
    "bessely": ((1,), lambda n, a: (a,)),
    "select": ((0,), lambda c, a, b: (c,)),
}
"""By operation: the operands whose errors count, and numbers whose signs decide on which side of a
jump, a pole or a border the operation is."""


# --- the C text ----------------------------------------------------------------------------------------


def _head(layout: Layout, count: int) -> str:
    name = identifier(layout.name)
    return "\n".join(
        [
            f"/* {comment(layout.title)}: test of the functions, generated by eom.",
            " *",
            " * Results are compared with values of 50 digits, rounded once. A bound is twice what",
            " * double precision loses on the way to first order; INFINITY: not compared. Where the",
            " * expected value is NAN or INFINITY, the result must be so too.",
            " */",
            f'#include "{name}.h"',
            "",
            "#include <math.h>",
            "#include <stddef.h>",
            "#include <stdio.h>",
            "",
            f"enum {{ {name}_n_points = {count} }};",
            "",
        ]
    )


_WITHIN = """\
static int within_(double y, double value, double bound) {
    if (value != value) return y != y;
    if (bound == 0.0 || bound == INFINITY) return bound != 0.0 || y == value;
    return fabs(y - value) <= bound;
}
"""


def _arrays(layout: Layout, at: Sequence[Point]) -> list[str]:
    name = identifier(layout.name)
    arrays: dict[str, list[Sequence[float]]] = {
        "t": [[point.t] for point in at],
        "x": [point.x for point in at],
        "p": [point.p for point in at],
        "u": [point.u for point in at],
    }
    return [_array(f"{name}_at_{a}", name, rows) for a, rows in arrays.items() if len(rows[0])]


def _array(array: str, name: str, rows: Sequence[Sequence[float]]) -> str:
    """Return a constant array, a row a point."""
    listed = [f"    {', '.join(_number(v) for v in row)}," for row in rows]
    size = f"{name}_n_points * {len(rows[0])}"
    return "\n".join([f"static const double {array}[{size}] = {{", *listed, "};", ""])


def _number(value: float) -> str:
    if math.isfinite(value):
        return repr(float(value))
    return "NAN" if math.isnan(value) else "INFINITY" if value > 0 else "-INFINITY"


def _rounded_up(bound: float) -> str:
    return f"{bound * 1.001:.3e}" if math.isfinite(bound) else "INFINITY"


def _function(name: str, layout: Layout, group: str, rows: Sequence[Sequence[Expected]]) -> str:
    """Return the test of one function: each point alone, then all together."""
    size = layout.sizes[group]
    values = _array("value", name, [[e.value for e in row] for row in rows])
    bounds = [f"    {', '.join(_rounded_up(e.bound) for e in row)}," for row in rows]
    compared = sum(math.isfinite(e.bound) for row in rows for e in row)
    return "\n".join(
        [
            f"static int {name}_test_{group}(void) {{",
            f"    enum {{ size = {size}, points = {name}_n_points }};",
            *(f"    {line}".rstrip() for line in values.splitlines()),
            f"    static const double bound[{name}_n_points * size] = {{",
            *(f"    {line}" for line in bounds),
            "    };",
            "    double one[size], all[points * size];",
            "    int wrong = 0;",
            *_calls(name, layout, group),
            "        for (int i = 0; i < size; ++i) {",
            "            const int j = k * size + i;",
            "            if (within_(one[i], value[j], bound[j]) && within_(all[j], value[j], bound[j]))",
            "                continue;",
            "            ++wrong;",
            f'            printf("{group}[%d] at point %d: %.17g, together %.17g, "',
            '                "not %.17g within %.3g\\n", i, k,',
            "                one[i], all[j], value[j], bound[j]);",
            "        }",
            "    }",
            f'    printf("{group}: {compared} of %d values compared at %d points, %d wrong\\n",',
            "        points * size, points, wrong);",
            "    return wrong;",
            "}",
            "",
        ]
    )


def _calls(name: str, layout: Layout, group: str) -> list[str]:
    """Return the calls of a function and of its batch form, up to the loop over the results."""
    kinds = {"x": layout.states, "p": layout.parameters, "u": layout.inputs}
    counts = {a: len(names_of(quantities)) for a, quantities in kinds.items()}
    whole = [f"{name}_at_{a}, 1, {n}" if n else "NULL, 0, 0" for a, n in counts.items()]
    one = {a: f"{name}_at_{a} + k * {n}" if n else "NULL" for a, n in counts.items()}
    return [
        f"    {name}_constants c;",
        f"    {name}_{group}_batch(points, {name}_at_t, 1, {', '.join(whole)}, all, 1, size);",
        "    for (int k = 0; k < points; ++k) {",
        f"        {name}_prepare({one['p']}, &c);",
        f"        {name}_{group}({name}_at_t[k], {one['x']}, &c, {one['u']}, one);",
    ]
