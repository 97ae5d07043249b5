"""``python -m benchmarks.hostile_references [NAME ...]``: references of the hostile systems.

Every case of `codegen.measure.stress.hostile_cases` is solved twice, by methods and code that share nothing
with the package but the equations:

1. Extrapolation of the midpoint rule in quadruple precision (``hostile_references.c``, order 16, local
   error 1e-22), in C that SymPy's printer writes, with the instants at which something happens given;
2. SciPy's DOP853, or Radau with an exact Jacobian where the case is stiff, at 1e-13 with short steps,
   in doubles; where time is late and matters, its rates are read in 40 digits.

A case whose two solutions differ by more than `AGREED` times its growth is refused, and nothing is
stored for it. The *growth* of a case up to an instant T is what its own equations make of errors, whatever
the method: with sizes s_i, the largest moduli of the states on the way,

    A(t) = max_ij |d x_i(T) / d x_j(t)| s_j / s_i,
    growth = max(1, max_t A(t), integral of A(t) max_j |dx_j/dt| / s_j dt),

the last for errors that are made all along the way, in proportion to how far the states move. The
derivatives are differences of solutions that start from changed states, at `SAMPLES` instants evenly in
time and as many evenly in steps.

The results go to ``codegen/measure/stress/hostile_references.json``; cases that are there already and
unchanged are left, but for those that are named.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from sympy.printing.c import C99CodePrinter

from codegen.measure.stress.hostile import STORE, digest
from codegen.measure.stress.hostile_cases import Hostile, cases, t
from eom.tables import TableFunction

Expr = Any
AGREED = 1e-10
OUTPUTS = 4
"""So many instants, evenly spaced, are compared."""
REACH = 10.0
"""Something narrow is over after so many of its widths."""
WITHIN = 0.25
"""Longest step there, in widths."""
SAMPLES = 3
LATE = 1e5
"""From here on time is late: the second solution reads it in more digits than doubles have."""
DIGITS = 40
SECONDS = 900
AT_ONCE = 2


class Quad(C99CodePrinter):  # type: ignore[misc]
    """Expressions as C in quadruple precision; numbers are exact quotients."""

    NAMES = (
        "sin",
        "cos",
        "tan",
        "asin",
        "acos",
        "atan",
        "atan2",
        "sinh",
        "cosh",
        "tanh",
        "acosh",
        "exp",
        "log",
        "erf",
        "erfc",
    )

    def __init__(self) -> None:
        names = {n: f"{n}q" for n in self.NAMES} | {"Abs": "fabsq"}
        super().__init__({"user_functions": names})

    def _print_Rational(self, number: Expr) -> str:
        exact = sp.Rational(number)
        return f"({exact.p}.0Q/{exact.q}.0Q)"

    _print_Integer = _print_Float = _print_Half = _print_Rational
    _print_NegativeOne = _print_One = _print_Zero = _print_Rational

    def _print_Pi(self, _: Expr) -> str:
        return "M_PIq"

    def _print_Exp1(self, _: Expr) -> str:
        return "M_Eq"

    def _print_coth(self, node: Expr) -> str:
        return f"(1.0Q/tanhq({self._print(node.args[0])}))"

    def _print_Pow(self, node: Expr) -> str:
        base, exponent = node.as_base_exp()
        text = self._print(base)
        if base is sp.E:
            return f"expq({self._print(exponent)})"
        if exponent.is_Integer:
            return f"whole({text}, {int(exponent)})"
        if exponent == sp.Rational(1, 2):
            return f"sqrtq({text})"
        return f"powq({text}, {self._print(exponent)})"

    def _print_Max(self, node: Expr) -> str:
        first, *rest = sorted(node.args, key=str)
        text = self._print(first)
        for other in rest:
            text = f"fmaxq({text}, {self._print(other)})"
        return str(text)


HEAD = """#include <quadmath.h>
typedef __float128 real;
static real whole(real x, int n) {
    real result = 1;
    for (unsigned m = n < 0 ? -n : n; m; m >>= 1, x *= x) if (m & 1) result *= x;
    return n < 0 ? 1 / result : result;
}
"""


@dataclass(frozen=True)
class Segments:
    """Times between which nothing bends: ``stops``, the longest step in each, which stops are compared."""

    stops: tuple[float, ...]
    longest: tuple[float, ...]
    output: tuple[bool, ...]


def segments(case: Hostile) -> Segments:
    """Cut the span at the instants that are compared, at knots and around what is narrow."""
    first, last = case.span
    compared = [first + (last - first) * k / OUTPUTS for k in range(1, OUTPUTS)] + [last]
    cuts = {*compared, *case.knots, *(a + s * REACH * w for a, w in case.fine for s in (-1, 0, 1))}
    low, high = sorted(case.span)
    stops = sorted({first, *(c for c in cuts if low < c < high), last}, reverse=last < first)
    longest = []
    for a, b in pairwise(stops):
        middle = (a + b) / 2
        near = [WITHIN * w for at, w in case.fine if abs(middle - at) < REACH * w]
        longest.append(min([case.step, abs(b - a), *near]))
    return Segments(tuple(stops), tuple(longest), tuple(s in compared for s in stops))


def plain(expression: Expr) -> Expr:
    """Return an expression with tables as pieces: straight lines, or SciPy's spline."""
    return expression.replace(
        lambda e: isinstance(e, TableFunction), lambda e: _pieces(e.table, e.args[1])
    )


def _pieces(table: Any, s: Expr) -> Expr:
    places = [sp.Rational(b) for b in table.breakpoints]
    values = [sp.Rational(v) for v in table.values]
    if table.kind == "linear":
        slopes = [
            (values[k + 1] - values[k]) / (places[k + 1] - places[k])
            for k in range(len(places) - 1)
        ]
        rows = [values[k] + slopes[k] * (s - places[k]) for k in range(len(slopes))]
    else:
        spline = CubicSpline(table.breakpoints, table.values).c.T
        rows = [
            sum(sp.Rational(c) * (s - a) ** (3 - n) for n, c in enumerate(row))
            for a, row in zip(places, spline, strict=False)
        ]
    inner = [(row, s < end) for row, end in zip(rows, places[1:], strict=True)]
    return sp.Piecewise((values[0], s < places[0]), *inner, (values[-1], True))


def c_text(case: Hostile, cut: Segments) -> str:
    """Return the program that solves a case in quadruple precision."""
    printer = Quad()
    shared, rates = sp.cse(
        [plain(r) for r in map(sp.sympify, case.rates.values())],
        symbols=sp.numbered_symbols("common"),
    )
    number = lambda value: printer.doprint(sp.Rational(value))  # noqa: E731
    listed = lambda values: ", ".join(map(number, values))  # noqa: E731
    lines = [f"real {s} = state_[{k}];" for k, s in enumerate(case.rates)]
    lines += [f"real {a} = {printer.doprint(e)};" for a, e in shared]
    lines += [f"rate_[{k}] = {printer.doprint(r)};" for k, r in enumerate(rates)]
    data = [
        f"#define N {len(case.rates)}", f"#define COUNT {len(cut.longest)}",
        f"#define CLIP {int(bool(case.knots))}",
        f"#define SAMPLES {SAMPLES}",
        f"static const real start[] = {{{listed(case.start)}}}, stops[] = {{{listed(cut.stops)}}};",
        f"static const real longest[] = {{{listed(cut.longest)}}};",
        f"static const int output[] = {{{', '.join(str(int(o)) for o in cut.output)}}};",
        "static void rates(real t, const real *state_, real *rate_) {",
        *lines, "(void)t; (void)state_;", "}",
    ]  # fmt: skip
    return (
        HEAD + "\n".join(data) + "\n" + Path(__file__).with_suffix(".c").read_text(encoding="utf-8")
    )


@dataclass(frozen=True)
class Solved:
    """What the first solution gives: sizes (n,), instants, states (instants, n), growth by instant."""

    sizes: list[float]
    times: list[float]
    states: list[list[float]]
    growth: list[float]
    steps: int


def solved(case: Hostile, cut: Segments) -> Solved:
    """Solve in quadruple precision. Raises `RuntimeError` where the program gives up."""
    with tempfile.TemporaryDirectory() as folder:
        source, program = Path(folder) / "case.c", Path(folder) / "case"
        source.write_text(c_text(case, cut), encoding="ascii")
        subprocess.run(
            ["gcc", "-O2", "-w", "-o", str(program), str(source), "-lquadmath", "-lm"], check=True
        )
        done = subprocess.run(
            [str(program)], capture_output=True, text=True, timeout=SECONDS, check=False
        )
    if done.returncode:
        raise RuntimeError("the reference takes too many steps")
    lines = [line.split() for line in done.stdout.splitlines()]
    rows = [line for line in lines if line[0] == "at"]
    n = len(case.rates)
    return Solved(
        [float(v) for v in lines[0][1:]], [float(r[1]) for r in rows],
        [[float(v) for v in r[2 : 2 + n]] for r in rows], [float(r[-1]) for r in rows], int(lines[-1][1]),
    )  # fmt: skip


def _functions(case: Hostile) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return rates and their Jacobian over tau, the time since the start, and the states, for SciPy."""
    states, first = list(case.rates), case.span[0]
    rates = sp.Matrix([plain(sp.sympify(r)) for r in case.rates.values()])
    late = abs(first) > LATE and rates.has(t)
    modules = "mpmath" if late else ["scipy", "numpy"]
    f = sp.lambdify([t, *states], list(rates), modules=modules, cse=True)
    jacobian = (
        sp.lambdify([t, *states], rates.jacobian(states).tolist(), modules=modules, cse=True)
        if case.stiff
        else None
    )

    def at(tau: float) -> Any:
        return mpmath.mpf(first) + mpmath.mpf(tau) if late else first + tau

    def field(tau: float, state: Any) -> Any:
        return np.array(f(at(tau), *map(float, state)), dtype=float)

    def slope(tau: float, state: Any) -> Any:
        return np.array(jacobian(at(tau), *map(float, state)), dtype=float) if jacobian else None

    return field, slope


def confirmed(case: Hostile, cut: Segments, sizes: Sequence[float]) -> list[list[float]]:
    """Solve by SciPy and return the states at the instants that are compared."""
    mpmath.mp.dps = DIGITS
    field, slope = _functions(case)
    first = case.span[0]
    state, found = np.array(case.start, dtype=float), []
    for k, longest in enumerate(cut.longest):
        a, b = cut.stops[k] - first, cut.stops[k + 1] - first
        inside = max(abs(b - a) * 1e-12, 8 * float(np.spacing(max(abs(a), abs(b)))))
        clipped = (
            (lambda s, x, a=a, b=b, i=inside: field(min(max(s, min(a, b) + i), max(a, b) - i), x))
            if case.knots
            else field
        )
        given = {"jac": slope} if case.stiff else {}
        run = solve_ivp(
            clipped, (a, b), state, "Radau" if case.stiff else "DOP853", rtol=1e-13,
            atol=[1e-15 * s for s in sizes], max_step=longest, **given,
        )  # fmt: skip
        if run.status != 0:
            raise RuntimeError(f"SciPy: {run.message}")
        state = run.y[:, -1]
        if cut.output[k + 1]:
            found.append([float(s) for s in state])
    return found


def reference(case: Hostile) -> dict[str, Any]:
    """Return what is stored of a case. Raises `RuntimeError` where its solutions do not agree."""
    cut = segments(case)
    with np.errstate(all="ignore"):
        first = solved(case, cut)
        second = confirmed(case, cut, first.sizes)
    agreement = 0.0
    for one, other, growth in zip(first.states, second, first.growth, strict=True):
        apart = max(abs(a - b) / s for a, b, s in zip(one, other, first.sizes, strict=True))
        agreement = max(agreement, apart / growth)
    if not agreement <= AGREED:
        raise RuntimeError(f"solutions differ by {agreement:.1e} of the growth {first.growth}")
    return {
        "digest": digest(case), "times": first.times, "sizes": first.sizes, "states": first.states,
        "growth": [float(f"{g:.3g}") for g in first.growth], "agreement": float(f"{agreement:.1e}"),
    }  # fmt: skip


def _reported(case: Hostile) -> tuple[str, dict[str, Any] | None]:
    begun = time.perf_counter()
    try:
        found = reference(case)
    except (RuntimeError, subprocess.SubprocessError, ValueError) as error:
        print(f"{case.key}: NONE: {str(error)[:200]}", flush=True)
        return case.key, None
    took = time.perf_counter() - begun
    print(
        f"{case.key}: growth {max(found['growth']):.1e}, agreement {found['agreement']:.0e}, {took:.1f} s",
        flush=True,
    )
    return case.key, found


def _save(store: dict[str, Any]) -> None:
    order = {case.key: None for case in cases()}
    rows = [f"{json.dumps(k)}: {json.dumps(store[k])}" for k in order if k in store]
    STORE.write_text("{\n" + ",\n".join(rows) + "\n}\n", encoding="ascii")


def main(names: Sequence[str]) -> None:
    """Make the references that are missing, changed or named, and store them."""
    store = json.loads(STORE.read_text(encoding="ascii")) if STORE.exists() else {}
    wanted = [
        c
        for c in cases()
        if any(n in c.key for n in names)
        or (not names and store.get(c.key, {}).get("digest") != digest(c))
    ]
    with ProcessPoolExecutor(AT_ONCE) as pool:
        for key, found in pool.map(_reported, wanted):
            store.pop(key, None)
            if found:
                store[key] = found
            _save(store)


if __name__ == "__main__":
    main(sys.argv[1:])
