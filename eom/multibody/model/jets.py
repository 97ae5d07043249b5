"""Jets: mass that leaves or enters a body, and what a body whose mass changes in time takes because of it.

A body is here what is within a surface that is fixed to it; its mass m, its centre c and its inertia
about its origin are functions of time. Momentum and angular momentum of what is within, and what leaves by
jets, give the force and the moment about the origin

    F = m a_O + alpha x S + omega x (omega x S) + 2 omega x P + P' + sum mu u,
    M = S x a_O + J alpha + omega x (J omega) + D omega + omega x h + h' + sum mu r x u,

with the first moment S = m c, the rate mu at which a jet takes mass through the point r with velocity u
relative to the body, the momentum P = S' + sum mu r of what flows in the body, relative to it, its angular
momentum h, and D = J' + sum mu (r^2 1 - r r). Primes are rates of components in the body's axes. All of it
follows from m, c, J, mu, r and u but for h: what flows has no whirl about the centre of mass, h = c x P.

Sources: Meshchersky, Dynamics of a point of variable mass (1897), with m v' = F - mu u; Thomson,
Introduction to Space Dynamics (1961), on jet damping; Eke and Wang, J. Applied Mechanics 61 (1994) p. 855.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import sympy as sp

from eom.errors import InputError, typed_fields
from eom.multibody.algebra.spatial import ZERO
from eom.multibody.algebra.values import Value, value
from eom.multibody.model import checks
from eom.multibody.model.parts import ACTING, MOVING, BodyName, Kind, Part, Position
from eom.quantities import TIME

_JUMPS = (sp.DiracDelta, sp.Derivative, sp.Subs)
"""What a second derivative that is not there is written with."""


@typed_fields
@dataclass(frozen=True)
class Jet(Part):
    """A stream of mass that leaves a ``body`` whose mass changes in time, or enters it.

    Parameters
    ----------
    name : str
        Of the jet, and its symbols.
    body : str
        Whose mass it takes.
    velocity : numbers or expressions
        Of the stream relative to the body where it passes (m/s), (3,), in the body's axes.
    point : vector, optional
        Where that is, from the body's origin, in its axes (m), (3,).
    rate : numbers or expressions, optional
        Mass that leaves (kg/s), negative for what enters, over time; of all jets of a body one
        leaves it out, and takes what the body loses beyond the others.

    Raises
    ------
    InputError
        For what is no number or expression.

    Notes
    -----
    The force on the body is the rate times the opposite of the velocity, at the point; what flows
    within the body damps its turning, and drives it as the source says.

    References
    ----------
    Thomson, Introduction to Space Dynamics (1961); the equations are in `eom.multibody.model.jets`.
    """

    noun = "jet"

    name: str
    body: BodyName
    velocity: Annotated[Any, Kind("vector", ACTING, needed=True, unit="m/s")]
    point: Position = ZERO
    rate: Annotated[Any, Kind("number", MOVING, optional=True, unit="kg/s")] = None


@dataclass(frozen=True)
class Flow:
    """What the flow in a body adds to the force and moment that it takes; about its origin, in its axes.

    ``momentum`` P and ``spin`` h of the flow relative to the body, ``force`` P' + sum mu u, ``moment``
    h' + sum mu r x u, (3,); ``damping`` D, symmetric, (3, 3).
    """

    momentum: tuple[Value, ...]
    spin: tuple[Value, ...]
    force: tuple[Value, ...]
    moment: tuple[Value, ...]
    damping: tuple[tuple[Value, ...], ...]

    @property
    def values(self) -> Iterable[Value]:
        """All of it."""
        vectors = (self.momentum, self.spin, self.force, self.moment, *self.damping)
        return (x for vector in vectors for x in vector)


def changes(body: Any) -> bool:
    """Return whether mass, centre of mass or inertia of a body change in time."""
    return any(TIME in getattr(x, "free_symbols", ()) for x in body.values)


def flow(body: Any, jets: Sequence[Jet]) -> Flow:
    """Return the flow in a body that changes in time; one of its ``jets`` has no rate.

    Raises `InputError` for masses and places whose second rates are not there.
    """
    m, c = sp.sympify(body.mass, strict=True), _column(body.centre)
    central = sp.Matrix([[sp.sympify(x, strict=True) for x in row] for row in body.central_inertia])
    J, S = central + m * _gyration(c), m * c
    streams = list(zip(rates(body, jets), jets, strict=True))
    P = S.diff(TIME) + _total(mu * _column(jet.point) for mu, jet in streams)
    h = c.cross(P)
    thrusts = [(_column(jet.point), mu * _column(jet.velocity)) for mu, jet in streams]
    force = P.diff(TIME) + _total(thrust for _, thrust in thrusts)
    moment = h.diff(TIME) + _total(r.cross(thrust) for r, thrust in thrusts)
    damping = J.diff(TIME)
    for mu, jet in streams:
        damping += mu * _gyration(_column(jet.point))
    kept = _keep(f"body {body.name!r}: mass in time")
    rows = tuple(kept(damping.row(i)) for i in range(3))
    return Flow(kept(P), kept(h), kept(force), kept(moment), rows)


def rates(body: Any, jets: Sequence[Jet]) -> list[sp.Expr]:
    """Return the rates (kg/s) of a body's ``jets``; of the one without, the rest of what the body loses."""
    known = [sp.S.Zero if jet.rate is None else sp.sympify(jet.rate, strict=True) for jet in jets]
    rest = -sp.sympify(body.mass, strict=True).diff(TIME) - sp.Add(*known)
    return [rest if jet.rate is None else mu for mu, jet in zip(known, jets, strict=True)]


def _column(given: Iterable[Any]) -> sp.Matrix:
    return sp.Matrix([sp.sympify(x, strict=True) for x in given])


def _total(vectors: Iterable[sp.Matrix]) -> sp.Matrix:
    return sum(vectors, sp.zeros(3, 1))


def _gyration(r: sp.Matrix) -> sp.Matrix:
    """Return r^2 1 - r r: by a mass, its inertia."""
    return r.dot(r) * sp.eye(3) - r * r.T


def _keep(where: str) -> Callable[[Iterable[sp.Expr]], tuple[Value, ...]]:
    """Return what makes values of expressions, and refuses rates that are not there."""

    def kept(given: Iterable[sp.Expr]) -> tuple[Value, ...]:
        found = tuple(given)
        if any(x.has(*_JUMPS) for x in found):
            raise InputError(
                "mass, centre of mass or rates of jets have a kink or a jump in time", where=where,
                expected="expressions whose first rates are smooth: the flow in the body follows them",
                hint="end the run where the jet stops, or let it rise and die away smoothly",
            )  # fmt: skip
        return tuple(value(x, where) for x in found)

    return kept


def check(
    bodies: Sequence[Any], jets: Sequence[Jet], moving: set[sp.Symbol], inputs: set[sp.Symbol]
) -> None:
    """Raise `InputError` for bodies that change by anything but time, or without a jet; and for jets.

    ``moving``: coordinates and speeds; ``inputs``: symbols that are inputs.
    """
    for body in bodies:
        _over_time_alone(body, moving | inputs)
        own = [jet for jet in jets if jet.body == body.name]
        if own:
            _one_takes_the_rest(own)
            _through(body, own)
            _possible_at_start(body)
            flow(body, own)
        elif changes(body):
            raise InputError(
                "mass, centre or inertia change in time, but no jet says with what velocity mass leaves",
                where=body.where, got=f"mass {body.mass}",
                expected=f'a jet of the body: [jets.NAME] body = "{body.name}", velocity = [0, 0, "-v"]',
                hint="what moves inside without leaving is a body on a joint with prescribed motion",
            )  # fmt: skip


def _over_time_alone(body: Any, other: set[sp.Symbol]) -> None:
    found = set().union(*(getattr(x, "free_symbols", set()) for x in body.values)) & other
    if found:
        raise InputError(
            "what a body is made of depends on states or inputs", where=body.where,
            got=", ".join(sorted(map(str, found))), expected="parameters and time",
        )  # fmt: skip


def _one_takes_the_rest(jets: Sequence[Jet]) -> None:
    free = [jet for jet in jets if jet.rate is None]
    if len(free) != 1:
        raise InputError(
            "of the jets of a body one takes the rest of what its mass loses",
            where=f"body {jets[0].body!r}", got=f"{len(free)} jets without a rate of {len(jets)}",
            expected="one jet without rate",
        )  # fmt: skip


def _possible_at_start(body: Any) -> None:
    """Raise `InputError` for a negative mass, or an inertia that no body has, at t = 0."""
    where = f"{body.where}, at t = 0"

    def at_start(given: Value) -> Value:
        return value(sp.sympify(given, strict=True).subs(TIME, 0), where)

    rows = (tuple(map(at_start, row)) for row in body.central_inertia)
    checks.body(at_start(body.mass), tuple(rows), where)


def _through(body: Any, jets: Sequence[Jet]) -> None:
    """Raise `InputError` for a single jet through which nothing goes."""
    if len(jets) == 1 and sp.sympify(body.mass, strict=True).diff(TIME) == 0:
        raise InputError(
            "the mass of the body does not change: nothing goes through its jet", where=jets[0].where,
            got=f"mass {body.mass}", expected='a function of time, such as mass = "m0 - mu*t"',
        )  # fmt: skip
