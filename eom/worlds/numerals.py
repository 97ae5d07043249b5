"""Numbers for the quantities of a system, to many digits: what differs for certain.

The counterpart of `eom.worlds.solutions` for roots and inverse functions, whose branches no finite field
has.
"""

from __future__ import annotations

import random
from collections.abc import Iterable

import sympy as sp

from eom.system import Expr, System
from eom.worlds.solutions import INVERSES, Restriction, order, rate

DIGITS = 40
TRIALS = 4
MAX_ORDER = 2


def without_rates(system: System, expression: Expr) -> Expr:
    """Return an expression over states, parameters, inputs and time, rates written out.

    Raises `InputError` where the system has a mass matrix.
    """
    named = {d.symbol: d.expression for d in (*system.outputs, *system.invariants)}
    own = {q.symbol for q in (*system.states, *system.parameters, *system.inputs)}
    named = {s: e for s, e in named.items() if s not in own and s != e}

    def plain(e: Expr) -> Expr:
        if isinstance(e, rate):
            return system.rate_of(plain(e.args[0]))
        if not e.args:
            return system.expand(named.get(e, e))
        return e.func(*(plain(a) for a in e.args))

    return plain(expression)


def inexact(system: System, expression: Expr) -> bool:
    """Return whether an expression has roots or inverse functions when its names are written out."""
    todo, seen = [expression], set[Expr]()
    named = {d.symbol: d.expression for d in (*system.definitions, *system.outputs)}
    while todo:
        e = todo.pop()
        seen.add(e)
        powers = (p.as_base_exp()[1] for p in e.atoms(sp.Pow))
        if e.has(*INVERSES) or any(not p.is_Integer for p in powers):
            return True
        todo += [named[s] for s in e.free_symbols if s in named and named[s] not in seen]
    return False


def differs(
    system: System, left: Expr, right: Expr, restrictions: Iterable[Restriction] = ()
) -> bool:
    """Return whether two expressions differ for real numbers: certain if True.

    States near 1/2 and positive parameters are drawn; states of an attitude lie on what they must satisfy.
    """
    if system.mass_matrix is not None or max(order(left), order(right)) > MAX_ORDER:
        return False
    full = without_rates(system, left - right)
    size = sp.Add(*(abs(without_rates(system, m)) for m in (left, right)))
    equal = {b: a for r in restrictions for a, b in r.equal}
    zero = {s: sp.Integer(0) for r in restrictions for s in r.zero}
    for seed in range(TRIALS):
        point = real_point(system, seed) | zero
        point |= {b: point[a] for b, a in equal.items()}
        value, scale = (e.evalf(DIGITS, subs=point) for e in (full, size))
        if value.is_number and value.is_real and abs(value) > 10**-20 * (1 + scale):
            return True
    return False


def real_point(system: System, seed: int) -> dict[Expr, Expr]:
    """Return small rationals: positive parameters, states of both signs, unit quaternions."""
    generator = random.Random(seed)  # noqa: S311 - reproducible points, no secrets

    def drawn(lowest: int) -> Expr:
        return sp.Rational(generator.randint(lowest, 60), 61)

    point = {q.symbol: 1 + 2 * drawn(1) for q in (*system.parameters, *system.inputs)}
    point |= {q.symbol: drawn(5) * generator.choice((-1, 1)) for q in system.states}
    point[system.time] = drawn(1)
    for assumption in system.assumptions:
        used = set().union(*(e.free_symbols for e in assumption.vanish))
        ordered = [q.symbol for q in system.states if q.symbol in used]
        if used and len(ordered) == len(used) == 4:
            point |= zip(ordered, unit_quaternion([drawn(5) for _ in range(3)]), strict=True)
    return point


def unit_quaternion(gibbs: list[Expr]) -> tuple[Expr, ...]:
    """Return a rational unit quaternion."""
    square = sum(g**2 for g in gibbs)
    return ((1 - square) / (1 + square), *(2 * g / (1 + square) for g in gibbs))
