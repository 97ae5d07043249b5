"""Cyclic coordinates, their momenta, and Routh's reduction.

A coordinate is cyclic where L does not depend on it; its momentum is constant where no damper and no other
force acts along it. Routh: with R = L - sum of p q' over those, at constant p, the other coordinates move
as by the Lagrangian R. Source: Goldstein, Classical Mechanics (2002), sec. 2.6, 8.3; Greenwood, Advanced
Dynamics (2003), ch. 2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp

from eom.derivations.verification import DerivationError
from eom.errors import InputError, typed
from eom.exact.identity import equal, vanishes
from eom.multibody.analysis.energies import Lagrangian, depends
from eom.multibody.analysis.tidy import determinant, tidy

Expr = Any


@dataclass(frozen=True)
class Cyclic:
    """A coordinate that L does not depend on, and its momentum.

    ``coordinate``: its symbol; ``momentum``: dL/dq' (kg m/s, or kg m^2/s of an angle); ``rate``: of
    the momentum; ``reason``: why it is constant, or what changes it.
    """

    coordinate: Expr
    momentum: Expr
    rate: Expr
    reason: str

    @property
    def conserved(self) -> bool:
        """Whether the momentum is constant."""
        return bool(self.rate == 0)


@typed
def cyclic_coordinates(of: Lagrangian) -> tuple[Cyclic, ...]:
    """Return the cyclic coordinates ``of`` a system with their momenta, proved by the derivatives of L.

    Parameters
    ----------
    of : Lagrangian
        The energies and forces of a system.

    Returns
    -------
    tuple of Cyclic
        Each with its momentum, and how that changes where a damper or another force acts along it.

    Raises
    ------
    DerivationError
        If a rearranged formula were not equal.

    Notes
    -----
    Proved by the derivatives of L. Units and signs are those of the Lagrangian.

    References
    ----------
    Goldstein, Classical Mechanics (2002), sec. 2.6.

    Examples
    --------
    >>> x, u = sp.symbols("x u", real=True)
    >>> m = sp.Symbol("m", positive=True)
    >>> found = cyclic_coordinates(Lagrangian("free", {x: u}, m * u**2 / 2))
    >>> found[0].momentum, found[0].conserved
    (m*u, True)
    """
    found = []
    for (q, u), p in zip(of.rates.items(), of.momenta, strict=True):
        if depends(of.expression, q):
            continue
        drag = tidy(-sp.diff(of.dissipation, u))
        force = tidy(of.forces.get(q, sp.S.Zero))
        causes = [w for w, x in (("damping", drag), ("an applied force", force)) if x != 0]
        reason = f"{' and '.join(causes)} along {q}" if causes else f"L does not depend on {q}"
        found.append(Cyclic(q, p, tidy(drag + force), reason))
    return tuple(found)


@dataclass(frozen=True)
class Routhian:
    """What is left of a system when momenta of cyclic coordinates are kept.

    ``momenta``: symbols by cyclic coordinate; ``rates``: of the cyclic coordinates, over these and the
    others; ``lagrangian``: of the others, at constant momenta: its potential is the effective potential.
    """

    momenta: Mapping[Expr, Expr]
    rates: Mapping[Expr, Expr]
    lagrangian: Lagrangian

    @property
    def effective_potential(self) -> Expr:
        """The potential energy of the motion that is left (J)."""
        return self.lagrangian.potential

    @cached_property
    def expression(self) -> Expr:
        """R = L - sum of p q'."""
        return self.lagrangian.expression


@typed
def routh(of: Lagrangian, coordinates: Sequence[str] | None = None) -> Routhian:
    """Return Routh's reduction ``of`` a system by cyclic coordinates whose momenta are constant.

    Parameters
    ----------
    of : Lagrangian
        The energies of a system.
    coordinates : sequence of str, optional
        Names of cyclic coordinates whose momenta are constant, by default all.

    Returns
    -------
    Routhian
        The Lagrangian of the other coordinates, over momenta ``p_<coordinate>``. That its equations
        are those of the whole system is proved.

    Raises
    ------
    InputError
        For coordinates that are not cyclic or not conserved, and for none.
    DerivationError
        If the proof failed.

    Notes
    -----
    Units and signs are those of the Lagrangian.

    References
    ----------
    Goldstein, Classical Mechanics (2002), sec. 8.3.

    Examples
    --------
    >>> r, u, phi, w = sp.symbols("r u phi w", real=True)
    >>> m, k = sp.symbols("m k", positive=True)
    >>> kepler = Lagrangian("Kepler", {r: u, phi: w}, m * (u**2 + r**2 * w**2) / 2, -k / r)
    >>> routh(kepler).effective_potential
    -k/r + p_phi**2/(2*m*r**2)
    """
    chosen = _chosen(of, coordinates)
    p = {q: sp.Symbol(f"p_{q}", real=True) for q in chosen}
    rates = _solved(of, p)
    put = {of.rates[q]: x for q, x in rates.items()}
    R = of.expression.xreplace(put) - sum(p[q] * x for q, x in rates.items())
    others = {q: u for q, u in of.rates.items() if q not in chosen}
    still = dict.fromkeys(others.values(), sp.S.Zero)
    potential = _potential(of, p, tidy(-R.xreplace(still)))
    kinetic = tidy(R + potential)
    forces = {q: tidy(x.xreplace(put)) for q, x in of.forces.items() if q in others}
    dissipation = tidy(of.dissipation.xreplace(put))
    if not others:
        raise InputError("nothing is left to move", where=of.name, hint="name fewer coordinates")
    made = Lagrangian(of.name, others, kinetic, potential, dissipation, forces)
    found = Routhian(p, rates, made)
    _prove(of, found, put)
    return found


def _potential(of: Lagrangian, p: Mapping[Expr, Expr], found: Expr) -> Expr:
    """Return an effective potential as V and squares of momenta, which is tested: p A^-1 p as L D L^T.

    The last momentum by itself, then each less what those behind it bring.
    """
    still = dict.fromkeys(of.speeds, sp.S.Zero)
    momenta = dict(zip(of.coordinates, of.momenta, strict=True))
    A = {(i, j): sp.diff(momenta[i], of.rates[j]) for i in p for j in p}
    left = {q: p[q] - momenta[q].xreplace(still) for q in p}
    squares = []
    waiting = list(p)
    while waiting:
        k = waiting.pop()
        pivot = tidy(A[k, k])
        squares.append(tidy(left[k]) ** 2 / (2 * pivot))
        for i in waiting:
            share = tidy(A[i, k] / pivot)
            left[i] = left[i] - share * left[k]
            A |= {(i, j): tidy(A[i, j] - share * A[k, j]) for j in waiting}
    written = tidy(-of.expression.xreplace(still)) + sp.Add(*squares)
    if not equal(written, found):
        raise DerivationError("an effective potential has another value", where=of.name)
    return written


def _chosen(of: Lagrangian, names: Sequence[str] | None) -> list[Expr]:
    cyclic = {str(c.coordinate): c for c in cyclic_coordinates(of)}
    known = {str(q) for q in of.rates}
    if names is None:
        names = [n for n, c in cyclic.items() if c.conserved]
        if not names:
            raise InputError(
                "no momentum is conserved", where=of.name, got=", ".join(cyclic) or "none"
            )
    for name in names:
        if str(name) not in known:
            raise InputError(
                "no such coordinate",
                where=of.name,
                got=str(name),
                expected=", ".join(sorted(known)),
            )
        if str(name) not in cyclic:
            raise InputError("the coordinate is not cyclic", where=of.name, got=str(name))
        if not cyclic[str(name)].conserved:
            reason = cyclic[str(name)].reason
            raise InputError(
                "the momentum is not conserved", where=f"{of.name}: {name}", got=reason
            )
    if not names:
        raise InputError("no coordinate is named", where=of.name)
    return [cyclic[str(n)].coordinate for n in dict.fromkeys(map(str, names))]


def _solved(of: Lagrangian, p: Mapping[Expr, Expr]) -> dict[Expr, Expr]:
    """Return the rates of cyclic coordinates from their momenta, by Cramer's rule."""
    momenta = dict(zip(of.coordinates, of.momenta, strict=True))
    speeds = [of.rates[q] for q in p]
    A = [[tidy(sp.diff(momenta[q], u)) for u in speeds] for q in p]
    still = dict.fromkeys(speeds, sp.S.Zero)
    b = [p[q] - momenta[q].xreplace(still) for q in p]
    whole = tidy(determinant(A))
    if whole == 0:
        raise InputError("a cyclic coordinate moves no inertia", where=of.name)
    return {
        q: tidy(determinant([[b[i] if j == k else x for j, x in enumerate(row)]
                             for i, row in enumerate(A)]) / whole)
        for k, q in enumerate(p)
    }  # fmt: skip


def _prove(of: Lagrangian, found: Routhian, put: Mapping[Expr, Expr]) -> None:
    """Compare the equations of what is left with those of the whole, cyclic accelerations put in."""
    whole, left = of.equations, found.lagrangian.equations
    names = dict(zip(whole.speeds, whole.accelerations, strict=True))
    over = {**found.lagrangian.rates, **{u: names[u] for u in left.speeds}}
    known = {
        names[u]: sum((sp.diff(x, s) * v for s, v in over.items()), sp.S.Zero)
        for u, x in put.items()
    }
    same = dict(zip(left.accelerations, (names[u] for u in left.speeds), strict=True))
    for q, ours in zip(left.coordinates, left.residuals, strict=True):
        theirs = whole.residuals[whole.coordinates.index(q)].xreplace(known).xreplace(dict(put))
        if not vanishes(ours.xreplace(same) - theirs):
            raise DerivationError("Routh's reduction changes an equation", where=f"{of.name}: {q}")
