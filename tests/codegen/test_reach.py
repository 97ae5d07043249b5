"""The table of reaches: complete, its bounds hold on discs, its laws hold of coefficients."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath
import pytest

from codegen.derivatives.taylor import JET, prepare, unrolled
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.ops import OPS
from codegen.ir.program import Builder, Program
from codegen.watch.trust import (
    HONEST,
    LINEAR_SYSTEMS,
    PIECES,
    POLYNOMIALS,
    ROWS,
    bound_of,
    quiet_of,
    reach_of,
)
from eom.errors import InputError

M: Any = mpmath.mp.clone()
M.dps = 30
NAMES = sorted(ROWS)
ORDERS = (3, 6, 10, 15, 22, 30)
TERMS = 60


def _stumpff(k: Any, z: Any) -> Any:
    """By the series, at complex arguments."""
    return M.nsum(lambda j: (-z) ** int(j) / M.factorial(2 * int(j) + int(k)), [0, 40])


SPECIAL: dict[str, Callable[..., Any]] = {
    "div": lambda a, b: a / b,
    "pow": lambda x, y: M.exp(y * M.log(x)) if x != 0 else M.mpf(0),
    "expm1": lambda z: M.exp(z) - 1,
    "log1p": lambda z: M.log(1 + z),
    "hypot": lambda x, y: M.sqrt(x * x + y * y),
    "atan2": lambda y, x: (M.log(x + 1j * y) - M.log(x - 1j * y)) / 2j,
    "besselj": lambda n, z: M.besselj(int(n), z),
    "bessely": lambda n, z: M.bessely(int(n), z),
    "stumpff": _stumpff,
}
"""Continuations into the complex plane, where mpmath has none of the name."""
INTERVALS = {
    "log": (0.01, 9.0), "sqrt": (0.01, 9.0), "log1p": (-0.95, 9.0), "acosh": (1.02, 9.0),
    "asin": (-0.97, 0.97), "acos": (-0.97, 0.97), "atanh": (-0.97, 0.97),
}  # fmt: skip


def value(op: str, args: list[Any]) -> Any:
    return (SPECIAL.get(op) or getattr(M, op))(*args)


def point(op: str, draw: random.Random) -> list[float]:
    """Return arguments inside the domain; whole numbers where the operation wants them."""
    x = draw.uniform(*INTERVALS.get(op, (-4.0, 4.0)))
    if op == "div":
        return [draw.uniform(-3, 3), x]
    if op == "pow":
        y = draw.choice((-12.0, -1.5, -1.0, 0.5, 2.5, 7.0, 40.0))
        return [abs(x) + 0.01, y]
    if op in {"hypot", "atan2"}:
        return [draw.uniform(-3, 3), abs(x) + 0.1]
    if op in {"besselj", "bessely", "stumpff"}:
        k = draw.randint(1, 4)
        return [k, abs(x) + 0.05 if op == "bessely" else x]
    return [x]


def distance(op: str, args: list[float]) -> float:
    """Return how far the nearest singularity is from the moving arguments."""
    x = args[ROWS[op].moving[0]]
    if op == "pow":
        return math.inf if args[1] >= 0 and args[1] == int(args[1]) else abs(x)
    known: dict[str, Callable[[], float]] = {
        **dict.fromkeys(("log", "sqrt", "div", "bessely"), lambda: abs(x)),
        **dict.fromkeys(("asin", "acos", "atanh"), lambda: 1 - abs(x)),
        **dict.fromkeys(("atan", "asinh"), lambda: math.hypot(1, x)),
        **dict.fromkeys(("hypot", "atan2"), lambda: math.hypot(*args)),
        "log1p": lambda: 1 + x,
        "acosh": lambda: x - 1,
        "tan": lambda: min(abs(x - (k + 0.5) * math.pi) for k in range(-4, 4)),
        "tanh": lambda: math.hypot(x, math.pi / 2),
    }
    return known.get(op, lambda: math.inf)()


def moved(op: str, args: list[float], d: float, angle: float, share: float) -> list[Any]:
    """Return the arguments after a movement, divided between two where two move."""
    step = M.mpf(d) * M.expj(angle)
    rows = ROWS[op].moving
    parts = [step] if len(rows) == 1 else [share * step, (1 - share) * step * M.expj(2 * angle)]
    found: list[Any] = [M.mpf(a) if isinstance(a, float) else a for a in args]
    for k, part in zip(rows, parts, strict=True):
        found[k] += part
    return found


def test_every_operation_has_a_row_or_needs_none() -> None:
    kinds = (set(ROWS), POLYNOMIALS, PIECES, LINEAR_SYSTEMS)
    assert set().union(*kinds) == set(OPS)
    assert sum(map(len, kinds)) == len(OPS)


def test_an_operation_without_a_row_is_reported() -> None:
    with pytest.raises(InputError, match="no reach"):
        reach_of("add", [1.0, 2.0], 10)


@pytest.mark.sparse(9)
@pytest.mark.parametrize("op", NAMES)
def test_bounds_hold_on_discs(op: str) -> None:
    draw = random.Random(op)
    for _ in range(12):
        args = point(op, draw)
        radius = distance(op, args)
        d = draw.uniform(0, 0.98) * min(radius, 4.0)
        bound = bound_of(op, args, d)
        assert math.isfinite(bound), (args, d)
        for _ in range(6):
            turn, share = draw.uniform(0, 2 * math.pi), draw.choice((0.0, 0.5, 1.0))
            for size in (d, 0.5 * d):
                at = moved(op, args, size, turn, share)
                assert abs(value(op, at)) <= bound * (1 + 1e-9), (args, d, at)


@pytest.mark.parametrize("op", NAMES)
def test_bounds_are_infinite_where_a_singularity_lies_on_the_disc(op: str) -> None:
    draw = random.Random(op)
    args = [point(op, draw) for _ in range(8)]
    singular = [a for a in args if math.isfinite(distance(op, a))]
    for a in singular:
        assert bound_of(op, a, distance(op, a) * draw.uniform(1.001, 3.0)) == math.inf
    entire = {"exp", "expm1", "sin", "cos", "sinh", "cosh", "erf", "erfc", "besselj", "stumpff"}
    assert bool(singular) == (op not in entire)


@cache
def series(op: str) -> Program:
    """Return the coefficients of an operation at the time, by the rules of method taylor."""
    b = Builder()
    args = {"div": [b.const(1), b.leaf("time")], "pow": [b.leaf("time"), b.leaf("parameter", 0)]}
    value = b.add(op, *args.get(op, [b.leaf("time")]))
    return unrolled(prepare(b.program({"rates": [value]}), "rates"), "rates", TERMS)


WITH_SERIES = [op for op in NAMES if op not in {"hypot", "atan2", "besselj", "bessely", "stumpff"}]


@pytest.mark.sparse(7)
@pytest.mark.parametrize("op", WITH_SERIES)
def test_what_is_cut_off_within_the_reach_is_seen(op: str) -> None:
    """Against coefficients with 100 digits, from -25 to 25: also where values are as small as exp(-50)."""
    draw = random.Random(op)
    for k in range(6):
        args = point(op, draw)
        if op not in INTERVALS and op not in {"pow", "div", "erf", "erfc"} and k % 2:
            args = [6.0 * args[0]]
        at = Point(t=args[-1] if op == "div" else args[0], p=[args[-1]])
        if op == "div":
            args[0] = 1.0
        jet = interpret_exactly(series(op), at, 100)[JET]
        sizes = [abs(float(c)) * (n + 1) for n, c in enumerate(jet)]
        for order in ORDERS:
            d = reach_of(op, args, order)
            if d > 1e100:
                assert sum(sizes[order:]) == 0
                continue
            terms = [s * d**n for n, s in enumerate(sizes)]
            seen = max(terms[order - 2 : order])
            assert sum(terms[order:]) <= HONEST * seen, (args, order)


@pytest.mark.parametrize("op", [op for op in NAMES if ROWS[op].quiet])
def test_functions_are_flat_where_they_are_quiet(op: str) -> None:
    draw, depth, tried = random.Random(op), 12.0, 0
    while tried < 8:
        x = draw.uniform(-40, 40) * (1 if op != "pow" else 0.01)
        args = [x, 9.0] if op == "pow" else [x]
        d = quiet_of(op, args, depth)
        assert d is not None
        if d <= 0:
            continue
        tried += 1
        limit = {"expm1": -1.0, "tanh": math.copysign(1, x), "erf": math.copysign(1, x),
                 "erfc": 1 - math.copysign(1, x)}.get(op, 0.0)  # fmt: skip
        for turn in range(8):
            at = moved(op, args, d, turn * math.pi / 4, 1.0)
            assert abs(value(op, at) - limit) <= math.exp(-depth) * (1 + 1e-6), (x, d, turn)
