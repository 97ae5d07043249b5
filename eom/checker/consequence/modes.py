"""Frequencies: numbers by which the solutions of linear equations of motion go.

Letters whose rules are linear in them, with constants before them, make a linear system, and others one
for small motions about a state of rest; a letter that is one of its eigenvalues s, or i s, s^2 or the
period of it, whatever the constants are, is that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from eom.checker.consequence.jets import CHANGES, MAY, STAYS, Equal, Expr, jet, letter
from eom.checker.consequence.rules import MP, POINTS, Number, Point, Rules, agrees, points, size
from eom.errors import InputError

MAX_STATES, MAX_SIZE = 8, 300
"""States of a system, and parts of a rate that is not linear."""
TINY = MP.mpf(10) ** -20
FORMS: Mapping[str, Callable[[Number], Number]] = {
    "frequency": lambda s: abs(MP.im(s)) if abs(MP.re(s)) < TINY else MP.mpc(0, 1) * s,
    "square of a frequency": lambda s: -s * s,
    "exponent": lambda s: s,
    "period": lambda s: 2 * MP.pi / abs(MP.im(s)),
}
SMALL = "{} of small motions"
RESTS = (("_0", STAYS), ("_e", MAY), ("_star", MAY))
"""Labels, with kinds, of letters for what an angle is where it rests."""


@dataclass(frozen=True)
class Linear:
    """A linear system: how fast its states change with each of them, and the formulas of its rules.

    ``rest``: what vanishes where it is one of small motions about a state of rest, None where it is linear.
    """

    matrix: sp.Matrix
    sources: frozenset[int]
    rest: tuple[Expr, ...] | None = None


def systems(rules: Rules) -> list[Linear]:
    """Return the linear systems with constant coefficients that rules make."""
    if "systems" not in rules.kept:
        rules.kept["systems"] = _systems(rules)
    known: list[Linear] = rules.kept["systems"]
    return known


def _systems(rules: Rules) -> list[Linear]:
    moving = [name for name, rule in rules.known.items() if rule.order]
    done: set[frozenset[str]] = set()
    found = []
    for name in moving:
        try:
            names = _closed(rules, name)
            if names and names not in done:
                found += list(_linear(rules, sorted(names)))
        except InputError:
            continue
        done.add(names)
    return found


def _closed(rules: Rules, name: str) -> frozenset[str]:
    """Return the letters that change with one another; none where some of them change by themselves."""
    todo, names = [name], frozenset({name})
    while todo:
        one = todo.pop()
        value, _ = rules.normal(jet(one, rules.known[one].order))
        known = filter(None, map(letter, value.free_symbols))
        more = {k.name for k in known if k.kind == CHANGES}
        if any(n not in rules.known or not rules.known[n].order for n in more):
            return frozenset()
        todo += sorted(more - names)
        names |= more
    return names


def _linear(rules: Rules, names: Sequence[str]) -> Iterator[Linear]:
    orders = [rules.known[n].order for n in names]
    states = [jet(n, k) for n, order in zip(names, orders, strict=True) for k in range(order)]
    if len(states) > MAX_STATES:
        return
    rows, used = [], frozenset[int]()
    for n, order in zip(names, orders, strict=True):
        rows += [[sp.Integer(s == jet(n, k + 1)) for s in states] for k in range(order - 1)]
        value, sources = rules.normal(jet(n, order))
        rows.append([value.diff(s) for s in states])
        used |= sources
    matrix = sp.Matrix(rows)
    if not matrix.free_symbols & set(states):
        yield Linear(matrix, used)
        return
    values = [rules.normal(jet(n, order))[0] for n, order in zip(names, orders, strict=True)]
    if any(size(v, MAX_SIZE) > MAX_SIZE for v in values):
        return
    zero = dict.fromkeys(states, sp.S.Zero)
    for there in ({}, *({jet(n): jet(n + end, 0, kind) for n in names} for end, kind in RESTS)):
        at_rest = zero | there
        rest = tuple(v.xreplace(at_rest) for v in values)
        if sp.nan not in rest:
            yield Linear(matrix.xreplace(at_rest), used, rest)


def _eigenvalues(system: Linear, at: Point) -> list[Number]:
    """Return the eigenvalues at a point, a conjugate pair once, the slowest first."""
    n = system.matrix.rows
    values = MP.matrix(n, n)
    for i in range(n):
        for j in range(n):
            values[i, j] = at.of(system.matrix[i, j])
    found = MP.eig(values, left=False, right=False) if n > 1 else [values[0, 0]]
    upper = [s for s in found if MP.im(s) > -TINY and abs(s) > TINY]
    return sorted(upper, key=lambda s: (float(abs(s)), float(MP.re(s))))


@dataclass(frozen=True)
class Mode:
    """What a letter is of a linear system, with points at which it is that."""

    form: str
    points: tuple[Point, ...]
    sources: frozenset[int]


def modes(rules: Rules, unknown: Expr) -> Iterator[Mode]:
    """Yield what a letter without a rule may be of the linear systems that rules make."""
    at = points(rules)
    for system in systems(rules) if len(at) == POINTS else ():
        try:
            if any(abs(p.of(v)) > TINY for p in at for v in system.rest or ()):
                continue
            spectra = [_eigenvalues(system, p) for p in at]
        except (InputError, ZeroDivisionError, ValueError):
            continue
        for k in range(min(map(len, spectra))):
            for form, of in FORMS.items():
                try:
                    values = [of(s[k]) for s in spectra]
                except ZeroDivisionError:
                    continue
                told = form if system.rest is None else SMALL.format(form)
                yield Mode(told, _put_in(at, unknown, values), system.sources)


def _put_in(at: Sequence[Point], unknown: Expr, values: Sequence[Number]) -> tuple[Point, ...]:
    return tuple(Point(p.rules, p.seed, {unknown: v}) for p, v in zip(at, values, strict=True))


def mode(q: Equal, rules: Rules, unknown: Expr) -> Mode | None:
    """Return what an equation says that a letter is of a linear system; None where it is nothing of it."""
    if agrees(q, points(rules)):
        return None
    return next((m for m in modes(rules, unknown) if agrees(q, m.points)), None)
