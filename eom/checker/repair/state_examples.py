"""A state and parameters in small numbers at which a line about a system fails.

Parameters and states are drawn small; moments of inertia are 2, 3, 4, so that there is such a body; an
angle below a sine or cosine has the sine 3/5, 4/5, ... All else follows exactly from the equations of
the system, so that both sides can be computed by hand.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import sympy as sp

from eom.checker.judge.systems import given_in, written
from eom.checker.mean.model import Model
from eom.errors import InputError
from eom.exact.rings import summands
from eom.fields import sum_of_angles
from eom.system import Expr, System
from eom.terms.terms import Term
from eom.worlds.numerals import without_rates
from eom.worlds.solutions import Restriction, rate

DRAWS = 24
"""States that are tried at most."""
MOMENTS = (2, 3, 4)
_MOMENT = re.compile(r"[IJ]_?([1-3])\1?")
SMALL = (1, 2, 3)
STATES = (1, 2, -1, 3, 1, -2)
TRIPLES = ((3, 4, 5), (4, 3, 5), (5, 12, 13), (8, 15, 17))
"""Sides of right-angled triangles: sines and cosines."""
UNITS = ((1, 1, 1, 1, 2), (1, 2, 2, 4, 5), (4, 2, 2, 1, 5), (2, 4, 1, 2, 5))
"""Quaternions of whole numbers, and their lengths."""
ROTATION = ((3, 4, 0), (-4, 3, 0), (0, 0, 5))
"""Five times a rotation matrix."""
TRIG = (sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc)
MAX_SIZE = 4000
"""Operations of an expression that is evaluated at most."""


@dataclass
class StatePoint:
    """Exact numbers for the quantities of a system; ``sines``: sine and cosine of half of each angle."""

    model: Model
    scalars: Mapping[Any, Term]
    numbers: Mapping[Expr, Expr]
    halves: Mapping[Expr, tuple[Expr, Expr]]
    known: dict[Expr, Expr] = field(default_factory=dict)

    def value(self, term: Term) -> Expr:
        """Return the number that a scalar is. Raises `InputError` where it has no rational one."""
        return self.number(written(term, self.scalars, self.model))

    def number(self, expression: Expr) -> Expr:
        """Return the number of an expression over the system's symbols, rates among them."""
        if expression not in self.known:
            self.known[expression] = self._number(self._plain(expression))
        return self.known[expression]

    def _number(self, plain: Expr) -> Expr:
        if plain.count_ops() > MAX_SIZE:
            raise InputError("too long to be evaluated")
        waves = {f: self._wave(f) for f in plain.atoms(*TRIG)}
        found = sp.nsimplify(plain.xreplace(waves).xreplace(dict(self.numbers)))
        if not found.is_Rational:
            raise InputError("this is no rational number here", got=found)
        return found

    def _plain(self, expression: Expr) -> Expr:
        """Return an expression without rates: written out, or those of an implicit system as numbers."""
        system = self.model.system
        if system.mass_matrix is None:
            return without_rates(system, expression)
        return _implicit(system, expression, self._rates)

    @cached_property
    def _rates(self) -> dict[Expr, Expr]:
        """Rates of the states of a system with a mass matrix."""
        system = self.model.system
        matrix = system.mass_matrix.applyfunc(lambda e: self._number(system.expand(e)))  # type: ignore[union-attr]
        right = sp.Matrix([self._number(system.expand(r)) for r in system.rates])
        if matrix.det() == 0:
            raise InputError("the mass matrix is singular here")
        return dict(zip((q.symbol for q in system.states), matrix.LUsolve(right), strict=True))

    def _wave(self, function: Expr) -> Expr:
        """Return sine, cosine or tangent of a sum of angles."""
        turns = []
        for base, count in summands(function.args[0]):
            twice = 2 * count
            if base not in self.halves or not twice.is_Integer or abs(twice) > 12:
                raise InputError("a function of what is no sum of angles", got=function)
            turns.append((*self.halves[base][::-1], int(twice)))
        cosine, sine = sum_of_angles(turns)
        return _FUNCTIONS[type(function)](sine, cosine)


def _over(a: Expr, b: Expr) -> Expr:
    if b == 0:
        raise InputError("undefined here")
    return sp.simplify(a / b)


_FUNCTIONS: dict[Any, Any] = {
    sp.sin: lambda s, _: s,
    sp.cos: lambda _, c: c,
    sp.tan: _over,
    sp.cot: lambda s, c: _over(c, s),
    sp.sec: lambda _, c: _over(sp.Integer(1), c),
    sp.csc: lambda s, _: _over(sp.Integer(1), s),
}


def _implicit(system: System, expression: Expr, rates: Mapping[Expr, Expr]) -> Expr:
    """Replace first derivatives by the chain rule with numbers for the rates of the states."""
    if isinstance(expression, rate):
        inner = system.expand(expression.args[0])
        if inner.has(rate):
            raise InputError("a second derivative of a system with a mass matrix")
        terms = [inner.diff(s) * r for s, r in rates.items() if inner.has(s)]
        return sp.Add(*terms, inner.diff(system.time))
    if not expression.args:
        return system.expand(expression)
    return expression.func(*(_implicit(system, a, rates) for a in expression.args))


# -- drawing -----------------------------------------------------------------------------------------


def points(model: Model, scalars: Mapping[Any, Term], names: Iterable[str]) -> Iterator[StatePoint]:
    """Yield states and parameters in small numbers that keep what is given, the simplest first."""
    given = given_in(model, names)
    angles = _angles(model.system)
    for number in range(DRAWS):
        numbers = _drawn(model, given, number)
        if numbers is None:
            return
        halves = dict(_halves(angles, numbers, number))
        plain = {s: n for s, n in numbers.items() if s not in halves or n == 0}
        yield StatePoint(model, scalars, plain, halves)


def _angles(system: System) -> list[Expr]:
    """Return the symbols that stand below sines and cosines."""
    expressions = [*system.rates, *(d.expression for d in (*system.definitions, *system.outputs))]
    expressions += list(system.mass_matrix) if system.mass_matrix is not None else []
    found = {s for e in expressions for f in e.atoms(*TRIG) for s in f.free_symbols}
    units = {q.symbol for q in system.states if q.unit == "rad"}
    return sorted(found | units, key=str)


def _halves(
    angles: list[Expr], numbers: Mapping[Expr, Expr], number: int
) -> Iterator[tuple[Expr, tuple[Expr, Expr]]]:
    """Yield sine and cosine of half of each angle, so that those of the angle are small fractions.

    From those of the angle, 3/5 and 4/5 say, the half has roots; they cancel where whole angles stand.
    """
    for k, angle in enumerate(angles):
        if numbers.get(angle) == 0:
            yield angle, (sp.Integer(0), sp.Integer(1))
            continue
        _, b, c = TRIPLES[(k + number) % len(TRIPLES)]
        cosine = sp.Rational(b, c)
        sine = sp.sqrt((1 - cosine) / 2)
        yield angle, (sine, sp.sqrt((1 + cosine) / 2))


def _drawn(model: Model, given: tuple[Restriction, ...], number: int) -> dict[Expr, Expr] | None:
    """Return numbers for parameters, inputs, states and time; None where a constraint is not known."""
    system, rng = model.system, random.Random(number)  # noqa: S311 - reproducible
    bodies = [q.symbol for q in system.parameters if _MOMENT.fullmatch(q.name)]
    rotors = [q.symbol for q in system.parameters if q.unit == "kg m^2" and q.symbol not in bodies]
    known = {*bodies, *rotors}
    others = [q.symbol for q in (*system.parameters, *system.inputs) if q.symbol not in known]
    rows = (bodies, MOMENTS), (others, SMALL), ([q.symbol for q in system.states], STATES)
    found: dict[Expr, Any] = {system.time: 1, **dict.fromkeys(rotors, 1)}
    for symbols, values in rows:
        for k, symbol in enumerate(symbols):
            found[symbol] = rng.choice(values) if number else values[k % len(values)]
    for assumption in system.assumptions:
        own = _on_constraint(system, assumption.vanish, number)
        if own is None:
            return None
        found |= own
    for r in given:
        found |= {b: found[a] for a, b in r.equal} | dict.fromkeys(r.zero, 0)
    return {s: sp.Rational(v) for s, v in found.items()}


def _on_constraint(system: System, vanish: Iterable[Expr], number: int) -> dict[Expr, Expr] | None:
    """Return states on what attitude coordinates must satisfy; nothing for a constraint of none."""
    used = set().union(*(e.free_symbols for e in vanish))
    ordered = [q.symbol for q in system.states if q.symbol in used]
    if not used or not used <= set(ordered):
        return {}
    *unit, length = UNITS[number % len(UNITS)]
    values = {
        4: [sp.Rational(u, length) for u in unit],
        9: [sp.Rational(e, 5) for row in ROTATION for e in row],
    }.get(len(ordered))
    return None if values is None else dict(zip(ordered, values, strict=True))
