"""Worlds with the frames, points and laws of a derivation of one's own.

A law is kept by the coordinates that it determines: coefficient by coefficient of their motion, each of
which enters the law linearly once those before it are known. Nothing else of the motion is restricted.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact import series
from eom.exact.numbers import TINY
from eom.exact.series import LENGTH, Matrix, Series
from eom.fields import RESIDUES, Echelon, Field, Singular, solve
from eom.terms.own import Law, Own, OwnFrame
from eom.terms.terms import Term
from eom.worlds.evaluate import Evaluator, flat
from eom.worlds.generators import worlds
from eom.worlds.turning import elementary
from eom.worlds.worlds import CONFIGURED, World

Scalars = Mapping[Any, Term]
Motions = dict[str, Series]
HIGHEST = 3
"""Rates up to which coordinates stand in laws."""


def furnished(world: World, own: Own, scalars: Scalars) -> World:
    """Return a world with own frames and points, in which own laws hold.

    Raises `Singular` where a law determines nothing in this world, `InputError` where it never does.
    """
    motions: Motions = {}
    if own.laws:
        motions = _lawful(world, own, scalars)
    return _with(world, own, scalars, motions)


@dataclasses.dataclass
class Furnished:
    """Worlds under assumptions, furnished, each of them made once: what `eom.worlds.generators.worlds` is.

    Those in which a law determines nothing are left out. ``own`` is not to change; ``scalars`` may grow by
    symbols that stand in none of the laws.
    """

    own: Own
    scalars: dict[Any, Term]
    known: dict[tuple[Any, ...], World | None] = dataclasses.field(default_factory=dict)

    def __call__(
        self, assumptions: Iterable[str], count: int, field: Field = RESIDUES
    ) -> Iterator[World]:
        """Yield at most ``count`` worlds."""
        assumed = tuple(assumptions)
        for seed, plain in enumerate(worlds(assumed, count, field)):
            key = (assumed, seed, field)
            if key not in self.known:
                self.known[key] = self._furnished(plain)
            world = self.known[key]
            if world is not None:
                yield world

    def _furnished(self, plain: World) -> World | None:
        try:
            return furnished(plain, self.own, self.scalars)
        except Singular:
            return None


def _with(world: World, own: Own, scalars: Scalars, motions: Motions) -> World:
    memo: dict[Any, Any] = {("coordinate", name): motion for name, motion in motions.items()}
    memo[CONFIGURED] = own.configured

    def built(bare: World) -> World:
        frames, points = {**bare.frames}, {**bare.points}
        new = dataclasses.replace(bare, frames=frames, points=points)
        evaluator = Evaluator(new, scalars)
        for name, frame in own.frames.items():
            frames[name] = _turned(evaluator, frame)
        for name, place in own.points.items():
            points[name] = evaluator.value(place)
        return new

    return built(dataclasses.replace(world, memo=memo, rebuild=built))


def _turned(evaluator: Evaluator, frame: OwnFrame) -> Matrix:
    sine, cosine = (evaluator.scalar(f(frame.angle), {}) for f in (sp.sin, sp.cos))
    turn = elementary(frame.axis - 1, sine, cosine)
    return series.product(turn, evaluator.world.rotation(frame.base, "I"))


def highest_rates(own: Own, scalars: Scalars) -> dict[str, int]:
    """Return, by names, the highest rate by which each coordinate stands in the law that determines it."""
    world = next(worlds((), 1))
    names = [[str(scalars[s].data[1]) for s in law.unknowns] for law in own.laws]
    start = {n: world.primitive("coordinate", (n,)) for some in names for n in some}
    found = _orders(_Laws(world, own, scalars, start), list(start))
    return {n: order[n] for some, order in zip(names, found, strict=True) for n in some}


# -- laws --------------------------------------------------------------------------------------------


Rest = list[list[tuple[Any, ...]]]
"""Of each law, left less right by components: the coefficients."""


@dataclasses.dataclass
class _Laws:
    """Laws in a world, as functions of the motions of what they determine."""

    world: World
    own: Own
    scalars: Scalars
    motions: Motions

    def rest(self) -> Rest:
        """Return left less right of every law."""
        world = _with(self.world, self.own, self.scalars, self.motions)
        evaluator = Evaluator(world, self.scalars)
        return [_differences(evaluator, law) for law in self.own.laws]

    def changed(self, name: str, place: int, by: Any) -> _Laws:
        """Return the laws where one coefficient of a motion is another."""
        motions = {**self.motions, name: _changed(self.motions[name], place, by)}
        return dataclasses.replace(self, motions=motions)


def _differences(evaluator: Evaluator, law: Law) -> list[tuple[Any, ...]]:
    sides = (flat(evaluator.value(t)) for t in (law.equation.left, law.equation.right))
    return [(a - b).coefficients for a, b in zip(*sides, strict=True)]


def _changed(motion: Series, place: int, by: Any) -> Series:
    c, field = motion.coefficients, motion.field
    return Series(field, (*c[:place], field.reduce(c[place] + by), *c[place + 1 :]))


def _lawful(world: World, own: Own, scalars: Scalars) -> Motions:
    """Return motions that keep all laws, stage by stage; where no law speaks they are as drawn."""
    names = [[str(scalars[s].data[1]) for s in law.unknowns] for law in own.laws]
    start = {n: world.primitive("coordinate", (n,)) for some in names for n in some}
    laws = _Laws(world, own, scalars, start)
    orders = _orders(laws, list(start))
    first = _offsets(names, orders)
    lengths = [max(map(len, law)) for law in laws.rest()]
    for stage in range(-max(first), LENGTH):
        active = [i for i, c in enumerate(first) if 0 <= stage + c < lengths[i]]
        places = [(n, stage + first[i] + orders[i][n]) for i in active for n in names[i]]
        places = [(n, place) for n, place in places if place < LENGTH]
        for _ in active:  # what one law determines may enter those behind it in any way
            rows = _linear(laws, {i: stage + first[i] for i in active}, places)
            if not any(_is_left(row[-1]) for row in rows):
                break
            for (n, place), value in zip(places, _solution(rows, world.field), strict=True):
                laws = laws.changed(n, place, value)
    if any(map(_is_left, (x for law in laws.rest() for c in law for x in c))):
        raise _unkept(list(start))
    known = {n: lengths[i] + orders[i][n] for i, own in enumerate(names) for n in own}
    return {n: Series(world.field, m.coefficients[: known[n]]) for n, m in laws.motions.items()}


def _is_left(x: Any) -> bool:
    """Return whether a coefficient is not zero; real numbers to many digits are rounded."""
    return bool(abs(x) > TINY if isinstance(x, type(TINY)) else x)


def _unkept(names: Sequence[str]) -> InputError:
    return InputError(
        "no motion keeps this law",
        got=", ".join(names),
        expected="laws that are linear in the highest rates of what they determine",
        hint="differentiate a constraint on places, or give one coordinate by the others",
    )


def _orders(laws: _Laws, names: Sequence[str]) -> list[dict[str, int]]:
    """Return of each law the highest rate of every coordinate in it, -1 where it does not stand."""
    before = [[c[0] for c in law] for law in laws.rest()]
    found = [dict.fromkeys(names, -1) for _ in before]
    for name in names:
        for k in range(HIGHEST + 1):
            after = laws.changed(name, k, 1).rest()
            for i, law in enumerate(after):
                if [c[0] for c in law] != before[i]:
                    found[i][name] = k
    return found


def _offsets(names: Sequence[Sequence[str]], orders: Sequence[Mapping[str, int]]) -> list[int]:
    """Return how often each law is to be differentiated, so that it and the others fit together.

    A law that determines x by its first rate, beside one with the second, has to be differentiated once.
    Source: J. D. Pryce, A simple structural analysis method for DAEs, BIT 41 (2001), 364-394.
    """
    for own, order in zip(names, orders, strict=True):
        for name in own:
            if order[name] < 0:
                raise InputError("a law has to contain what it determines", got=name)
    found = [0] * len(names)
    for _ in range(len(names) * (HIGHEST + 1) + 1):
        rows = list(zip(found, orders, strict=True))
        wanted = [
            max(c + order[n] - orders[i][n] for n in own for c, order in rows if order[n] >= 0)
            for i, own in enumerate(names)
        ]
        if wanted == found:
            return found
        found = wanted
    raise _unkept([n for own in names for n in own])


def _linear(
    laws: _Laws, rows: Mapping[int, int], places: Sequence[tuple[str, int]]
) -> list[list[Any]]:
    """Return coefficients of what is looked for, and the right sides; ``rows``: place by law."""
    before = laws.rest()
    reached = [(i, k) for i, n in rows.items() for k, c in enumerate(before[i]) if n < len(c)]
    if not reached or not places:
        return []
    reduce: Callable[[Any], Any] = laws.world.field.reduce
    moved = [laws.changed(name, place, 1).rest() for name, place in places]
    return [
        [
            *(reduce(m[i][k][rows[i]] - before[i][k][rows[i]]) for m in moved),
            reduce(-before[i][k][rows[i]]),
        ]
        for i, k in reached
    ]


def _solution(rows: Sequence[Sequence[Any]], field: Field) -> list[Any]:
    """Solve for what is looked for by as many rows as there are. Raises `Singular`."""
    unknown = len(rows[0]) - 1
    form, kept = Echelon(field, unknown), list[Sequence[Any]]()
    for row in rows:
        count = len(form.rows)
        form.add([*row[:-1]])
        if len(form.rows) > count:
            kept.append(row)
    if len(kept) < unknown:
        raise Singular
    return solve([row[:-1] for row in kept], [row[-1] for row in kept], field)
