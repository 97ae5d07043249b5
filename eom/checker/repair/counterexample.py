"""Small numbers for which a wrong line fails, so that it can be checked by hand.

A world is made from a list of whole numbers. The list is drawn small, then as many numbers as possible
become zero while the line still fails and no quantity that is shown vanishes, by halves, quarters and so
on (as a failing test is made small; Zeller and Hildebrandt, 2002). That is done modulo a prime; the
numbers that are shown are exact. If they become large, quantities may vanish.

Of a line about a system a state and parameters are drawn small; moments of inertia are 2, 3, 4, so that
there is such a body; an angle below a sine or cosine has the sine 3/5, 4/5, ... All else follows exactly
from the equations of the system, so that both sides can be computed by hand.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, ClassVar, Protocol

import sympy as sp

from eom.checker.judge.models import Drawn
from eom.checker.judge.systems import Solutions
from eom.checker.judge.worlds import MENTIONS, contexts, labels_in
from eom.checker.mean.claims import CONSTANT
from eom.checker.mean.model import Model
from eom.checker.mean.values import Value
from eom.checker.read.paths import at
from eom.checker.read.syntax import (
    Call,
    Derivative,
    Differential,
    Integral,
    Node,
    Number,
    Scripts,
    Symbol,
    walk,
)
from eom.checker.read.writing import latex
from eom.checker.repair.candidates import Candidate, Workshop, pair
from eom.checker.repair.lines import Member, symbols, valued
from eom.checker.report.findings import Counterexample
from eom.errors import InputError
from eom.exact.rings import summands
from eom.exact.series import Series
from eom.fields import PRIME, Singular, sum_of_angles
from eom.system import Expr, System
from eom.terms.terms import Term, add, mul, number, zero
from eom.worlds.evaluate import Evaluator, flat
from eom.worlds.generators import built
from eom.worlds.shapes import Draw
from eom.worlds.small import FULL, SPARSE, Chosen
from eom.worlds.solutions import Restriction, rate, without_rates
from eom.worlds.special import revealing
from eom.worlds.worlds import World, closure

STARTS = 3
TESTS = 32
"""Worlds that are built at most to make one small."""
SIMPLE = 2  # digits that need not be fewer
LARGEST = 10_000
"""Numerators and denominators that are shown at most."""
ROTOR = "k"  # numbers rotors; all other indices number masses
SHOWN = 24
"""Symbols whose values are shown at most."""
HEAD = 60
"""Characters of a member that is written out before its value at most."""


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


class Small(Protocol):
    """A model in small exact numbers."""

    @property
    def masses(self) -> Sequence[str]:
        """Its masses as LaTeX, none for a state of a system."""

    def text(self, term: Term) -> str:
        """Return the LaTeX of a value at t = 0. Raises `InputError` and others where it has none."""


def counterexample(
    shop: Workshop, candidate: Candidate | None, model: Drawn
) -> Counterexample | None:
    """Return small numbers under the assumptions of ``model`` for which a line fails, or None."""
    members = pair(shop, candidate)
    terms = _terms(shop, members) if members is not None else None
    if members is None or terms is None:
        return None
    display = _Display(shop, members, _shown(shop, members, candidate), terms, model.names)
    models = shop.line.models()
    return (
        display.simplest(points(models, model.names))
        if isinstance(models, Solutions)
        else _least(display)
    )


def failing(
    shop: Workshop, members: tuple[Member, Member], given: tuple[str, ...]
) -> Counterexample | None:
    """Return small numbers at which two members differ that never do as is claimed, or None."""
    terms = _terms(shop, members)
    if terms is None:
        return None
    shown = _shown(shop, members, None)
    for context in contexts([*terms, *shop.line.elaborator.scalars.values()]):
        try:
            names = closure([*given, *context])
        except InputError:
            continue
        found = _least(_Display(shop, members, shown, terms, names))
        if found is not None:
            return found
    return None


def _least(display: _Display) -> Counterexample | None:
    """Return the simplest numbers that were found: of special motions, else of worlds that are drawn."""
    least = _special(display)
    if least is not None and _rank(least) <= GOOD:
        return least
    tried = _Tried(display.names, display.shop.line.elaborator.scalars, display.terms)
    for watched, drawn in ((tuple(v.term for _, v in display.shown), FULL), ((), SPARSE)):
        tried = replace(tried, watched=watched, drawn=drawn, tests=0)
        for start in range(STARTS):
            choices = tried.first(start)
            found = choices and _drawn(display, tried, tried.small(choices))
            if found and _digits(found) <= SIMPLE:
                return found
            if found and (least is None or _rank(found) < _rank(least)):
                least = found
    return least


def _special(display: _Display) -> Counterexample | None:
    """Return the simplest of the special motions in small numbers for which a line fails.

    They are known before, so that they take less time than worlds that are drawn.
    """
    scalars = display.shop.line.elaborator.scalars
    labels = labels_in([*display.terms, *scalars.values()])
    names = frozenset(n for n in display.names if n not in MENTIONS or MENTIONS[n] & labels)
    return display.simplest(_SmallWorld(Evaluator(s.world, scalars)) for s in revealing(names))


def _drawn(display: _Display, tried: _Tried, choices: list[int]) -> Counterexample | None:
    try:
        return display.example(_SmallWorld(Evaluator(tried.world(list(choices), 0), tried.scalars)))
    except _UNDEFINED:
        return None


_Rank = tuple[bool, int, int]


def _rank(found: Counterexample) -> _Rank:
    """Return whether something that is shown vanishes, the length of numbers, how many are fractions."""
    shown = [v for _, v in found.values]
    numbers = ([n for n in _NUMBER.findall(v) if int(n)] for v in shown)
    return not all(numbers), max(_digits(found), SIMPLE), sum(v.count("frac") for v in shown)


BEST: _Rank = (False, SIMPLE, 0)
GOOD: _Rank = (False, SIMPLE, 1_000)
"""What need not be made simpler, and what other worlds need not be drawn for."""


def _digits(found: Counterexample) -> int:
    """Return how many digits the longest number that is shown has."""
    texts = (v for _, v in (*found.values, *found.members))
    return max((len(d) for t in texts for d in _NUMBER.findall(t)), default=0)


_NUMBER = re.compile(r"\d+")


def _terms(shop: Workshop, members: tuple[Member, Member]) -> tuple[Term, Term] | None:
    """Return two members as terms that can be compared, None where a part of them has no value."""
    left, right = (_term(shop, m) for m in members)
    if left is None and right is not None and shop.is_zero(members[0]):
        left = zero(right.kind)
    if right is None and left is not None and shop.is_zero(members[1]):
        right = zero(left.kind)
    if left is None or right is None or left.kind != right.kind:
        return None
    return left, right


def _term(shop: Workshop, member: Member) -> Term | None:
    """Return a member as a term, None where a part of it has no value."""
    parts: list[Term] = []
    for sign, value in shop.parts(member):
        if value is None:
            return None
        if not value.is_zero or value is member.value:
            parts.append(value.term if sign > 0 else mul(number(-1), value.term))
    try:
        return add(*parts) if parts else None
    except InputError:
        return None


@dataclass
class _Tried:
    """Worlds from lists of numbers, in which two terms should differ; ``watched`` should not vanish."""

    names: frozenset[str]
    scalars: dict[Any, Term]
    terms: tuple[Term, Term]
    watched: tuple[Term, ...] = ()
    drawn: tuple[int, ...] = SPARSE
    tests: int = 0

    def world(self, choices: list[int], prime: int, start: int = -1) -> World:
        """Return the world of a list; it grows by what more is needed. Raises `Singular`."""
        more = random.Random(f"small {start}") if start >= 0 else None  # noqa: S311
        chosen = Chosen(prime, choices, more=more, drawn=self.drawn)
        generator = random.Random(f"{sorted(self.names)}")  # noqa: S311 - reproducible
        return built(self.names, Draw(chosen, generator, 0))

    def fails(self, choices: list[int], start: int = -1) -> bool:
        """Return whether the terms differ at t = 0 in the world of a list."""
        self.tests += 1
        try:
            evaluator = Evaluator(self.world(choices, PRIME, start), self.scalars)
            values = [_first(evaluator, t) for t in self.terms]
            if values[0] == values[1]:
                return False
            if start >= 0:
                self.watched = tuple(t for t in self.watched if any(_first(evaluator, t)))
            return all(any(_first(evaluator, t)) for t in self.watched)
        except (InputError, Singular, ArithmeticError, KeyError):
            return False

    def first(self, start: int) -> list[int] | None:
        """Return a list of small numbers for which the terms differ, or None."""
        choices: list[int] = []
        return choices if self.fails(choices, start) else None

    def small(self, choices: list[int]) -> list[int]:
        """Return the list with as many zeros as a number of tests allows."""
        size = len(choices) // 2
        while size and self.tests < TESTS:
            for begin in range(0, len(choices), size):
                block = choices[begin : begin + size]
                if any(block) and self.tests < TESTS:
                    fewer = [*choices[:begin], *[0] * len(block), *choices[begin + size :]]
                    if self.fails(list(fewer)):
                        choices = fewer
            size //= 2
        return choices


def _first(evaluator: Evaluator, term: Term) -> list[Any]:
    """Return the components at t = 0 for the first numbering of the free indices."""
    env = next(evaluator.numberings(evaluator.labels(term)))
    return [s.coefficients[0] for s in flat(evaluator.value(term, env))]


# -- what is shown -------------------------------------------------------------------------------


Shown = tuple[Node, Value]


@dataclass(frozen=True)
class _Display:
    """Two members of a line that disagree, and what is shown of a model where they do."""

    shop: Workshop
    members: tuple[Member, Member]
    shown: Sequence[Shown]
    terms: tuple[Term, Term]
    names: frozenset[str]

    def example(self, model: Small) -> Counterexample | None:
        """Return the numbers of a model, None where some are large or have no value."""
        try:
            sides = [model.text(t) for t in self.terms]
            if sides[0] == sides[1]:
                return None
            values = dict([*self._masses(model), *self._values(model)])
        except _UNDEFINED:
            return None
        if any(_too_large(t) for t in (*sides, *values.values())):
            return None
        heads = [_head(self.shop, m) for m in self.members]
        names = self.shop.line.models().shown(self.names)
        return Counterexample(tuple(values.items()), tuple(zip(heads, sides, strict=True)), names)

    def simplest(self, models: Iterable[Small]) -> Counterexample | None:
        """Return the simplest numbers of some models in which the line fails, None for none."""
        least: Counterexample | None = None
        for found in filter(None, map(self.example, models)):
            least = found if least is None else min(least, found, key=_rank)
            if _rank(least) <= BEST:
                break
        return least

    def _values(self, model: Small) -> Iterator[tuple[str, str]]:
        """Yield what is shown with its value; roots have none in a world."""
        for node, value in self.shown:
            with suppress(InputError):
                yield latex(node), model.text(value.term)

    def _masses(self, model: Small) -> Iterator[tuple[str, str]]:
        tree, masses = self.shop.line.tree, model.masses
        roots = [at(tree, m.path) for m in self.members if m.path is not None]
        if masses and any(isinstance(n, Integral) for r in roots for n in walk(r)):
            yield latex(Differential(Symbol("m"))), ", ".join(m for m in masses if m != "0")


_UNDEFINED = (InputError, Singular, ArithmeticError, KeyError)


def _head(shop: Workshop, member: Member) -> str:
    """Return a member as it stands; a long one, and one that stands elsewhere, by its side."""
    text = latex(at(shop.line.tree, member.path)) if member.path is not None else ""
    if shop.line.claim.kind == CONSTANT:
        return rf"\frac{{\mathrm{{d}}}}{{\mathrm{{d}} t}} \left( {text} \right)" if text else "0"
    first = member is shop.line.members[0]
    side = "left side" if first else "right side"
    if len(shop.line.members) > 2 and not first:
        side = f"member {member.number + 1}"
    return text if 0 < len(text) <= HEAD else rf"\text{{{side}}}"


def _shown(
    shop: Workshop, members: tuple[Member, Member], candidate: Candidate | None
) -> list[Shown]:
    """Return what enters: symbols and functions of the members, and of what would make them right."""
    roots = [at(shop.line.tree, m.path) for m in members if m.path is not None]
    roots += [o.node for o in candidate.options] if candidate is not None else []
    found: list[Shown] = []
    for node in list(dict.fromkeys(n for r in roots for n in _quantities(r)))[:SHOWN]:
        value = valued(shop.line.elaborator, node)
        if value is not None and not value.is_zero and node not in roots:
            found.append((node, value))
    return found


def _quantities(root: Node) -> Iterator[Node]:
    """Yield the symbols of a tree without exponents, functions of angles, and derivatives."""
    calls = [n for n in walk(root) if isinstance(n, Call)]
    inside = {n for c in calls for n in symbols(c)}
    outside = Counter(symbols(root)) - Counter(n for c in calls for n in symbols(c))
    yield from (base_of(n) for n in symbols(root) if n not in inside or outside[n] > 0)
    yield from (n for n in walk(root) if isinstance(n, Derivative) and n.operand is not None)
    yield from (replace(c, sup=None) for c in calls)


def base_of(node: Node) -> Node:
    """Return a symbol without an exponent."""
    if not isinstance(node, Scripts) or not isinstance(node.sup, Number):
        return node
    bare = replace(node, sup=None)
    return bare.base if bare.sub is bare.presub is bare.presup is None else bare


@dataclass
class _SmallWorld:
    """A world with rational numbers."""

    evaluator: Evaluator

    @property
    def masses(self) -> list[str]:
        """The numbers of its masses."""
        return [fraction(m.coefficients[0]) for m in self.evaluator.world.masses]

    def text(self, term: Term) -> str:
        """Return a value at t = 0: a number, a row of components, rows of a matrix.

        One for each mass where it depends on one; those without mass are left out.
        """
        found: list[str] = []
        masses = self.evaluator.world.masses
        for env in self.evaluator.numberings(self.evaluator.labels(term)):
            kept = (masses[n] for i, n in env.items() if i != ROTOR and n < len(masses))
            if all(mass.coefficients[0] != 0 for mass in kept):
                found.append(_written(self.evaluator.value(term, env)))
        return ", ".join(found[:1] if len(set(found)) == 1 else found)


def _written(value: Any) -> str:
    if isinstance(value, Series):
        return fraction(value.coefficients[0])
    if isinstance(value[0], Series):
        return "(" + ", ".join(_written(v) for v in value) + ")"
    rows = " \\\\ ".join(" & ".join(_written(v) for v in row) for row in value)
    return f"\\begin{{bmatrix}} {rows} \\end{{bmatrix}}"


def fraction(value: Any) -> str:
    """Return the LaTeX of a fraction."""
    exact = Fraction(value)
    sign = "-" if exact < 0 else ""
    if exact.denominator == 1:
        return str(exact.numerator)
    return f"{sign}\\frac{{{abs(exact.numerator)}}}{{{exact.denominator}}}"


def _too_large(text: str) -> bool:
    """Return whether a text shows a number that is no fun by hand."""
    digits = "".join(c if c.isdigit() else " " for c in text).split()
    return any(int(d) > LARGEST for d in digits)


# -- states of a system --------------------------------------------------------------------------


@dataclass
class StatePoint:
    """Exact numbers for the quantities of a system; ``sines``: sine and cosine of half of each angle."""

    models: Solutions
    numbers: Mapping[Expr, Expr]
    halves: Mapping[Expr, tuple[Expr, Expr]]
    known: dict[Expr, Expr] = field(default_factory=dict)

    masses: ClassVar[Sequence[str]] = ()

    def text(self, term: Term) -> str:
        """Return the number that a scalar is. Raises `InputError` where it has no rational one."""
        return fraction(self.number(self.models.written(term)))

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
        system = self.models.model.system
        if system.mass_matrix is None:
            return without_rates(system, expression)
        return _implicit(system, expression, self._rates)

    @cached_property
    def _rates(self) -> dict[Expr, Expr]:
        """Rates of the states of a system with a mass matrix."""
        system = self.models.model.system
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


def points(models: Solutions, names: Iterable[str]) -> Iterator[StatePoint]:
    """Yield states and parameters in small numbers that keep what is given, the simplest first."""
    model = models.model
    given, angles = models.kept(names), _angles(model.system)
    for draw in range(DRAWS):
        numbers = _drawn_state(model, given, draw)
        if numbers is None:
            return
        halves = dict(_halves(angles, numbers, draw))
        plain = {s: n for s, n in numbers.items() if s not in halves or n == 0}
        yield StatePoint(models, plain, halves)


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


def _drawn_state(
    model: Model, given: tuple[Restriction, ...], number: int
) -> dict[Expr, Expr] | None:
    """Return numbers for parameters, inputs, states and time; None where a constraint is not known."""
    system, rng = model.system, random.Random(number)  # noqa: S311 - reproducible
    bodies = [q.symbol for q in system.parameters if _MOMENT.fullmatch(q.name)]
    rotors = [q.symbol for q in system.parameters if q.unit == "kg m^2" and q.symbol not in bodies]
    known = {*bodies, *rotors}
    others = [q.symbol for q in (*system.parameters, *system.inputs) if q.symbol not in known]
    rows = (bodies, MOMENTS), (others, SMALL), ([q.symbol for q in system.states], STATES)
    found: dict[Expr, Any] = {system.time: 1, **dict.fromkeys(rotors, 1)}
    for row, values in rows:
        for k, symbol in enumerate(row):
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
