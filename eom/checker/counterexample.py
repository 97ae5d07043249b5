"""Small numbers for which a wrong line fails, so that it can be checked by hand.

A world is made from a list of whole numbers. The list is drawn small, then as many numbers as possible
become zero while the line still fails, by halves, quarters and so on (as a failing test is made small;
Zeller and Hildebrandt, 2002). That is done modulo a prime; the numbers that are shown are exact.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from eom.checker.candidates import Candidate, Workshop
from eom.checker.explanation import Counterexample
from eom.checker.lines import Member, Place, valued
from eom.checker.palette import symbols
from eom.checker.paths import at
from eom.checker.remainder import pair
from eom.checker.syntax import Derivative, Differential, Integral, Node, Symbol
from eom.checker.trees import walk
from eom.checker.writing import latex
from eom.errors import InputError
from eom.evaluate import Evaluator
from eom.generators import built
from eom.series import PRIME, Field, Series, Singular
from eom.shapes import Draw
from eom.terms import Term, add, mul, number
from eom.worlds import World

STARTS = 4
TESTS = 36
"""Worlds that are built at most to make one small."""
LARGEST = 10_000
"""Numerators and denominators that are shown at most."""
SHOWN = 24
"""Symbols whose values are shown at most."""


@dataclass(frozen=True)
class Chosen(Field):
    """A field whose random numbers are those of a list, then more that are small and not negative."""

    choices: list[int] = field(default_factory=list, compare=False)
    place: list[int] = field(default_factory=lambda: [0], compare=False)
    more: random.Random | None = field(default=None, compare=False)

    def draw(self, generator: random.Random) -> Any:  # noqa: ARG002 - the list decides
        """Return the next number of the list."""
        k = self.place[0]
        self.place[0] += 1
        if k == len(self.choices):
            self.choices.append(self.more.choice((0, 0, 1, 1, 2, 3)) if self.more else 1)
        value = self.choices[k]
        return value if self.prime else Fraction(value)


def counterexample(
    shop: Workshop, candidate: Candidate | None, place: Place
) -> Counterexample | None:
    """Return small numbers under the assumptions of ``place`` for which a line fails, or None."""
    members = pair(shop, candidate)
    if members is None:
        return None
    terms = [_term(shop, m) for m in members]
    if terms[0] is None or terms[1] is None or terms[0].kind != terms[1].kind:
        return None
    tried = _Tried(place.names, shop.line.elaborator.scalars, (terms[0], terms[1]))
    for start in range(STARTS):
        choices = tried.first(start)
        if choices is not None:
            return _shown(shop, members, tried, tried.small(choices))
    return None


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
    """Worlds from lists of numbers, in which two terms should differ."""

    names: frozenset[str]
    scalars: dict[Any, Term]
    terms: tuple[Term, Term]
    tests: int = 0

    def world(self, choices: list[int], prime: int, start: int = -1) -> World:
        """Return the world of a list; it grows by what more is needed. Raises `Singular`."""
        more = random.Random(f"small {start}") if start >= 0 else None  # noqa: S311
        chosen = Chosen(prime, choices, more=more)
        generator = random.Random(f"{sorted(self.names)}")  # noqa: S311 - reproducible
        return built(self.names, Draw(chosen, generator, 0))

    def fails(self, choices: list[int], start: int = -1) -> bool:
        """Tell whether the terms differ at t = 0 in the world of a list."""
        self.tests += 1
        try:
            evaluator = Evaluator(self.world(choices, PRIME, start), self.scalars)
            values = [_first(evaluator, t) for t in self.terms]
        except (InputError, Singular, ArithmeticError, KeyError):
            return False
        return values[0] != values[1]

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


def _shown(
    shop: Workshop, members: tuple[Member, Member], tried: _Tried, choices: list[int]
) -> Counterexample | None:
    try:
        evaluator = Evaluator(tried.world(list(choices), 0), tried.scalars)
        sides = [_numbers(evaluator, t) for t in tried.terms]
        values = tuple(_values(shop, members, evaluator))
    except (InputError, Singular, ArithmeticError, KeyError):
        return None
    texts = [*sides, *(v for _, v in values)]
    if sides[0] == sides[1] or any(_large(t) for t in texts):
        return None
    heads = [_head(shop, m) for m in members]
    return Counterexample(values, tuple(zip(heads, sides, strict=True)), tuple(sorted(tried.names)))


def _head(shop: Workshop, member: Member) -> str:
    if member.path is None:
        return "\\text{left side}"
    return latex(at(shop.line.tree, member.path))


def _values(
    shop: Workshop, members: tuple[Member, Member], evaluator: Evaluator
) -> Iterator[tuple[str, str]]:
    roots = [at(shop.line.tree, m.path) for m in members if m.path is not None]
    if any(isinstance(n, Integral) for r in roots for n in walk(r)):
        masses = [_number(m.coefficients[0]) for m in evaluator.world.masses]
        yield latex(Differential(Symbol("m"))), ",\\ ".join(m for m in masses if m != "0")
    for node in list(dict.fromkeys(n for r in roots for n in _quantities(r)))[:SHOWN]:
        value = valued(shop.line.elaborator, node)
        if value is not None and not value.is_zero:
            yield latex(node), _numbers(evaluator, value.term)


def _quantities(root: Node) -> Iterator[Node]:
    """Yield the symbols of a member, and the derivatives that stand there."""
    yield from symbols(root)
    yield from (n for n in walk(root) if isinstance(n, Derivative) and n.operand is not None)


def _numbers(evaluator: Evaluator, term: Term) -> str:
    """Return a value at t = 0: a number, a row of components, rows of a matrix.

    One for each mass where it depends on one; those without mass are left out.
    """
    found: list[str] = []
    for env in evaluator.numberings(evaluator.labels(term)):
        masses = evaluator.world.masses
        if all(masses[n].coefficients[0] != 0 for n in env.values() if n < len(masses)):
            found.append(_written(evaluator.value(term, env)))
    return ",\\ ".join(found[:1] if len(set(found)) == 1 else found)


def _written(value: Any) -> str:
    if isinstance(value, Series):
        return _number(value.coefficients[0])
    if isinstance(value[0], Series):
        return "(" + ",\\, ".join(_written(v) for v in value) + ")"
    rows = " \\\\ ".join(" & ".join(_written(v) for v in row) for row in value)
    return f"\\begin{{bmatrix}} {rows} \\end{{bmatrix}}"


def _number(value: Any) -> str:
    exact = Fraction(value)
    sign = "-" if exact < 0 else ""
    if exact.denominator == 1:
        return str(exact.numerator)
    return f"{sign}\\frac{{{abs(exact.numerator)}}}{{{exact.denominator}}}"


def _large(text: str) -> bool:
    digits = "".join(c if c.isdigit() else " " for c in text).split()
    return any(int(d) > LARGEST for d in digits)
