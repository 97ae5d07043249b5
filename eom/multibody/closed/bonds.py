"""Constraints of a mechanism in polynomials: equations between speeds, solved for those that follow.

The equations are those of `eom.multibody.constrained.equations`, over polynomials; that the rate of a
closure is the equation between speeds is verified when it is made. With J u + b = 0 the dependent speeds
are u_D = A u_I + B, by elimination of Gauss and Jordan; W is the inverse of J_D, for the multipliers.

By Kane's method and by balances the mechanism is described by its independent speeds from the start: its
partial velocities are the nonholonomic ones. Lagrange's equations hold with every speed free: they get
multipliers, and are then combined so that these drop out (Maggi).
Source: Kane and Levinson, Dynamics: Theory and Applications (1985), sec. 2.13, 4.4, 4.11; Greenwood,
Advanced Dynamics (2003), ch. 2 (multipliers) and ch. 4 (Maggi).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import sympy as sp

from eom.derivations.verification import DerivationError
from eom.errors import InputError, unknown_name
from eom.exact.identity import vanishes
from eom.multibody.algebra.scalars import is_zero, negative, total
from eom.multibody.closed.lagrange import Lagrange
from eom.multibody.closed.mechanism import Mechanism, Pull, Trigonometry, followed
from eom.multibody.closed.polynomials import Polynomial, Scalar
from eom.multibody.closed.readable import Contribution
from eom.multibody.constrained.dependence import examine
from eom.multibody.constrained.equations import Component, components
from eom.multibody.constrained.relations import Arithmetic, scene
from eom.multibody.recursion.lumped_tree import lumped_tree

Expr = Any
Write = Callable[[Scalar], Expr]


@dataclass(frozen=True)
class Bond:
    """An equation of a constraint: ``value`` is zero (None between speeds alone), and so is ``rate``.

    ``row``: the coefficient of each speed in the rate, by its number; ``rest``: what has no speed.
    """

    component: Component
    value: Scalar | None
    rate: Scalar
    row: Mapping[int, Scalar]
    rest: Scalar

    @property
    def name(self) -> str:
        """Constraint and letter, as in the name of the multiplier."""
        c = self.component
        return f"{c.constraint}{'_' * bool(c.letter)}{c.letter}"


@dataclass(frozen=True)
class Bonds:
    """The constraints of a mechanism, solved.

    ``whole``: the mechanism without them. ``kept``: equations that bind; ``idle``: names of those that
    hold by themselves or by others. ``dependent``: by the number of a speed that follows, its
    coefficients over the others (-1: what has no speed). ``inverse``: W, by dependent speed, over
    ``kept``. ``divisors``: what must not be zero. ``positive``: what was taken to be above zero.
    """

    whole: Mechanism
    kept: tuple[Bond, ...]
    idle: tuple[str, ...]
    dependent: Mapping[int, Mapping[int, Scalar]]
    inverse: Mapping[int, Sequence[Scalar]]
    divisors: tuple[Expr, ...]
    positive: tuple[Expr, ...]

    @cached_property
    def placed(self) -> dict[Expr, Scalar]:
        """Coordinates that closures give outright, over the others: q = R, z = r cos(theta)."""
        found: dict[Expr, Scalar] = {}
        for b in self.kept:
            for q in self._followed_coordinates():
                x = None if b.value is None or q in found else self._solved(b.value, q, found)
                if x is not None:
                    index = self.whole.algebra.index(q)
                    put = self.whole.algebra.replaced
                    found = {k: put(v, {index: x}) for k, v in found.items()} | {q: x}
                    break
        return found

    def _followed_coordinates(self) -> Iterator[Expr]:
        """Yield coordinates whose rates are speeds that follow, and that stand in no function."""
        for d in self.dependent:
            moved = self.whole.basis[d]
            if len(moved) == 1 and set(moved.values()) == {1}:
                q = next(iter(moved))
                others = (g for g in self.whole.algebra.generators if g != q)
                if not any(q in g.free_symbols for g in others):
                    yield q

    def _solved(self, value: Scalar, q: Expr, known: Mapping[Expr, Scalar]) -> Scalar | None:
        """Return the coordinate from a closure that is linear in it, with a constant that moves not."""
        algebra = self.whole.algebra
        index = algebra.index(q)
        value = algebra.replaced(value, {algebra.index(k): x for k, x in known.items()})
        parts = value.by(lambda g: g == index) if isinstance(value, Polynomial) else {}
        slope = parts.pop(((index, 1),), 0)
        constant = not isinstance(slope, Polynomial) and slope != 0
        if not constant or set(parts) - {()}:
            return None
        return parts.get((), 0) * (Fraction(-1) / slope)

    def in_place(self, x: Scalar) -> Scalar:
        """Return a scalar with the coordinates put in that closures give."""
        algebra = self.whole.algebra
        put = {algebra.index(q): v for q, v in self.placed.items()}
        return self.whole.in_place(algebra.replaced(x, put))

    @property
    def independent(self) -> tuple[int, ...]:
        """The numbers of the speeds that are free and follow no others."""
        return tuple(k for k in self.whole.free if k not in self.dependent)

    @cached_property
    def mechanism(self) -> Mechanism:
        """The mechanism over its independent speeds."""
        return _reduced(self)

    def atom(self, k: int) -> Scalar:
        """Return a speed of the whole mechanism, or 1 for what has no speed."""
        return self.whole.algebra.atom(self.whole.speeds[k].symbol) if k >= 0 else 1

    def follower(self, k: int) -> Scalar:
        """Return a dependent speed over the others."""
        return total(x * self.atom(s) for s, x in self.dependent[k].items())

    @cached_property
    def known(self) -> dict[int, Scalar]:
        """The dependent speeds and their rates over the others, by generator."""
        index = self.whole.algebra.index
        found = {}
        for k in self.dependent:
            found[index(self.whole.speeds[k].symbol)] = self.follower(k)
            found[index(self.whole.accelerations[k])] = self.mechanism.rate(self.follower(k))
        return found

    def over_independent(self, x: Scalar) -> Scalar:
        """Return a scalar over the independent speeds and their rates."""
        return followed(self.whole.algebra, x, self.known)


def bonds(
    given: Mechanism, chosen: Mapping[Expr, Expr], independent: Sequence[str], write: Write
) -> Bonds:
    """Return the constraints of a mechanism, solved for speeds that follow.

    ``chosen``: other coordinates, as of `mechanism`; ``independent``: names of speeds that shall stay,
    or none; ``write``: writes a divisor. Raises `InputError` for constraints that contradict each
    other or leave no motion, and for speeds that cannot all stay.
    """
    rooted = _Roots(given)
    found = _found(given, chosen, rooted)
    solver = _Solver(given, found, _stay(given, independent), write)
    solver.run()
    made = solver.bonds(tuple(rooted.positive))
    _regular(made)
    if given.free and not made.independent:
        raise InputError("the constraints leave no motion", where=given.algebra.where)
    return made


def _regular(made: Bonds) -> None:
    """Raise `InputError` where equations that are independent in general depend where they hold.

    Numbers decide, as for `derive`; constraints that no drawn numbers meet are left to it.
    """
    try:
        count = len(examine(made.whole.tree).kept)
    except InputError:
        return
    if count < len(made.kept):
        raise InputError(
            "constraints depend on each other where they hold, and not elsewhere: no closed form",
            where=made.whole.algebra.where,
            got=f"{len(made.kept)} equations, {count} of them independent",
            hint="leave out what others hold, or use derive(tree)",
        )


def _stay(given: Mechanism, names: Sequence[str]) -> set[int]:
    """Return the numbers of speeds that shall stay independent."""
    joints = [u.symbol for link in given.links for u in link.joint.speeds]
    known = {u.name: k for k, u in enumerate(given.speeds) if k in given.free}
    known |= {s.name: known[n.name] for s in joints if (n := given.algebra.named(s)).name in known}
    for name in names:
        if name not in known:
            raise unknown_name("independent speed", name, known, given.algebra.where)
    return {known[name] for name in names}


class _Roots:
    """Square roots in an algebra: of squares, what is squared taken to be positive."""

    def __init__(self, given: Mechanism) -> None:
        self.given = given
        self.positive: list[Expr] = []

    def __call__(self, x: Scalar) -> Scalar:
        algebra = self.given.algebra
        found = algebra.squared(x) if isinstance(x, Polynomial) else None
        if found is None:
            raise InputError(
                "the constraint has a square root that no closed form over these coordinates has",
                where=algebra.where,
                got=f"sqrt({algebra.expression(x)})",
                hint="describe the attitude by angles of which one is the lean (3-1-2 for a wheel about "
                "y; eom derive --attitude), or use derive(tree)",
            )
        written = algebra.expression(found)
        if written not in self.positive and not written.is_positive:
            self.positive.append(written)
        return found


def _found(given: Mechanism, chosen: Mapping[Expr, Expr], roots: _Roots) -> list[Bond]:
    """Return the equations of all constraints, each verified."""
    algebra = given.algebra

    def lift(x: Any) -> Scalar:
        return algebra.lift(x.xreplace(dict(chosen)) if isinstance(x, sp.Basic) else x)

    work = Trigonometry(algebra)
    lumped = lumped_tree(given.tree, lift, work)
    seen = scene(lumped, given.coordinates, None, Arithmetic(lift, work, roots))
    return [_bond(given, c) for c in components(given.tree, seen)]


def _bond(given: Mechanism, c: Component) -> Bond:
    relation = c.relation
    of_joints = (x * given.joint_speeds[s] for s, x in relation.row().items())
    rate = total(of_joints) + relation.offset()
    row = {s: x for s in range(len(given.speeds)) if not is_zero(x := given.part(rate, s))}
    speeds = (given.algebra.atom(given.speeds[s].symbol) * x for s, x in row.items())
    rest = rate - total(speeds)
    value = relation.value()
    if value is not None and not _none(given, given.rate(value) - rate):
        raise DerivationError(
            "the rate of a closure is not the equation between speeds", where=f"constraint {c.name}"
        )
    return Bond(c, value, rate, row, rest)


def _none(given: Mechanism, x: Scalar) -> bool:
    """Return whether a scalar is zero, also where it is a quotient."""
    if not isinstance(x, Polynomial):
        return not x
    quotients = any(given.algebra.generators[g].is_Pow for g in x.used)
    return quotients and vanishes(given.algebra.expression(x))


@dataclass
class _Solver:
    """Elimination of Gauss and Jordan; columns: speeds, -1 for the rest, -2 - k for equation k."""

    given: Mechanism
    bonds_: list[Bond]
    stay: set[int]
    write: Write
    rows: dict[int, dict[int, Scalar]] = field(default_factory=dict)
    pivots: dict[int, int] = field(default_factory=dict)
    idle: list[int] = field(default_factory=list)
    determinant: Scalar = 1

    def run(self) -> None:
        """Solve row after row, that with the simplest pivot first."""
        self.rows = {
            k: {**b.row, **({} if is_zero(b.rest) else {-1: b.rest}), -2 - k: 1}
            for k, b in enumerate(self.bonds_)
        }
        waiting = set(self.rows)
        while waiting:
            self._drop(waiting)
            ways = [(self._cost(r, c), r, c) for r in sorted(waiting) for c in self._columns(r)]
            if not ways:
                self._refuse(waiting)
                return
            _, r, c = min(ways)
            self._clear(r, c)
            waiting.remove(r)

    def _columns(self, r: int) -> list[int]:
        return [c for c in self.rows[r] if c in self.given.free and c not in self.stay]

    def _drop(self, waiting: set[int]) -> None:
        """Put aside the equations that others leave nothing of."""
        for r in sorted(waiting):
            if not any(c >= -1 for c in self.rows[r]):
                self._meet(r)
                self.idle.append(r)
                waiting.remove(r)

    def _meet(self, r: int) -> None:
        """Raise `InputError` where what is left of a closure is a constant other than zero."""
        shares = {-2 - c: x for c, x in self.rows[r].items()}
        values = [self.bonds_[k].value for k in shares]
        if None in values:
            return
        left = total(x * v for x, v in zip(shares.values(), values, strict=True))
        moving = isinstance(left, Polynomial) and self._moving(left)
        if not moving and not _none(self.given, left):
            raise InputError(
                "a constraint cannot be met",
                where=f"constraint {self.bonds_[r].name}",
                got=f"{self.write(left)} for zero, however the tree moves",
            )

    def _refuse(self, waiting: set[int]) -> None:
        for r in sorted(waiting):
            tied = [self.given.speeds[c].name for c in self.rows[r] if c in self.stay]
            raise InputError(
                "a constraint binds speeds that shall be independent"
                if tied
                else "a constraint cannot be met",
                where=f"constraint {self.bonds_[r].name}",
                got=", ".join(tied) or "no speed that is free",
                hint="choose other independent speeds" if tied else "",
            )

    def _cost(self, r: int, c: int) -> tuple[int, ...]:
        x = self.rows[r][c]
        if not isinstance(x, Polynomial):
            return (0, 0, -c)
        constant = not self._moving(x)
        single = x.inverse() is not None
        return (1 if constant and single else 2 if single else 3, len(x.terms), -c)

    def _moving(self, x: Polynomial) -> bool:
        rates = self.given.rates.keys()
        return any(self.given.algebra.generators[g].free_symbols & rates for g in x.used)

    def _clear(self, r: int, c: int) -> None:
        """Divide a row by its pivot, and take it out of all others."""
        inverse = self._inverse(self.rows[r][c])
        self.determinant = self.determinant * self.rows[r][c]
        row = {k: x * inverse for k, x in self.rows[r].items() if k != c} | {c: 1}
        self.rows[r], self.pivots[r] = row, c
        for k, other in self.rows.items():
            if k != r and c in other:
                count = other[c]
                left = {n: other.get(n, 0) - count * row.get(n, 0) for n in {**other, **row}}
                self.rows[k] = {n: x for n, x in left.items() if not _none(self.given, x)}

    def _inverse(self, x: Scalar) -> Scalar:
        if not isinstance(x, Polynomial):
            return Fraction(1) / x
        single = x.inverse()
        return self.given.algebra.lift(1 / self.write(x)) if single is None else single

    def _divisors(self, made: Iterable[Scalar]) -> Iterator[Expr]:
        """Yield what moves and must not be zero: in the determinant, and below what was made."""
        rates = self.given.rates.keys()
        below = [self.determinant] if isinstance(self.determinant, Polynomial) else []
        factors = [f for x in below for f in sp.Mul.make_args(self.write(x))]
        generators = self.given.algebra.generators
        for x in (x for x in made if isinstance(x, Polynomial)):
            factors += [1 / generators[g] for m in x.terms for g, p in m if p < 0]
            factors += [generators[g] for g in x.used if generators[g].is_Pow]
        for f in factors:
            base = f.as_base_exp()[0]
            if base.free_symbols & rates:
                yield base

    def bonds(self, positive: tuple[Expr, ...]) -> Bonds:
        """Return what was found."""
        kept = [r for r in self.rows if r in self.pivots]
        dependent = {
            self.pivots[r]: {
                c: negative(x) for c, x in sorted(self.rows[r].items()) if -1 <= c != self.pivots[r]
            }
            for r in kept
        }
        inverse = {self.pivots[r]: [self.rows[r].get(-2 - k, 0) for k in kept] for r in kept}
        made = [x for row in (*dependent.values(), *(dict(enumerate(w)) for w in inverse.values()))
                for x in row.values()]  # fmt: skip
        divisors = dict.fromkeys(d for d in self._divisors(made) if d not in positive)
        return Bonds(
            whole=self.given,
            kept=tuple(self.bonds_[r] for r in kept),
            idle=tuple(self.bonds_[r].component.name for r in sorted(self.idle)),
            dependent=dict(sorted(dependent.items())),
            inverse=inverse,
            divisors=tuple(divisors),
            positive=positive,
        )


def _reduced(given: Bonds) -> Mechanism:
    """Return the mechanism over the speeds that follow no others."""
    whole = given.whole
    own = [k for k in range(len(whole.speeds)) if k not in given.dependent]
    index = whole.algebra.index
    over = {index(whole.speeds[k].symbol): given.follower(k) for k in given.dependent}

    def put(x: Scalar) -> Scalar:
        return followed(whole.algebra, x, over)

    draft = replace(whole, followers={g: put(x) for g, x in whole.followers.items()} | over)
    return replace(
        draft,
        speeds=tuple(whole.speeds[k] for k in own),
        accelerations=tuple(whole.accelerations[k] for k in own),
        free=tuple(own.index(k) for k in given.independent),
        basis=tuple(_moved(given, k) for k in own),
        joint_speeds=tuple(map(put, whole.joint_speeds)),
        pulls=tuple(_pulled(p, put) for p in whole.pulls),
        offsets={**whole.offsets, **_moved(given, -1)},
        even=frozenset(own.index(k) for k in whole.even),
    )


def _moved(given: Bonds, k: int) -> dict[Expr, Scalar]:
    """Return how fast a speed moves the coordinates, with the speeds that follow it."""
    found = dict(given.whole.basis[k]) if k >= 0 else {}
    for d, row in given.dependent.items():
        for q, rate in given.whole.basis[d].items() if k in row else ():
            found[q] = found.get(q, 0) + row[k] * rate
    return {q: x for q, x in found.items() if not is_zero(x)}


def _pulled(pull: Pull, put: Callable[[Scalar], Scalar]) -> Pull:
    force, torque, point = ([put(x) for x in v] for v in (pull.force, pull.torque, pull.point))
    return replace(pull, force=force, torque=torque, point=point)


# -- the methods under constraints ---------------------------------------------------------------


@dataclass(frozen=True)
class Bound:
    """The steps of a method under constraints.

    ``whole``: the method with every speed free; ``steps``: over the independent speeds, or, by Lagrange's
    method, ``whole`` again.
    """

    bonds: Bonds
    whole: Any
    steps: Any

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism over its independent speeds."""
        return self.bonds.mechanism

    @property
    def combined(self) -> bool:
        """Whether the equations with multipliers are combined, so that these drop out."""
        return self.steps is self.whole

    @cached_property
    def rows(self) -> list[Contribution]:
        """The contributions to the equations of all speeds, none yet expressed by others."""
        return list(self.whole.contributions())

    def contributions(self) -> list[Contribution]:
        """Return the parts of the equations of the independent speeds."""
        found = self._combined() if self.combined else self.steps.contributions()
        return [replace(c, value=self.bonds.in_place(c.value)) for c in found]

    def _combined(self) -> list[Contribution]:
        """Return each equation with those of the speeds that follow, as often as they follow."""
        bonds, found = self.bonds, []
        for row, s in enumerate(bonds.independent):
            for c in self.rows:
                mine = bonds.whole.free[c.row]
                share = 1 if mine == s else bonds.dependent.get(mine, {}).get(s, 0)
                if not is_zero(share):
                    value = bonds.over_independent(c.value * share)
                    found.append(Contribution(row, c.source, c.label, value))
        return found

    def needed(self, k: int) -> Scalar:
        """Return what constraints must give along a speed: inertia and more less applied forces."""
        row = self.bonds.whole.free.index(k)
        mine = (c for c in self.rows if c.row == row)
        return total(negative(c.value) if c.source == "applied" else c.value for c in mine)

    @cached_property
    def multipliers(self) -> list[Scalar]:
        """The multipliers of the kept equations, over the accelerations: lambda^T = L_D^T W."""
        bonds = self.bonds
        needed = {k: bonds.over_independent(self.needed(k)) for k in bonds.dependent}
        return [
            bonds.in_place(total(needed[d] * bonds.inverse[d][k] for d in bonds.dependent))
            for k in range(len(bonds.kept))
        ]


def bound(given: Bonds, method: Callable[[Mechanism], Any]) -> Bound:
    """Return a method under constraints."""
    whole = method(given.whole)
    return Bound(given, whole, whole if isinstance(whole, Lagrange) else method(given.mechanism))
