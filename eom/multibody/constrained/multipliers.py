"""Motion under constraints: by multipliers, or with the dependent speeds eliminated.

The equations are M u' + h = tau + J^T lambda and J u' + gamma = 0. By multipliers: lambda from
(J M^-1 J^T) lambda = -(gamma + J u'_free), where u'_free and the columns of M^-1 J^T are runs of the
articulated-body recursion, which share its inertias (Featherstone, Rigid Body Dynamics Algorithms
(2008), sec. 8.5, 8.8). By elimination: J is split by dependent and independent speeds,
u_D = W u_I + w, and the equations are taken along the motions that are left, T = (1, W)^T (Kane and
Levinson, Dynamics: Theory and Applications (1985), sec. 2.13, 4.4, 6.1; W from J_D J_D^T, so that no
pivot vanishes unless J_D is singular).

Small symmetric linear systems over scalars of any kind, straight-line.

A = L D L^T without square roots and without pivoting (Golub and Van Loan, Matrix Computations, 4th ed.
(2013), sec. 4.1.2): stable for definite matrices. Zeros by structure cost nothing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eom.errors import InputError
from eom.multibody.algebra.scalars import (
    Scalar,
    Work,
    add,
    is_zero,
    mul,
    negative,
    reciprocal,
    sub,
    total,
)
from eom.multibody.algebra.spatial import ZERO
from eom.multibody.constrained.equations import Component
from eom.multibody.constrained.relations import Row
from eom.multibody.recursion.lumped_tree import LumpedTree
from eom.multibody.recursion.motion import Scalars
from eom.multibody.recursion.recursions import forward_dynamics, inverse_dynamics, mass_matrix

Matrix = Sequence[Sequence[Scalar]]


@dataclass(frozen=True)
class Factor:
    """The factors: L below the diagonal, the pivots and their reciprocals."""

    lower: tuple[tuple[Scalar, ...], ...]
    pivots: tuple[Scalar, ...]
    inverses: tuple[Scalar, ...]


def factor(A: Matrix, work: Work, names: Sequence[str]) -> Factor:
    """Return the factors of a symmetric matrix; ``names``: of its rows, for what is kept.

    Raises `ZeroDivisionError` for a pivot that is zero by structure.
    """
    lower: list[tuple[Scalar, ...]] = []
    pivots: list[Scalar] = []
    inverses: list[Scalar] = []
    for i, name in enumerate(names):
        row: list[Scalar] = []
        scaled: list[Scalar] = []  # L times D
        for j in range(i):
            rest = A[i][j]
            for k in range(j):
                rest = sub(rest, mul(scaled[k], lower[j][k]))
            rest = work.keep("solved", name, "", rest)
            scaled.append(rest)
            row.append(work.keep("factor", name, "", mul(rest, inverses[j])))
        pivot = A[i][i]
        for s, entry in zip(scaled, row, strict=True):
            pivot = sub(pivot, mul(s, entry))
        if is_zero(pivot):
            raise ZeroDivisionError(name)
        pivot = work.keep("pivot", name, "", pivot)
        lower.append(tuple(row))
        pivots.append(pivot)
        inverses.append(work.keep("pivot_inverse", name, "", reciprocal(pivot)))
    return Factor(tuple(lower), tuple(pivots), tuple(inverses))


def solve(
    found: Factor, b: Sequence[Scalar], work: Work, names: Sequence[str], letter: str = "solved"
) -> list[Scalar]:
    """Return x with A x = b; its entries are kept under ``letter``."""
    x = list(b)
    for i, row in enumerate(found.lower):
        for k, entry in enumerate(row):
            x[i] = sub(x[i], mul(entry, x[k]))
        x[i] = work.keep("solved", names[i], "", x[i])
    x = [mul(inverse, value) for inverse, value in zip(found.inverses, x, strict=True)]
    for i in range(len(x) - 1, -1, -1):
        for k in range(i + 1, len(x)):
            x[i] = sub(x[i], mul(found.lower[k][i], x[k]))
        x[i] = work.keep(letter, names[i], "", x[i])
    return x


@dataclass(frozen=True)
class Bound:
    """Independent components over scalars: rows, offsets, names in definitions."""

    components: tuple[Component, ...]
    rows: tuple[Row, ...]
    offsets: tuple[Scalar, ...]

    @property
    def names(self) -> list[str]:
        """Constraint and letter, as they stand in names."""
        return [f"{c.constraint}{'_' * bool(c.letter)}{c.letter}" for c in self.components]


def bound(components: Sequence[Component], work: Work) -> Bound:
    """Return rows and offsets under names."""
    rows, offsets = [], []
    for c in components:
        rows.append({
            s: work.keep("row", c.constraint, f"{c.letter}{'_' * bool(c.letter)}{s + 1}", x)
            for s, x in c.relation.row().items() if not is_zero(x)
        })  # fmt: skip
        offsets.append(work.keep("offset", c.constraint, c.letter, c.relation.offset()))
    return Bound(tuple(components), tuple(rows), tuple(offsets))


def drifts(given: Bound, moving: Sequence[Component], work: Work) -> list[Scalar]:
    """Return the second rates by velocities alone; ``moving``: the same components, with speeds."""
    pairs = zip(given.names, moving, strict=True)
    return [work.keep("drift", name, "", c.relation.drift()) for name, c in pairs]


def applied(row: Row, u: Scalars) -> Scalar:
    """Return row times speeds."""
    return total(mul(x, u[s]) for s, x in row.items())


@dataclass(frozen=True)
class Solved:
    """Accelerations of all speeds, multipliers, and the pivots that vanish where it is singular.

    ``pivots``: each relative to what it was before the elimination, from 1 to 0.
    """

    udot: list[Scalar]
    multipliers: list[Scalar] | None
    pivots: list[tuple[str, Scalar]]


@dataclass(frozen=True)
class Dynamics:
    """What both ways need: the tree, its state, applied forces, and accelerations prescribed."""

    lumped: LumpedTree
    q: Scalars
    u: Scalars
    tau: Scalars
    prescribed: Mapping[int, Scalar]
    work: Work


def ratios(
    found: Factor, diagonal: Sequence[Scalar], names: Sequence[str]
) -> list[tuple[str, Scalar]]:
    """Return pivots over what stood in their places, where they are not the same."""
    return [
        (name, mul(pivot, reciprocal(whole)))
        for name, pivot, whole in zip(names, found.pivots, diagonal, strict=True)
        if pivot is not whole
    ]


# --- multipliers --------------------------------------------------------------------------------------


def by_multipliers(given: Dynamics, held: Bound, gamma: Sequence[Scalar]) -> Solved:
    """Return accelerations and multipliers; O(n m) for n parts and m components."""
    work, names = given.work, held.names
    free = forward_dynamics(given.lumped, given.q, given.u, given.tau, work, given.prescribed)
    answers = [_answer(given, row, name) for row, name in zip(held.rows, names, strict=True)]
    G = [[_entry(work, held, answers, max(i, j), min(i, j)) for j in range(len(names))]
         for i in range(len(names))]  # fmt: skip
    right = [
        negative(add(drift, applied(row, free)))
        for drift, row in zip(gamma, held.rows, strict=True)
    ]
    try:
        found = factor(G, work, names)
    except ZeroDivisionError as error:
        raise _unmoved(str(error)) from None
    multipliers = solve(found, right, work, names, "lambda")
    udot = list(free)
    for row, x in zip(answers, multipliers, strict=True):
        udot = [add(a, mul(x, b)) for a, b in zip(udot, row, strict=True)]
    return Solved(udot, multipliers, ratios(found, [G[i][i] for i in range(len(G))], names))


def _unmoved(name: str) -> InputError:
    return InputError(
        "the force of a constraint moves nothing that others do not hold",
        where=f"constraint {name}",
        hint="derive with other start values, or leave the constraint out",
    )


def _entry(work: Work, held: Bound, answers: Sequence[Scalars], i: int, j: int) -> Scalar:
    return work.keep("gram", held.names[i], str(j + 1), applied(held.rows[i], answers[j]))


def _answer(given: Dynamics, row: Row, name: str) -> list[Scalar]:
    """Return M^-1 row^T: what a unit multiplier accelerates, all else at rest."""
    lumped = replace(
        given.lumped,
        parts=tuple(replace(p, pulls=()) for p in given.lumped.parts),
        gravity=ZERO,
        gradient=None,
    )
    n = lumped.speeds
    tau = [row.get(s, 0) for s in range(n)]
    driven = dict.fromkeys(lumped.driven, 0)
    found = forward_dynamics(lumped, given.q, [0] * n, tau, given.work, driven)
    return [given.work.keep("answer", name, str(s + 1), x) for s, x in enumerate(found)]


# --- elimination --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Follow:
    """How dependent speeds follow: u_D = ``slopes`` u_I + ``rest``, by Y = J_D^T (J_D J_D^T)^-1."""

    dependent: tuple[int, ...]
    independent: tuple[int, ...]
    driven: tuple[int, ...]
    held: Bound
    factor: Factor
    slopes: list[list[Scalar]]
    pivots: list[tuple[str, Scalar]]

    def solve(self, right: Sequence[Scalar], work: Work) -> list[Scalar]:
        """Return x with J_D x = right."""
        y = solve(self.factor, right, work, self.held.names)
        return [
            total(mul(row.get(s, 0), v) for row, v in zip(self.held.rows, y, strict=True))
            for s in self.dependent
        ]

    def multipliers(self, right: Sequence[Scalar], work: Work) -> list[Scalar]:
        """Return lambda with J_D^T lambda = right."""
        b = [
            total(mul(row.get(s, 0), x) for s, x in zip(self.dependent, right, strict=True))
            for row in self.held.rows
        ]
        return solve(self.factor, b, work, self.held.names, "lambda")


def follow(lumped: LumpedTree, dependent: Sequence[int], held: Bound, work: Work) -> Follow:
    """Return how the dependent speeds follow the others."""
    driven = lumped.driven
    rest = {*dependent, *driven}
    independent = tuple(s for s in range(lumped.speeds) if s not in rest)
    rows, names = held.rows, held.names

    def gram(i: int, j: int) -> Scalar:
        found = total(mul(rows[i].get(s, 0), rows[j].get(s, 0)) for s in dependent)
        return work.keep("gram", names[max(i, j)], str(min(i, j) + 1), found)

    G = [[gram(max(i, j), min(i, j)) for j in range(len(rows))] for i in range(len(rows))]
    try:
        found = factor(G, work, names)
    except ZeroDivisionError as error:
        raise _unmoved(str(error)) from None
    whole = [total(mul(x, x) for s, x in row.items() if s not in set(driven)) for row in rows]
    same = [len(row) == sum(s in set(dependent) for s in row) for row in rows]
    whole = [G[i][i] if same[i] else whole[i] for i in range(len(rows))]
    draft = Follow(
        tuple(dependent), independent, driven, held, found, [], ratios(found, whole, names)
    )
    columns = [draft.solve([negative(row.get(s, 0)) for row in rows], work) for s in independent]
    slopes = [[work.keep("follower", bones_name(lumped, d), str(s + 1), columns[n][k])
               for n, s in enumerate(independent)] for k, d in enumerate(dependent)]  # fmt: skip
    return replace(draft, slopes=slopes)


def bones_name(lumped: LumpedTree, speed: int) -> str:
    """Return the joint that a speed belongs to."""
    return next(p.joint for p in lumped.parts if p.speeds.start <= speed < p.speeds.stop)


def followed(given: Follow, u: Mapping[int, Scalar], work: Work) -> dict[int, Scalar]:
    """Return the dependent speeds, given the independent and the prescribed ones."""
    rest = [
        negative(add(b, total(mul(row.get(s, 0), u[s]) for s in given.driven)))
        for row, b in zip(given.held.rows, given.held.offsets, strict=True)
    ]
    moved = any(not is_zero(x) for x in rest)
    offsets = given.solve(rest, work) if moved else [0] * len(given.dependent)
    return {
        d: add(total(mul(w, u[s]) for w, s in zip(row, given.independent, strict=True)), x)
        for d, row, x in zip(given.dependent, given.slopes, offsets, strict=True)
    }


def by_elimination(given: Dynamics, way: Follow, gamma: Sequence[Scalar]) -> Solved:
    """Return the accelerations; multipliers are left out."""
    work = given.work
    driven = dict(given.prescribed)
    right = [
        negative(add(g, total(mul(row.get(s, 0), x) for s, x in driven.items())))
        for g, row in zip(gamma, way.held.rows, strict=True)
    ]
    dependent = way.solve(right, work)
    still: list[Scalar] = [0] * given.lumped.speeds
    for s, x in (*driven.items(), *zip(way.dependent, dependent, strict=True)):
        still[s] = work.keep("follower_drift", bones_name(given.lumped, s), "", x)
    needed = inverse_dynamics(given.lumped, given.q, given.u, still, work)
    M = mass_matrix(given.lumped, given.q, work)
    left = [add(t, negative(x)) for t, x in zip(given.tau, needed, strict=True)]
    names = [bones_name(given.lumped, s) for s in way.independent]
    reduced = _reduced(M, way, work, names)
    try:
        found = factor(reduced, work, names)
    except ZeroDivisionError as error:
        raise InputError("the joint accelerates no inertia", where=f"joint {error}") from None
    along = [_along(left, way, n) for n in range(len(names))]
    free = solve(found, along, work, names, "acceleration")
    udot = list(still)
    for s, x in zip(way.independent, free, strict=True):
        udot[s] = x
    for k, d in enumerate(way.dependent):
        udot[d] = add(still[d], total(mul(w, x) for w, x in zip(way.slopes[k], free, strict=True)))
    return Solved(udot, None, way.pivots)


def _along(force: Sequence[Scalar], way: Follow, n: int) -> Scalar:
    """Return the force along the motion of one independent speed."""
    followers = total(
        mul(row[n], force[d]) for row, d in zip(way.slopes, way.dependent, strict=True)
    )
    return add(force[way.independent[n]], followers)


def _reduced(
    M: Sequence[Sequence[Scalar]], way: Follow, work: Work, names: Sequence[str]
) -> list[list[Scalar]]:
    """Return T^T M T."""
    size = len(names)
    columns: list[list[Scalar]] = []
    for n, s in enumerate(way.independent):
        column = [
            add(row[s], total(mul(row[d], way.slopes[k][n]) for k, d in enumerate(way.dependent)))
            for row in M
        ]
        columns.append([work.keep("column", names[n], str(i + 1), x) for i, x in enumerate(column)])
    return [
        [work.keep("entry", names[max(i, j)], str(min(i, j) + 1),
                   _along(columns[max(i, j)], way, min(i, j))) for j in range(size)]
        for i in range(size)
    ]  # fmt: skip


def constraint_forces(given: Dynamics, way: Follow, udot: Sequence[Any]) -> list[Scalar]:
    """Return the multipliers of eliminated constraints, from what the accelerations take."""
    needed = inverse_dynamics(given.lumped, given.q, given.u, udot, given.work)
    left = [add(needed[d], negative(given.tau[d])) for d in way.dependent]
    return way.multipliers(left, given.work)
