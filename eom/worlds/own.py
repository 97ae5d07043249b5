"""Worlds with the frames, points and laws of a derivation of one's own.

A law is kept by the coordinates that it determines: coefficient by coefficient of their motion, each of
which enters the law linearly once those before it are known. Nothing else of the motion is restricted.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact import series
from eom.exact.series import LENGTH, Matrix, Series
from eom.fields import Echelon, Field, Singular, solve
from eom.terms.own import Own, OwnFrame
from eom.terms.terms import Term
from eom.worlds.evaluate import Evaluator, flat
from eom.worlds.turning import elementary
from eom.worlds.worlds import World

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


def _with(world: World, own: Own, scalars: Scalars, motions: Motions) -> World:
    memo = {("coordinate", name): motion for name, motion in motions.items()}
    frames, points = {**world.frames}, {**world.points}
    new = dataclasses.replace(world, frames=frames, points=points, memo=dict[Any, Any](memo))
    evaluator = Evaluator(new, scalars)
    for name, frame in own.frames.items():
        frames[name] = _turned(evaluator, frame)
    for name, place in own.points.items():
        points[name] = evaluator.value(place)
    return new


def _turned(evaluator: Evaluator, frame: OwnFrame) -> Matrix:
    sine, cosine = (evaluator.scalar(f(frame.angle), {}) for f in (sp.sin, sp.cos))
    turn = elementary(frame.axis - 1, sine, cosine)
    return series.product(turn, evaluator.world.rotation(frame.base, "I"))


# -- laws --------------------------------------------------------------------------------------------


@dataclasses.dataclass
class _Laws:
    """Laws in a world, as functions of the motions of what they determine."""

    world: World
    own: Own
    scalars: Scalars
    motions: Motions

    def rest(self) -> list[tuple[Any, ...]]:
        """Return left less right of every law, component by component: the coefficients."""
        world = _with(self.world, self.own, self.scalars, self.motions)
        evaluator = Evaluator(world, self.scalars)
        sides = (
            zip(
                flat(evaluator.value(law.equation.left)),
                flat(evaluator.value(law.equation.right)),
                strict=True,
            )
            for law in self.own.laws
        )
        return [(a - b).coefficients for pairs in sides for a, b in pairs]

    def changed(self, name: str, place: int, by: Any) -> _Laws:
        """Return the laws where one coefficient of a motion is another."""
        motions = {**self.motions, name: _changed(self.motions[name], place, by)}
        return dataclasses.replace(self, motions=motions)


def _changed(motion: Series, place: int, by: Any) -> Series:
    c, field = motion.coefficients, motion.field
    return Series(field, (*c[:place], field.reduce(c[place] + by), *c[place + 1 :]))


def _lawful(world: World, own: Own, scalars: Scalars) -> Motions:
    names = [scalars[s].data[1] for law in own.laws for s in law.unknowns]
    start = {name: world.primitive("coordinate", (name,)) for name in names}
    laws = _Laws(world, own, scalars, start)
    orders = {name: _order(laws, name) for name in names}
    for n in range(LENGTH):
        places = [(name, n + k) for name, k in orders.items() if n + k < LENGTH]
        rows = _linear(laws, n, places)
        if rows is None:
            break
        for (name, place), value in zip(places, _solution(rows, world.field), strict=True):
            laws = laws.changed(name, place, value)
        if any(c[n] for c in laws.rest() if n < len(c)):
            raise InputError(
                "no motion keeps this law",
                got=", ".join(names),
                expected="laws that are linear in the highest rates of what they determine",
                hint="differentiate a constraint on places, or give one coordinate by the others",
            )
    return laws.motions


def _order(laws: _Laws, name: str) -> int:
    """Return the highest rate of a coordinate in the laws."""
    before = [c[0] for c in laws.rest()]
    for k in range(HIGHEST, -1, -1):
        if [c[0] for c in laws.changed(name, k, 1).rest()] != before:
            return k
    raise InputError("a law has to contain what it determines", got=name)


def _linear(laws: _Laws, n: int, places: Sequence[tuple[str, int]]) -> list[list[Any]] | None:
    """Return coefficients of what is looked for, and the right sides, where the laws reach so far."""
    before = laws.rest()
    reached = [k for k, c in enumerate(before) if n < len(c)]
    if not reached or not places:
        return None
    reduce: Callable[[Any], Any] = laws.world.field.reduce
    moved = [laws.changed(name, place, 1).rest() for name, place in places]
    return [
        [*(reduce(m[k][n] - before[k][n]) for m in moved), reduce(-before[k][n])] for k in reached
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
