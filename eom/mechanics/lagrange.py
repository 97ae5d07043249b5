r"""Point masses and turning bodies whose places are formulas of coordinates: Lagrange's equations.

With r the place of a body and w its angular velocity, T = sum of m v.v / 2 + J w.w / 2, and the
generalised force on q is the sum of F . dr/dq over what is applied, besides those that are stated. What
keeps a body on its way is the rest: m a less all that is applied. Source: Greenwood, Advanced Dynamics
(2003), ch. 2.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import sympy as sp
from sympy.simplify.fu import TR8

from eom.errors import InputError
from eom.expressions import as_expression
from eom.quantities import TIME, Definition, Quantity
from eom.system import System

Expr = Any
Vector = tuple[Expr, ...]
EXPLICIT = 2
"""Coordinates up to which rates are solved for; beyond it the mass matrix stays."""
SEARCHED = 24
"""Terms of a sum up to which a shorter form is searched for."""


@dataclass(frozen=True)
class Placed:
    """A body of a ``mass`` (kg) ``at`` a place (m, inertial axes), over coordinates, given motions and t.

    ``moments`` (kg m^2) and ``omega`` (rad/s), over rates as well: as many of one as of the other, along
    principal axes through the centre of mass. ``force`` (N): applied at that place, in inertial axes.
    """

    mass: Expr
    at: Vector = (0, 0, 0)
    moments: Vector = ()
    omega: Vector = ()
    force: Vector = (0, 0, 0)


@dataclass(frozen=True)
class Spring:
    """A spring between two places (m): stiffness (N/m), length without force (m), the bodies there.

    ``bodies``: their names, of an end that is no body "".
    """

    ends: tuple[Vector, Vector]
    stiffness: Expr
    length: Expr = sp.S.Zero
    bodies: tuple[str, str] = ("", "")

    @property
    def span(self) -> Vector:
        """The vector from the first end to the second."""
        return tuple(as_expression(y) - x for x, y in zip(*self.ends, strict=True))

    @property
    def distance(self) -> Expr:
        """How far apart the ends are."""
        return sp.sqrt(sp.Add(*(x**2 for x in self.span)))

    @property
    def energy(self) -> Expr:
        """The potential energy (J)."""
        if self.length == 0:
            return self.stiffness * sp.Add(*(x**2 for x in self.span)) / 2
        return self.stiffness * (self.distance - self.length) ** 2 / 2

    def pull(self, name: str) -> Vector:
        """Return the force on a body (N)."""
        sign = (self.bodies[0] == name) - (self.bodies[1] == name)
        share = 1 if self.length == 0 else 1 - self.length / self.distance
        return tuple(sign * self.stiffness * share * x for x in self.span)


@dataclass(frozen=True)
class Mechanism:
    """Coordinates and what moves with them.

    ``coordinates``, ``given``: units by symbol, of those that are free and of motions that are imposed.
    ``bodies``: by name. ``gravity``: its acceleration (m/s^2, inertial axes); ``potential`` (J) besides
    weights and springs; ``forces``: generalised ones besides, by coordinate. ``reactions``: by name the
    body that is kept on its way and the direction in which that force is counted.
    """

    name: str
    coordinates: Mapping[Expr, str]
    given: Mapping[Expr, str]
    parameters: tuple[Quantity, ...]
    bodies: Mapping[str, Placed]
    gravity: Vector = (0, 0, 0)
    potential: Expr = sp.S.Zero
    springs: tuple[Spring, ...] = ()
    forces: Mapping[Expr, Expr] = field(default_factory=dict)
    reactions: Mapping[str, tuple[str, Vector]] = field(default_factory=dict)

    @property
    def moving(self) -> dict[Expr, str]:
        """All coordinates, free and given."""
        return {**self.coordinates, **self.given}

    @cached_property
    def kinetic(self) -> Expr:
        """The kinetic energy T (J), over coordinates and rates."""
        parts = []
        for body in self.bodies.values():
            v = [self.rate(x) for x in body.at]
            parts += [body.mass * x**2 / 2 for x in v]
            parts += [j * w**2 / 2 for j, w in zip(body.moments, body.omega, strict=True)]
        return _simplified(sp.Add(*parts))

    @cached_property
    def stored(self) -> Expr:
        """The potential energy V (J): of gravity, springs and what is stated."""
        weights = (
            -b.mass * g * x
            for b in self.bodies.values()
            for g, x in zip(self.gravity, b.at, strict=True)
        )
        return sp.Add(*weights, *(s.energy for s in self.springs), self.potential)

    def rate(self, expression: Expr, order: int = 1) -> Expr:
        """Return the time derivative of an expression over coordinates, rates and t."""
        found = as_expression(expression)
        names = {q: speed(q) for q in self.moving}
        names |= {speed(q): acceleration(q) for q in self.moving}
        for _ in range(order):
            terms = (found.diff(q) * new for q, new in names.items())
            found = sp.Add(found.diff(TIME), *terms)
        return found

    def applied(self, q: Expr) -> Expr:
        """Return the generalised force of all that has no potential."""
        own = (
            f * as_expression(x).diff(q)
            for b in self.bodies.values()
            for f, x in zip(b.force, b.at, strict=True)
        )
        return sp.Add(self.forces.get(q, sp.S.Zero), *own)

    def equation(self, q: Expr) -> Expr:
        """Return what is zero by Lagrange: d/dt dT/dq' - dT/dq + dV/dq - Q."""
        momentum = self.kinetic.diff(speed(q))
        return self.rate(momentum) - self.kinetic.diff(q) + self.stored.diff(q) - self.applied(q)

    def reaction(self, name: str) -> Vector:
        """Return what keeps a body on its way (N): m a less gravity, springs and what is applied.

        Raises `InputError` where a potential is stated as a whole: its force on one body is not known.
        """
        if self.potential != 0:
            raise InputError(
                "the force of this potential on one body is not known",
                where=f"reaction of {name}",
                hint="state springs, or forces at the body",
            )
        body = self.bodies[name]
        pulls = [s.pull(name) for s in self.springs]
        return tuple(
            body.mass * (self.rate(x, 2) - self.gravity[k])
            - body.force[k]
            - sp.Add(*(p[k] for p in pulls))
            for k, x in enumerate(body.at)
        )


def _simplified(expression: Expr) -> Expr:
    """Return a sum with fewer sines and cosines: products as sums where these cancel, else by search.

    In a long sum, where a search takes minutes, squares of cosines are written by those of sines.
    """
    plain = sp.expand(expression)
    if len(sp.Add.make_args(plain)) > SEARCHED:
        return _with_sines(plain)
    summed = sp.expand(TR8(plain))
    if len(summed.atoms(sp.sin, sp.cos)) < len(plain.atoms(sp.sin, sp.cos)):
        return summed
    return sp.trigsimp(plain) if plain.has(sp.sin, sp.cos) else plain


def _with_sines(plain: Expr) -> Expr:
    """Return a sum with squares of sines in the place of those of cosines where it becomes shorter."""
    for cosine in sorted(plain.atoms(sp.cos), key=sp.default_sort_key):
        square = 1 - sp.sin(cosine.args[0]) ** 2
        tried = sp.expand(plain.subs(cosine**2, square))
        if len(sp.Add.make_args(tried)) < len(sp.Add.make_args(plain)):
            plain = tried
    return plain


def speed(q: Expr) -> Expr:
    """Return the symbol of the rate of a coordinate."""
    return sp.Symbol(f"{q.name}_dot", real=True)


def acceleration(q: Expr) -> Expr:
    """Return the symbol of the second rate of a coordinate."""
    return sp.Symbol(f"{q.name}_ddot", real=True)


def lagrange_system(m: Mechanism) -> System:
    """Return the equations of motion of a mechanism.

    States: coordinates and rates, ``NAME`` and ``NAME_dot``, then given motions, whose second rates,
    ``NAME_ddot``, are inputs. Outputs: ``T``, ``V``, ``L``, ``E`` = T + V (see `LONG`), momenta
    ``p_NAME``, generalised forces ``Q_NAME``, the Hamiltonian ``H`` = sum of p q' - L, places ``BODY_x``,
    ``BODY_y``, ``BODY_z``, reactions. Raises `InputError` where a coordinate moves nothing.
    """
    free, forced = list(m.coordinates), list(m.given)
    equations = sp.Matrix([m.equation(q) for q in free])
    wanted = [acceleration(q) for q in free]
    M = equations.jacobian(wanted).applyfunc(_simplified)
    rest = -equations.xreplace(dict.fromkeys(wanted, sp.S.Zero))
    for k, q in enumerate(free):
        if M.row(k).is_zero_matrix:
            raise InputError("nothing moves with this coordinate", got=q.name)
    solved = list(M.LUsolve(rest)) if len(free) <= EXPLICIT else list(rest)
    whole = None if len(free) <= EXPLICIT else _whole(M, len(forced))
    rates = (
        *map(speed, free), *solved, *map(speed, forced), *map(acceleration, forced)
    )  # fmt: skip
    found = dict(zip(wanted, solved if whole is None else M.LUsolve(rest), strict=True))
    return System(
        name=m.name,
        states=(*_states(m.coordinates), *_states(m.given)),
        rates=rates,
        parameters=m.parameters,
        inputs=tuple(Quantity(acceleration(q), _per(u, 2), "given") for q, u in m.given.items()),
        mass_matrix=whole,
        outputs=tuple(_outputs(m, found)),
        numbers="values",
    )


def _whole(M: Expr, given: int) -> Expr:
    n = M.rows
    return sp.ImmutableMatrix(sp.diag(sp.eye(n), M, sp.eye(2 * given)))


def _states(group: Mapping[Expr, str]) -> Iterator[Quantity]:
    yield from (Quantity(q, unit, "coordinate") for q, unit in group.items())
    yield from (Quantity(speed(q), _per(unit), "rate") for q, unit in group.items())


def _per(unit: str, order: int = 1) -> str:
    return f"{unit}/s" if order == 1 else f"{unit}/s^{order}"


LONG = {"T": "kinetic_energy", "V": "potential_energy", "L": "lagrangian", "E": "energy"}
"""Names of energies where a parameter, a coordinate or a reaction has the letter."""


def _outputs(m: Mechanism, found: Mapping[Expr, Expr]) -> Iterator[Definition]:
    T, V = m.kinetic, m.stored
    taken = {str(s.name) for s in (*m.moving, *(q.symbol for q in m.parameters))} | {*m.reactions}
    for name, energy in (("T", T), ("V", V), ("L", T - V), ("E", T + V)):
        yield _output(LONG[name] if name in taken else name, "J", energy)
    for q, unit in m.coordinates.items():
        yield _output(f"p_{q.name}", "kg m^2/s" if unit == "rad" else "kg m/s", T.diff(speed(q)))
        yield _output(f"Q_{q.name}", "N m" if unit == "rad" else "N", m.applied(q))
    by_speeds = sp.Add(*(speed(q) * T.diff(speed(q)) for q in m.coordinates))
    if "H" not in taken:
        yield _output("H", "J", by_speeds - T + V)
    for name, placed in m.bodies.items():
        for axis, x in zip("xyz", placed.at, strict=True):
            yield _output(f"{name}_{axis}", "m", as_expression(x))
    for name, (body, along) in m.reactions.items():
        force = sum(f * e for f, e in zip(m.reaction(body), along, strict=True))
        yield _output(name, "N", as_expression(force).xreplace(dict(found)))


def _output(name: str, unit: str, expression: Expr) -> Definition:
    return Definition(Quantity(sp.Symbol(name, real=True), unit), expression)
