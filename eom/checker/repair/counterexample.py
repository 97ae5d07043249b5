"""Small numbers for which a wrong line fails, so that it can be checked by hand.

A world is made from a list of whole numbers. The list is drawn small, then as many numbers as possible
become zero while the line still fails and no quantity that is shown vanishes, by halves, quarters and so
on (as a failing test is made small; Zeller and Hildebrandt, 2002). That is done modulo a prime; the
numbers that are shown are exact. If they become large, quantities may vanish.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from eom.checker.judge.judge import MENTIONS, contexts, labels_in, needed_names
from eom.checker.mean.claims import CONSTANT
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
from eom.checker.repair.candidates import Candidate, Workshop
from eom.checker.repair.lines import Member, Place, valued
from eom.checker.repair.palette import symbols
from eom.checker.repair.remainder import pair
from eom.checker.report.findings import Counterexample
from eom.errors import InputError
from eom.exact.series import Series
from eom.fields import PRIME, Field, Singular
from eom.terms.terms import Term, add, mul, number, zero
from eom.worlds.evaluate import Evaluator
from eom.worlds.generators import built
from eom.worlds.shapes import Draw
from eom.worlds.special import telling
from eom.worlds.worlds import World, closure

STARTS = 3
TESTS = 32
"""Worlds that are built at most to make one small."""
FULL, SPARSE = (0, 1, 1, 2, 3), (0, 0, 1, 1, 2, 3)
"""Numbers that worlds are drawn from: where nothing shown should vanish, and where it may."""
SIMPLE = 2  # digits that need not be fewer
LARGEST = 10_000
"""Numerators and denominators that are shown at most."""
ROTOR = "k"  # numbers rotors; all other indices number masses
SHOWN = 24
"""Symbols whose values are shown at most."""
HEAD = 60
"""Characters of a member that is written out before its value at most."""


@dataclass(frozen=True)
class Chosen(Field):
    """A field whose random numbers are those of a list, then more that are small and not negative."""

    choices: list[int] = field(default_factory=list, compare=False)
    place: list[int] = field(default_factory=lambda: [0], compare=False)
    more: random.Random | None = field(default=None, compare=False)
    drawn: tuple[int, ...] = field(default=SPARSE, compare=False)

    def draw(self, generator: random.Random) -> Any:  # noqa: ARG002 - the list decides
        """Return the next number of the list."""
        k = self.place[0]
        self.place[0] += 1
        if k == len(self.choices):
            self.choices.append(self.more.choice(self.drawn) if self.more else 1)
        value = self.choices[k]
        return value if self.prime else Fraction(value)


def counterexample(
    shop: Workshop, candidate: Candidate | None, place: Place
) -> Counterexample | None:
    """Return small numbers under the assumptions of ``place`` for which a line fails, or None."""
    members = pair(shop, candidate)
    if members is None:
        return None
    terms = terms_of(shop, members)
    if terms is None:
        return None
    shown = shown_nodes(shop, members, candidate)
    return _least(_Telling(shop, members, shown, terms, place.names))


def failing(
    shop: Workshop, members: tuple[Member, Member], given: tuple[str, ...]
) -> Counterexample | None:
    """Return small numbers at which two members differ that never do as is claimed, or None."""
    terms = terms_of(shop, members)
    if terms is None:
        return None
    shown = shown_nodes(shop, members, None)
    for context in contexts([*terms, *shop.line.elaborator.scalars.values()]):
        try:
            names = closure([*given, *context])
        except InputError:
            continue
        found = _least(_Telling(shop, members, shown, terms, names))
        if found is not None:
            return found
    return None


def _least(told: _Telling) -> Counterexample | None:
    """Return the simplest numbers that were found: of special motions, else of worlds that are drawn."""
    least = _special(told)
    if least is not None and rank_of(least) <= GOOD:
        return least
    tried = _Tried(told.names, told.shop.line.elaborator.scalars, told.terms)
    for watched, drawn in ((tuple(v.term for _, v in told.shown), FULL), ((), SPARSE)):
        tried = replace(tried, watched=watched, drawn=drawn, tests=0)
        for start in range(STARTS):
            choices = tried.first(start)
            found = choices and _drawn(told, tried, tried.small(choices))
            if found and _digits(found) <= SIMPLE:
                return found
            if found and (least is None or rank_of(found) < rank_of(least)):
                least = found
    return least


def _special(told: _Telling) -> Counterexample | None:
    """Return the simplest of the special motions in small numbers for which a line fails.

    They are known before, so that they take less time than worlds that are drawn.
    """
    labels = labels_in([*told.terms, *told.shop.line.elaborator.scalars.values()])
    names = frozenset(n for n in told.names if n not in MENTIONS or MENTIONS[n] & labels)
    least: Counterexample | None = None
    for special in telling(names):
        found = told.told(special.world)
        if found is not None and (least is None or rank_of(found) < rank_of(least)):
            least = found
        if least is not None and rank_of(least) <= BEST:
            break
    return least


def _drawn(told: _Telling, tried: _Tried, choices: list[int]) -> Counterexample | None:
    try:
        return told.told(tried.world(list(choices), 0))
    except (InputError, Singular, ArithmeticError, KeyError):
        return None


_Rank = tuple[bool, int, int]


def rank_of(found: Counterexample) -> _Rank:
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


def terms_of(shop: Workshop, members: tuple[Member, Member]) -> tuple[Term, Term] | None:
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
    parts: list[Term] = [member.value.term] if member.value is not None else []
    for addend in member.addends:
        value = shop.values.get(addend)
        if value is None:
            return None
        if not value.is_zero:
            parts.append(value.term if addend.sign > 0 else mul(number(-1), value.term))
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
        """Tell whether the terms differ at t = 0 in the world of a list."""
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
    return [s.coefficients[0] for s in _flat(evaluator.value(term, env))]


def _flat(value: Any) -> list[Series]:
    return [value] if isinstance(value, Series) else [s for part in value for s in _flat(part)]


# -- what is shown -------------------------------------------------------------------------------


Shown = tuple[Node, Value]


@dataclass(frozen=True)
class _Telling:
    """Two members of a line that disagree, and what is shown of a world where they do."""

    shop: Workshop
    members: tuple[Member, Member]
    shown: Sequence[Shown]
    terms: tuple[Term, Term]
    names: frozenset[str]

    def told(self, world: World) -> Counterexample | None:
        """Return the numbers of a world, None where some are large or have no value."""
        try:
            evaluator = Evaluator(world, self.shop.line.elaborator.scalars)
            sides = [_numbers(evaluator, t) for t in self.terms]
            if sides[0] == sides[1]:
                return None
            values = [*_masses(self.shop, self.members, evaluator)]
            values += list(self._values(evaluator))
        except (InputError, Singular, ArithmeticError, KeyError):
            return None
        if any(too_large(t) for t in (*sides, *(v for _, v in values))):
            return None
        heads = [head_of(self.shop, m) for m in self.members]
        pairs = tuple(zip(heads, sides, strict=True))
        return Counterexample(tuple(dict(values).items()), pairs, needed_names(self.names))

    def _values(self, evaluator: Evaluator) -> Iterator[tuple[str, str]]:
        """Yield what is shown with its value; roots have none in a world."""
        for node, value in self.shown:
            with suppress(InputError):
                yield latex(node), _numbers(evaluator, value.term)


def head_of(shop: Workshop, member: Member) -> str:
    """Return a member as it stands; a long one, and one that stands elsewhere, by its side."""
    text = latex(at(shop.line.tree, member.path)) if member.path is not None else ""
    if shop.line.claim.kind == CONSTANT:
        return rf"\frac{{\mathrm{{d}}}}{{\mathrm{{d}} t}} \left( {text} \right)" if text else "0"
    first = member is shop.line.members[0]
    side = "left side" if first else "right side"
    if len(shop.line.members) > 2 and not first:
        side = f"member {member.number + 1}"
    return text if 0 < len(text) <= HEAD else rf"\text{{{side}}}"


def _masses(
    shop: Workshop, members: tuple[Member, Member], evaluator: Evaluator
) -> Iterator[tuple[str, str]]:
    roots = [at(shop.line.tree, m.path) for m in members if m.path is not None]
    if any(isinstance(n, Integral) for r in roots for n in walk(r)):
        masses = [fraction(m.coefficients[0]) for m in evaluator.world.masses]
        yield latex(Differential(Symbol("m"))), ", ".join(m for m in masses if m != "0")


def shown_nodes(
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


def _numbers(evaluator: Evaluator, term: Term) -> str:
    """Return a value at t = 0: a number, a row of components, rows of a matrix.

    One for each mass where it depends on one; those without mass are left out.
    """
    found: list[str] = []
    for env in evaluator.numberings(evaluator.labels(term)):
        masses = evaluator.world.masses
        kept = (masses[n] for i, n in env.items() if i != ROTOR and n < len(masses))
        if all(mass.coefficients[0] != 0 for mass in kept):
            found.append(_written(evaluator.value(term, env)))
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


def too_large(text: str) -> bool:
    """Tell whether a text shows a number that is no fun by hand."""
    digits = "".join(c if c.isdigit() else " " for c in text).split()
    return any(int(d) > LARGEST for d in digits)
