"""Small numbers for which a false line of a derivation fails, to be put in with a pencil.

Both sides are written by coordinates, their rates and constants, with the highest rates as the laws give
them (`eom.derivations.refuted`). Constants are small whole numbers, moments of inertia those of a body that
there is, and an angle has a sine and a cosine that are fractions.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from eom.derivations.deciding import Deciding
from eom.derivations.refuted import Written, entries
from eom.derivations.verification import FALSE, DerivationError
from eom.errors import InputError
from eom.fields import Singular
from eom.terms.own import Own
from eom.terms.terms import Equation, Term, expr, nodes
from eom.worlds.evaluate import Evaluator, flat
from eom.worlds.own import furnished, highest_rates
from eom.worlds.small import small_world

Expr = Any
DRAWS, WORLDS = 60, 12
"""States and worlds that are tried at most."""
SIZES, STATES, MOMENTS = (1, 2, 3), (1, 2, -1, 3, -2), (2, 3, 4)
TRIPLES = ((3, 4, 5), (4, 3, 5), (5, 12, 13), (8, 15, 17))
"""Sides of right-angled triangles: sines and cosines."""
DIFFERENT = 1e-9
"""How far apart both sides are at least, where they are no fractions."""


@dataclass(frozen=True)
class Numbers:
    """Numbers for which a line fails.

    ``values``: of symbols, sines and cosines; ``sides``: what both sides then are, by components in I.
    """

    values: Mapping[Expr, Expr]
    sides: tuple[tuple[Expr, ...], tuple[Expr, ...]]


@dataclass(frozen=True)
class Judge:
    """A finished derivation, asked about other lines: whether they are false, and for which numbers.

    ``scalars``: what symbols stand for; ``own``: frames, points, bodies and laws of the derivation;
    ``lines``: what decides them, made of both.
    """

    scalars: Mapping[Any, Term]
    own: Own
    lines: Deciding = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "lines", Deciding(self.own, self.scalars))

    def refutes(self, equation: Equation, assumptions: Iterable[str]) -> bool:
        """Return whether an ``equation`` is false in a world in which all laws hold.

        ``assumptions``: under which it is claimed. False of what is undecided.
        """
        try:
            self.lines.decided(replace(equation, relation="="), assumptions)
        except DerivationError as error:
            return error.what == FALSE
        except InputError:
            return False
        return False

    def numbers(
        self, wrong: Equation, right: Equation, assumptions: Iterable[str] = ()
    ) -> Numbers | None:
        """Return small numbers for which both sides of ``wrong`` differ, and those of ``right`` do not.

        ``assumptions``: under which both are claimed. None where none are found. What is not written by
        coordinates and constants has those of a world.
        """
        try:
            lines = self.lines.carried(wrong), self.lines.carried(right)
            scalars = self.lines.worlds().scalars
        except InputError:
            return None
        try:
            return _by_symbols(*lines, scalars, self.own)
        except InputError:
            return _in_a_world(*lines, scalars, self.own, tuple(assumptions))


def _by_symbols(
    wrong: Equation, right: Equation, scalars: Mapping[Any, Term], own: Own
) -> Numbers | None:
    """Return numbers of lines that are written by symbols. Raises `InputError` for others."""
    terms = (wrong.left, wrong.right, right.left, right.right)
    plain = _written(terms, scalars, own)
    named = sorted(_symbols(terms[:2]) - _angles(plain), key=sp.default_sort_key)
    found = [*plain, *_written([expr(s) for s in named], scalars, own)]
    constants = {s for s, m in scalars.items() if m.head == "atom" and m.data[0] == "scalar"}
    for values in _states([e for side in found for e in side], constants):
        there = [tuple(e.xreplace(values) for e in side) for side in found]
        left, other, *same = there[:4]
        sound = all(_is_number(e) for side in there for e in side)
        if sound and any(map(_differ, left, other)) and not any(map(_differ, *same)):
            given = values | {s: value for s, (value,) in zip(named, there[4:], strict=True)}
            return Numbers(_shown(given, named, terms[:2]), (left, other))
    return None


def _in_a_world(
    wrong: Equation, right: Equation, scalars: Mapping[Any, Term], own: Own, given: tuple[str, ...]
) -> Numbers | None:
    """Return the numbers of a world of small ones, of the symbols in the lines and of both sides."""
    terms = (wrong.left, wrong.right, right.left, right.right)
    named = sorted(_symbols(terms[:2]) & scalars.keys(), key=sp.default_sort_key)
    for draw in range(WORLDS):
        try:
            world = small_world(given, draw)
            evaluator = Evaluator(furnished(world, own, dict(scalars)), dict(scalars))
            env = next(evaluator.numberings(frozenset().union(*map(evaluator.labels, terms))))
            found = [
                tuple(sp.Rational(x.coefficients[0]) for x in flat(evaluator.value(t, env)))
                for t in (*terms, *map(expr, named))
            ]
        except (Singular, ArithmeticError, IndexError, StopIteration, InputError):
            continue
        left, other, *same = found[:4]
        if left != other and same[0] == same[1]:
            values = {s: value for s, (value,) in zip(named, found[4:], strict=True)}
            return Numbers(values, (left, other))
    return None


def _angles(found: Sequence[Sequence[Expr]]) -> set[Expr]:
    """Return the symbols of which sines and cosines alone are taken."""
    whole = [e for side in found for e in side]
    turns = {f for e in whole for f in e.atoms(sp.sin, sp.cos)}
    bare = {f: sp.Dummy() for f in turns}
    outside = {s for e in whole for s in e.xreplace(bare).free_symbols}
    return {f.args[0] for f in turns if f.args[0].is_Symbol} - outside


def _written(
    terms: Sequence[Term], scalars: Mapping[Any, Term], own: Own
) -> list[tuple[Expr, ...]]:
    """Return terms by components, with what the laws determine put in where it stands.

    Raises `InputError` for what is not written by symbols.
    """
    kit = Written(scalars, own)
    found = [tuple(entries(kit.value(t))) for t in terms]
    highest = highest_rates(own, dict(scalars)) if own.laws else {}
    used = {s for side in found for e in side for s in e.free_symbols}
    laws = [
        law
        for law in own.laws
        if any(used & _determined(kit, s, highest[str(scalars[s].data[1])]) for s in law.unknowns)
    ]
    return [tuple(kit.moving(e, laws) if laws else e for e in side) for side in found]


def _determined(kit: Written, symbol: Expr, order: int) -> set[Expr]:
    """Return the rates of a symbol that a law determines, from an ``order`` on."""
    chain = [symbol]
    while chain[-1] in kit.rates:
        chain.append(kit.rates[chain[-1]])
    return set(chain[order:])


def _symbols(terms: Sequence[Term]) -> set[Expr]:
    parts = (n for t in terms for n in nodes(t) if n.head == "expr")
    return {s for n in parts for s in n.data[0].free_symbols}


def _shown(
    given: Mapping[Expr, Expr], named: Sequence[Expr], terms: Sequence[Term]
) -> dict[Expr, Expr]:
    """Return what a reader needs: the symbols of the line; of one with vectors, all of the motion."""
    plain = all(n.args or n.head in {"expr", "zero"} for t in terms for n in nodes(t))
    plain = plain and not any(n.head == "der" for t in terms for n in nodes(t))
    angles = {f.args[0] for f in given if isinstance(f, sp.sin | sp.cos)}
    kept = named if plain else [*named, *(s for s in given if s not in named and s.is_Symbol)]
    turns = [f for f in given if not f.is_Symbol]
    return {s: given[s] for s in (*(s for s in kept if s not in angles), *turns)}


def _is_number(value: Expr) -> bool:
    plain = value.is_number and not value.atoms(sp.sin, sp.cos)
    return bool(plain and value.is_finite and value.is_real)


def _differ(a: Expr, b: Expr) -> bool:
    return bool(abs(sp.N(a - b)) > DIFFERENT)


def _states(written: Sequence[Expr], constants: set[Expr]) -> Iterator[dict[Expr, Expr]]:
    """Yield values of the symbols in some expressions, of angles of their sines and cosines."""
    turns = {f for e in written for f in e.atoms(sp.sin, sp.cos)}
    angles = sorted({f.args[0] for f in turns}, key=sp.default_sort_key)
    bare = {f: sp.Dummy() for f in turns}
    free = {s for e in written for s in e.xreplace(bare).free_symbols if s not in bare.values()}
    if any(a.free_symbols & free or not a.is_Symbol for a in angles):
        angles = []  # an angle that stands outside, too, has no such sine
        free |= {s for f in turns for s in f.free_symbols}
    symbols = sorted(free, key=sp.default_sort_key)
    for draw in range(DRAWS):
        rng = random.Random(f"small {draw}")  # noqa: S311 - reproducible
        values = {s: _value(s, s in constants, rng) for s in symbols}
        for angle in angles:
            a, b, c = rng.choice(TRIPLES)
            sides = {sp.sin(angle): sp.Rational(a, c), sp.cos(angle): sp.Rational(b, c)}
            values |= {f: value for f, value in sides.items() if f in turns}
        yield values


def _value(symbol: Expr, is_constant: bool, rng: random.Random) -> Expr:
    name = symbol.name.replace("_", "")
    if len(name) == 2 and name[0] in "IJ" and name[1] in "123":
        return sp.Integer(MOMENTS[int(name[1]) - 1])
    return sp.Integer(rng.choice(SIZES if is_constant or symbol.is_positive else STATES))
