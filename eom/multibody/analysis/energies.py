"""A system by its energies, and the equations of motion that analysis looks at.

Both are of a tree, by its closed form, or are given by hand. What time or inputs drive is no part of it:
prescribed rates that are constant are parameters.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eom.derivations.verification import DerivationError
from eom.errors import InputError, shown, typed, typed_fields
from eom.exact.identity import equal, vanishes
from eom.expressions import as_expression
from eom.multibody.analysis.tidy import tidy
from eom.multibody.closed.bonds import Bound
from eom.multibody.closed.forms import ClosedForm, closed_form
from eom.multibody.closed.lagrange import Lagrange
from eom.multibody.closed.mechanism import dotted
from eom.multibody.model.model import Tree
from eom.multibody.model.names import inputs_of
from eom.quantities import TIME

Expr = Any


@dataclass(frozen=True)
class Equations:
    """Equations of motion ``mass`` u' + ``rest`` = 0 and q' = ``kinematics``, which time does not enter.

    ``coordinates``, ``speeds``, ``accelerations``: symbols, n and k of them; ``mass``: (k, k); ``rest``: k
    expressions; ``closures``: what is zero between coordinates. Units and signs are those of where they
    come from. Raises `InputError` where time enters.
    """

    name: str
    coordinates: tuple[Expr, ...]
    kinematics: tuple[Expr, ...]
    speeds: tuple[Expr, ...]
    accelerations: tuple[Expr, ...]
    mass: Expr
    rest: tuple[Expr, ...]
    closures: tuple[Expr, ...] = ()

    def __post_init__(self) -> None:
        if any(TIME in e.free_symbols for e in (*self.kinematics, *self.mass, *self.rest)):
            raise InputError(
                "time enters the equations: nothing is steady, conserved or cyclic by them",
                where=self.name,
                hint="prescribe a rate that is constant",
            )

    @property
    def residuals(self) -> tuple[Expr, ...]:
        """What the equations say is zero."""
        moved = self.mass * sp.Matrix(self.accelerations)
        return tuple(a + b for a, b in zip(moved, self.rest, strict=True))

    @cached_property
    def occurring(self) -> tuple[Expr, ...]:
        """The coordinates that the equations depend on, proved by their derivatives."""
        found: list[Expr] = []
        waiting = list(self.coordinates)
        seen = [*self.residuals, *self.closures]
        while True:
            new = [q for q in waiting if any(depends(e, q) for e in seen)]
            if not new:
                return tuple(q for q in self.coordinates if q in found)
            found += new
            waiting = [q for q in waiting if q not in new]
            seen = [self.rate(q) for q in new]

    def rate(self, q: Expr) -> Expr:
        """Return the rate of a coordinate.

        Parameters
        ----------
        q : expression
            One of ``coordinates``.

        Returns
        -------
        expression
            Over coordinates and speeds.
        """
        return self.kinematics[self.coordinates.index(q)]

    def with_symbols(self, known: Mapping[Expr, Expr]) -> Equations:
        """Return the same over other symbols.

        Parameters
        ----------
        known : mapping of expression to expressions
            The new symbol by the one in whose place it is.

        Returns
        -------
        Equations
            Units and signs stay.
        """
        names = "coordinates", "kinematics", "speeds", "accelerations", "rest", "closures"
        put = dict(known)
        made: dict[str, Any] = {n: tuple(e.xreplace(put) for e in getattr(self, n)) for n in names}
        return replace(self, mass=sp.ImmutableMatrix(self.mass.xreplace(put)), **made)

    def symbol(self, name: Any) -> Expr:
        """Return a coordinate or speed by its name.

        Parameters
        ----------
        name : str or symbol
            As it is written.

        Returns
        -------
        symbol
            Of the equations.

        Raises
        ------
        InputError
            For others.
        """
        known = {s.name: s for s in (*self.coordinates, *self.speeds)}
        if str(name) not in known:
            raise InputError(
                "no such coordinate or speed",
                where=self.name,
                got=str(name),
                expected=", ".join(known),
            )
        return known[str(name)]


def depends(e: Expr, symbol: Expr) -> bool:
    """Return whether an expression depends on a symbol, which may stand in it and drop out."""
    return symbol in e.free_symbols and not vanishes(sp.diff(e, symbol))


@typed_fields
@dataclass(frozen=True)
class Lagrangian:
    """A system by its energies: L = T - V, Rayleigh's function R, and other generalised forces.

    Parameters
    ----------
    name : str
        What the system is called.
    rates : mapping of expression to expressions
        Symbols of the rates by coordinates, in order.
    kinetic : expression
        In J, quadratic in the rates.
    potential : expression, default 0
        In J.
    dissipation : expression, default 0
        In W: half the power that dampers take.
    forces : mapping of expression to expressions, optional
        Generalised forces by coordinate (N or N m) that have no potential.

    Raises
    ------
    InputError
        For no coordinates, symbols that repeat, a kinetic energy that is no polynomial of degree
        two in the rates, and forces at no coordinate.

    Notes
    -----
    Angles in radians.

    References
    ----------
    Goldstein, Classical Mechanics (2002), sect. 1.5.

    Examples
    --------
    >>> q, u = sp.symbols("q u", real=True)
    >>> m, k = sp.symbols("m k", positive=True)
    >>> Lagrangian("oscillator", {q: u}, m * u**2 / 2, k * q**2 / 2).equations.rest
    (k*q,)
    """

    name: str
    rates: Mapping[Expr, Expr]
    kinetic: Expr
    potential: Expr = 0
    dissipation: Expr = 0
    forces: Mapping[Expr, Expr] = field(default_factory=dict)

    def __post_init__(self) -> None:
        where = f"Lagrangian {self.name!r}"
        for name in ("kinetic", "potential", "dissipation"):
            object.__setattr__(self, name, _scalar(getattr(self, name), f"{where}: {name}"))
        for name in ("rates", "forces"):
            given = getattr(self, name)
            made = {as_expression(k): _scalar(v, f"{where}: {name}") for k, v in given.items()}
            object.__setattr__(self, name, made)
        symbols = [*self.rates.keys(), *self.rates.values()]
        if not symbols or len(set(symbols)) < len(symbols) or not all(s.is_Symbol for s in symbols):
            raise InputError(
                "coordinates and rates are symbols, each once", where=where, got=shown(symbols)
            )
        for q in self.forces.keys() - self.rates.keys():
            raise InputError("a force at no coordinate", where=where, got=str(q))
        third = [
            sp.diff(self.kinetic, a, b, c)
            for a in self.speeds
            for b in self.speeds
            for c in self.speeds
        ]
        if not all(map(vanishes, third)):
            raise InputError(
                "the kinetic energy is no polynomial of degree two in the rates", where=where,
                got=str(self.kinetic),
            )  # fmt: skip

    def with_symbols(self, known: Mapping[Expr, Expr]) -> Lagrangian:
        """Return the same over other symbols.

        Parameters
        ----------
        known : mapping of expression to expressions
            The new symbol by the one in whose place it is.

        Returns
        -------
        Lagrangian
            Units and signs stay.

        Raises
        ------
        InputError
            Where two become one.
        """
        put = dict(known)
        return Lagrangian(
            self.name,
            {q.xreplace(put): u.xreplace(put) for q, u in self.rates.items()},
            self.kinetic.xreplace(put),
            self.potential.xreplace(put),
            self.dissipation.xreplace(put),
            {q.xreplace(put): e.xreplace(put) for q, e in self.forces.items()},
        )

    @property
    def coordinates(self) -> tuple[Expr, ...]:
        """The coordinates."""
        return tuple(self.rates)

    @property
    def speeds(self) -> tuple[Expr, ...]:
        """Their rates."""
        return tuple(self.rates.values())

    @property
    def expression(self) -> Expr:
        """L = T - V."""
        return self.kinetic - self.potential

    @cached_property
    def momenta(self) -> tuple[Expr, ...]:
        """The conjugate momenta dL/dq'. Raises `DerivationError` if one were not written equal."""
        return tuple(tidy(sp.diff(self.expression, u)) for u in self.speeds)

    @cached_property
    def energy(self) -> Expr:
        """Jacobi's integral: the sum of q' dL/dq', less L; T + V where T is quadratic.

        Raises `DerivationError` if it were not written equal.
        """
        moved = sum(u * p for u, p in zip(self.speeds, self.momenta, strict=True))
        return tidy(moved - self.expression)

    @cached_property
    def equations(self) -> Equations:
        """d/dt dL/dq' - dL/dq + dR/dq' = Q.

        Raises `InputError` where time enters, `DerivationError` if one were not written equal.
        """
        L = self.expression
        rest = []
        for q, u, p in zip(self.coordinates, self.speeds, self.momenta, strict=True):
            carried = sum(sp.diff(p, s) * v for s, v in self.rates.items())
            other = sp.diff(self.dissipation, u) - self.forces.get(q, 0)
            rest.append(tidy(carried - sp.diff(L, q) + other))
        mass = sp.ImmutableMatrix(
            [[tidy(sp.diff(p, u)) for u in self.speeds] for p in self.momenta]
        )
        accelerations = tuple(sp.Symbol(dotted(str(u)), real=True) for u in self.speeds)
        return Equations(
            self.name, self.coordinates, self.speeds, self.speeds, accelerations, mass, tuple(rest)
        )


def _scalar(given: Any, where: str) -> Expr:
    """Return an expression. Raises `InputError` for matrices, lists and what is none."""
    found = as_expression(given)
    if (
        not isinstance(found, sp.Expr)
        or found.is_commutative is False
        or isinstance(given, list | tuple)
    ):
        raise InputError("not an expression", where=where, got=shown(given))
    return found


@typed
def equations_of(source: ClosedForm | Lagrangian | Equations) -> Equations:
    """Return the equations of motion of a ``source``: a closed form or Lagrangian.

    Parameters
    ----------
    source : ClosedForm or Lagrangian or Equations
        A closed form or Lagrangian; equations are returned as they are.

    Returns
    -------
    Equations
        Mass matrix, rest and kinematics over coordinates, speeds and accelerations.

    Raises
    ------
    InputError
        Where time or inputs drive it.
    DerivationError
        If one were not written equal.

    Notes
    -----
    Units and signs are those of the source.

    Examples
    --------
    >>> q, u = sp.symbols("q u", real=True)
    >>> equations_of(Lagrangian("free", {q: u}, u**2 / 2)).mass
    Matrix([[1]])
    """
    if isinstance(source, Equations):
        return source
    if isinstance(source, Lagrangian):
        return source.equations
    _refuse_inputs(source)
    put = _prescribed(source)
    placed = {d.symbol for d in source.placed}
    kept = [k for k, q in enumerate(source.coordinates) if q.symbol not in placed]
    bonds = source.bonds
    closures = [b.value for b in bonds.kept if b.value is not None] if bonds else []
    written = [tidy(source.write(bonds.in_place(x))) for x in closures] if bonds else []
    return Equations(
        source.tree.name,
        tuple(source.coordinates[k].symbol for k in kept),
        tuple(put(source.kinematics[k]) for k in kept),
        tuple(u.symbol for u in source.speeds),
        source.accelerations,
        sp.ImmutableMatrix(source.mass_matrix.applyfunc(put)),
        tuple(put(-x) for x in source.forcing),
        tuple(c for c in written if c != 0),
    )


def _refuse_inputs(form: ClosedForm) -> None:
    inputs = inputs_of(form.tree)
    if inputs:
        raise InputError(
            "inputs drive the equations: nothing is steady, conserved or cyclic by them",
            where=f"tree {form.tree.name!r}",
            got=", ".join(i.name for i in inputs),
            hint="take the motors out, or give their forces as formulas",
        )


def _prescribed(form: ClosedForm) -> Any:
    known = {d.symbol: d.expression for d in form.prescribed}
    return lambda e: e.xreplace(known)


@typed
def lagrangian(tree: Tree, *, names: Mapping[str, str] | None = None) -> Lagrangian:
    """Return the energies of a tree over its coordinates and their rates.

    Parameters
    ----------
    tree : Tree
        With attitudes by angles, whose rates are the speeds; constraints are allowed that give
        coordinates outright, such as q = R.
    names : mapping of str to str, optional
        As of `closed_form`.

    Returns
    -------
    Lagrangian
        Kinetic and potential energy, dissipation and other forces.

    Raises
    ------
    InputError
        For quaternions, other constraints, and what `closed_form` refuses.
    DerivationError
        If the energies gave other equations than the closed form.

    Notes
    -----
    Units, frames and signs are those of `closed_form`, as are sources.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> m, l, g = sp.symbols("m l g", positive=True)
    >>> hinge = Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> bob = Body("bob", mass=m, centre=(0, 0, -l))
    >>> lagrangian(Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -g))).potential
    -g*l*m*cos(q_hinge)
    """
    form = closed_form(tree, "lagrange", names=names, rates=True)
    _refuse_inputs(form)
    held = form.bonds
    steps: Lagrange = form.steps.whole if isinstance(form.steps, Bound) else form.steps
    put = _prescribed(form)

    def written(x: Any) -> Expr:
        if held is not None:
            x = held.in_place(held.over_independent(x))
        return tidy(put(form.write(x)))

    rates = _rates(form)
    applied = dict(zip((u.symbol for u in form.speeds), form.column("applied"), strict=True))
    found = Lagrangian(
        tree.name,
        rates,
        written(steps.kinetic),
        written(steps.gravity + steps.springs),
        written(steps.dissipation),
        {q: tidy(put(applied[u])) for q, u in rates.items() if applied[u] != 0},
    )
    _refuse_time(found)
    _confirm(found, form, put)
    return found


def _rates(form: ClosedForm) -> dict[Expr, Expr]:
    """Return the coordinates with their rates. Raises `InputError` where speeds are others."""
    where = f"tree {form.tree.name!r}"
    held = form.bonds
    if held is not None and any(b.value is None for b in held.kept):
        raise InputError(
            "a constraint between speeds: the system has no Lagrangian of its independent speeds",
            where=where,
            got=", ".join(b.name for b in held.kept if b.value is None),
            hint="steady motions, linear motion and conserved quantities are those of its closed form",
        )
    placed = {d.symbol for d in form.placed}
    found = {}
    for q, rate in zip(form.coordinates, form.kinematics, strict=True):
        if q.symbol in placed:
            continue
        if rate not in {u.symbol for u in form.speeds}:
            bound = held is not None and any(
                q.symbol in held.whole.basis[d] for d in held.dependent
            )
            raise InputError(
                "a closed chain: a coordinate follows others, and is no formula over them"
                if bound
                else "the speeds are no rates of coordinates",
                where=where,
                got=f"rate of {q.name}: {rate}",
                hint="steady motions, linear motion and conserved quantities are those of its closed form"
                if bound
                else "describe the attitude by angles (eom analyse --attitude)",
            )
        found[q.symbol] = rate
    return found


def _refuse_time(found: Lagrangian) -> None:
    if TIME in found.expression.free_symbols:
        raise InputError("time enters the Lagrangian", where=found.name, got=str(found.expression))


def _confirm(found: Lagrangian, form: ClosedForm, put: Any) -> None:
    """Compare with the closed form: the energies stand for the same equations."""
    residuals = put(form.mass_matrix * sp.Matrix(form.accelerations) - form.forcing)
    theirs = {u.symbol: x for u, x in zip(form.speeds, residuals, strict=True)}
    ours = zip(found.coordinates, found.speeds, found.equations.residuals, strict=True)
    for q, u, x in ours:
        if not equal(x, theirs[u]):
            raise DerivationError(
                "the energies give another equation", where=f"tree {form.tree.name!r}: {q}"
            )
