"""Steady motions as equations, the linear motion about them in symbols, and when it is stable.

In a steady motion the coordinates that the equations depend on are constant, and so are all speeds. The
linear motion about it has the characteristic polynomial det P(s); a zero root stands for a change into a
steady motion nearby (or for what a constant of the motion keeps), and is put aside. Stability conditions
are Hurwitz's determinants. A polynomial in s^2, as of conservative systems, has no roots with negative
real parts alone; its roots are imaginary and simple if those of p(x), x = s^2, are negative and
simple, which is so if p(s^2) + s p'(s^2) is Hurwitz's (theorem of Hermite and Biehler).
Source: Gantmacher, The Theory of Matrices, vol. II (1959), ch. XV; Greenwood, Advanced Dynamics (2003),
ch. 2, for linear motion about steady motion.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import InputError, shown, typed
from eom.exact.identity import vanishes
from eom.expressions import as_expression
from eom.multibody.analysis.energies import Equations, Lagrangian, equations_of
from eom.multibody.analysis.tidy import condition, determinant, tidy
from eom.multibody.closed.forms import ClosedForm

Expr = Any
S = sp.Symbol("s")
"""The variable of characteristic polynomials (1/s)."""
LARGEST = 20
"""Order in small changes."""


@dataclass(frozen=True)
class SteadyMotion:
    """A steady motion: what is constant has its values, and ``conditions`` are zero.

    ``values``: of the coordinates that occur and of all speeds; what is free stands for itself.
    """

    equations: Equations
    values: Mapping[Expr, Expr]
    conditions: tuple[Expr, ...]

    @property
    def placed(self) -> bool:
        """Whether all that is left to be met are closures between coordinates: where, not how it moves.

        Raises `DerivationError` if a formula were not written equal.
        """
        put = dict(self.values)
        closures = (tidy(c.xreplace(put)) for c in self.equations.closures)
        return {*self.conditions} <= {_factored(c) for c in closures}

    def solved(self, name: str) -> SteadyMotion:
        """Return it with one of its symbols found from a condition that is linear in it.

        Parameters
        ----------
        name : str
            Of a coordinate's or speed's value, or of a parameter.

        Returns
        -------
        SteadyMotion
            The condition that gives it is left out.

        Raises
        ------
        InputError
            Where none is linear in it.
        DerivationError
            If a formula were not written equal.
        """
        for k, c in enumerate(self.conditions):
            for symbol in (s for s in c.free_symbols if s.name == name):
                slope = tidy(sp.diff(c, symbol))
                if slope == 0 or symbol in slope.free_symbols:
                    continue
                value = tidy(-c.xreplace({symbol: sp.S.Zero}) / slope)
                if value == 0 and symbol.is_nonzero:
                    continue
                put = {symbol: value}
                rest = tuple(tidy(x.xreplace(put)) for n, x in enumerate(self.conditions) if n != k)
                values = {q: as_expression(x).xreplace(put) for q, x in self.values.items()}
                values |= put
                return replace(self, values=values, conditions=tuple(x for x in rest if x != 0))
        raise InputError(
            "no condition is linear in it", where=f"steady motion of {self.equations.name}", got=name,
            expected=", ".join(sorted({s.name for c in self.conditions for s in c.free_symbols})),
        )  # fmt: skip


@typed
def steady_motion(
    source: ClosedForm | Lagrangian | Equations, values: Mapping[str, Any] | None = None
) -> SteadyMotion:
    """Return the steady motions of a ``source`` as equations between what is constant.

    Parameters
    ----------
    source : ClosedForm or Lagrangian or Equations
        A closed form, a Lagrangian or equations.
    values : mapping of str to objects, optional
        Numbers or expressions by name of coordinates or speeds; a speed that is the rate of a
        coordinate that occurs is zero.

    Returns
    -------
    SteadyMotion
        Equations between what is constant. Conditions that hold by themselves are left out.

    Raises
    ------
    InputError
        For unknown names and where no values are steady.

    Notes
    -----
    Units and signs are those of the source.

    References
    ----------
    Greenwood, Advanced Dynamics (2003), ch. 2.

    Examples
    --------
    >>> q, u = sp.symbols("q u", real=True)
    >>> g, w, R = sp.symbols("g w R", positive=True)
    >>> hoop = Lagrangian("hoop", {q: u}, R**2 * (u**2 + w**2 * sp.sin(q)**2) / 2, -g * R * sp.cos(q))
    >>> steady_motion(hoop).conditions
    (R*(-R*w**2*cos(q) + g)*sin(q),)
    """
    given = equations_of(source)
    chosen = {given.symbol(n): as_expression(x) for n, x in dict(values or {}).items()}
    found = {s: chosen.get(s, s) for s in (*given.occurring, *given.speeds)}
    moved = [given.rate(q) for q in given.occurring]
    for rate in moved:
        if rate in given.speeds:
            if not vanishes(chosen.get(rate, sp.S.Zero)):
                raise InputError(
                    "the coordinate would not be constant", where=given.name, got=str(rate)
                )
            found[rate] = sp.S.Zero
    still = (*moved, *given.rest, *given.closures)
    conditions = []
    for e in dict.fromkeys(still):
        left = _put(e, found)
        if left != 0:
            conditions.append(left)
        if left != 0 and not left.free_symbols:
            raise InputError(
                "no such motion is steady", where=given.name, got=f"{left} for zero",
                hint="leave values free, to see what they must satisfy",
            )  # fmt: skip
    for symbol in chosen.keys() - found.keys():
        raise InputError(
            "the equations do not depend on it", where=given.name, got=str(symbol),
            expected=", ".join(map(str, found)),
        )  # fmt: skip
    return SteadyMotion(given, found, tuple(map(_factored, conditions)))


def _put(e: Expr, values: Mapping[Expr, Expr]) -> Expr:
    return tidy(e.xreplace(dict(values)))


def _factored(e: Expr) -> Expr:
    """Return a product where there is one; which factor vanishes decides the motion."""
    return min((e, sp.factor(e)), key=lambda x: (not isinstance(x, sp.Mul), int(sp.count_ops(x))))


@dataclass(frozen=True)
class Linearised:
    """Linear motion about a steady motion: P(d/dt) z = 0 for small changes z of ``variables``.

    ``about``: the steady motion. ``variables``: coordinates that occur, and speeds that are not their
    rates. ``mass``, ``damping``, ``stiffness``: P(s) = mass s^2 + damping s + stiffness; damping holds
    gyroscopic terms, too.
    ``coefficients``: of the characteristic polynomial, the leading one 1, zero roots put aside;
    ``zeros``: how many these are.
    """

    about: SteadyMotion
    variables: tuple[Expr, ...]
    mass: Expr
    damping: Expr
    stiffness: Expr
    coefficients: tuple[Expr, ...]
    zeros: int

    @property
    def polynomial(self) -> Expr:
        """The characteristic polynomial in s, without its zero roots."""
        n = len(self.coefficients) - 1
        return sp.Add(*(c * S ** (n - k) for k, c in enumerate(self.coefficients)))

    @property
    def even(self) -> bool:
        """Whether it is a polynomial in s^2, proved."""
        return len(self.coefficients) % 2 == 1 and not any(self.coefficients[1::2])


@typed
def linearised(about: SteadyMotion) -> Linearised:
    """Return the linear motion ``about`` a steady motion, in symbols.

    Parameters
    ----------
    about : SteadyMotion
        Of `steady_motion`. Conditions that are not solved (`SteadyMotion.solved`) are left as they
        are: the formulas hold where they do.

    Returns
    -------
    Linearised
        Matrices of mass, damping and stiffness in symbols, and the characteristic polynomial.

    Raises
    ------
    InputError
        Where the mass matrix is singular there.
    DerivationError
        If a formula were not written equal.

    Notes
    -----
    SI units, or those of the source; signs are those of the source.

    References
    ----------
    Greenwood, Advanced Dynamics (2003), ch. 2.

    Examples
    --------
    >>> q, u = sp.symbols("q u", real=True)
    >>> m, k = sp.symbols("m k", positive=True)
    >>> L = Lagrangian("oscillator", {q: u}, m * u**2 / 2, k * q**2 / 2)
    >>> linearised(steady_motion(L, {"q": 0})).polynomial
    k/m + s**2
    """
    given = about.equations
    paired = {given.rate(q): q for q in given.occurring if given.rate(q) in given.speeds}
    alone = [q for q in given.occurring if q not in paired.values()]
    columns = [paired.get(u, u) for u in given.speeds] + alone
    rows = [
        _row(about, paired, columns, e, m)
        for e, m in zip(given.rest, _mass_rows(given), strict=True)
    ]
    rows += [_row(about, paired, columns, -given.rate(q), {q: 1}) for q in alone]
    M, D, K = (sp.ImmutableMatrix([[x[k] for x in row] for row in rows]) for k in (2, 1, 0))
    P = M * S**2 + D * S + K  # a speed that is no rate of what occurs has one power less
    whole = sp.Poly(sp.expand(determinant(P.tolist())), S)
    found = [tidy(c) for c in whole.all_coeffs()]
    while found and found[0] == 0:
        found.pop(0)
    if not found:
        raise InputError("the linear motion has no determinate form there", where=given.name)
    zeros = 0
    while len(found) > 1 and found[-1] == 0:
        found.pop()
        zeros += 1
    monic = tuple(tidy(c / found[0]) for c in found)
    return Linearised(about, tuple(columns), M, D, K, monic, zeros)


def _mass_rows(given: Equations) -> list[dict[Expr, Expr]]:
    """Return the coefficients of the rates of speeds, a row an equation."""
    rows = given.mass.tolist()
    return [dict(zip(given.speeds, row, strict=True)) for row in rows]


def _row(
    about: SteadyMotion,
    paired: Mapping[Expr, Expr],
    columns: Sequence[Expr],
    e: Expr,
    moved: Mapping[Expr, Expr],
) -> list[tuple[Expr, Expr, Expr]]:
    """Return the powers 0, 1, 2 of s by column: ``moved`` of what changes, and the slopes of ``e``."""
    found = {c: [sp.S.Zero, sp.S.Zero, sp.S.Zero] for c in columns}
    for symbol, coefficient in moved.items():
        place = 2 if symbol in paired else 1
        found[paired.get(symbol, symbol)][place] += coefficient
    for symbol in (*about.equations.occurring, *about.equations.speeds):
        place = 1 if symbol in paired else 0
        found[paired.get(symbol, symbol)][place] += sp.diff(e, symbol)
    made = [tuple(_put(as_expression(x), about.values) for x in found[c]) for c in columns]
    return [(x[0], x[1], x[2]) for x in made]


@dataclass(frozen=True)
class Stability:
    """When linear motion is stable: all ``conditions`` are positive.

    ``asymptotic``: whether small changes die out then; else they stay small oscillations, which is what
    a conservative system can do, and says nothing of what is beyond linear. ``never``: whether a
    condition fails for all parameters. ``zeros``: roots that were put aside.
    """

    conditions: tuple[Expr, ...]
    asymptotic: bool
    never: bool
    zeros: int


@typed
def stability(of: Linearised) -> Stability:
    """Return the conditions of stability ``of`` a linear motion as expressions that must be positive.

    Parameters
    ----------
    of : Linearised
        Of `linearised`.

    Returns
    -------
    Stability
        Expressions that must be positive. Factors that are positive by what is known of their
        symbols are left out, and conditions that hold by themselves.

    Notes
    -----
    Units follow from the coefficients.

    References
    ----------
    Hurwitz's determinants, Gantmacher, The Theory of Matrices, vol. II (1959), ch. XV.

    Examples
    --------
    >>> q, u = sp.symbols("q u", real=True)
    >>> m, k, d = sp.symbols("m k d", real=True)
    >>> L = Lagrangian("damped", {q: u}, u**2 / 2, k * q**2 / 2, d * u**2 / 2)
    >>> stability(linearised(steady_motion(L, {"q": 0}))).conditions
    (d, k)
    """
    coefficients = list(of.coefficients)
    if of.even and len(coefficients) > 1:
        coefficients = _interlaced(coefficients[::2])
    found = list(dict.fromkeys(map(condition, _hurwitz(coefficients))))
    never = any(c is False or c == sp.S.NegativeOne for c in found)
    open_ones = tuple(c for c in found if not isinstance(c, bool))
    return Stability(open_ones, not of.even, never, of.zeros)


def _interlaced(p: Sequence[Expr]) -> list[Expr]:
    """Return the coefficients of p(s^2) + s p'(s^2)."""
    n = len(p) - 1
    pairs = ((c, (n - k) * c) for k, c in enumerate(p))
    return [x for pair in pairs for x in pair][:-1]


def _hurwitz(c: Sequence[Expr]) -> Iterable[Expr]:
    """Yield what must be positive: Hurwitz's determinants, the last one over the one before."""
    n = len(c) - 1
    matrix = [
        [c[2 * j - i + 1] if 0 <= 2 * j - i + 1 <= n else sp.S.Zero for j in range(n)]
        for i in range(n)
    ]
    for size in range(1, n):
        yield determinant([row[:size] for row in matrix[:size]])
    if n:
        yield c[n]


@dataclass(frozen=True)
class SmallMotion:
    """Equations of motion to an ``order`` in small changes: what is zero, by polynomials.

    ``about``: values that coordinates and speeds are near to. Coordinates, speeds and accelerations in
    ``equations`` are the changes, under the names of what changes.
    """

    order: int
    about: Mapping[Expr, Expr]
    equations: tuple[Expr, ...]

    @cached_property
    def linear(self) -> bool:
        """Whether nothing is kept but what is linear."""
        return self.order == 1


@typed
def small_motion(
    source: ClosedForm | Lagrangian | Equations,
    order: int = 1,
    about: Mapping[str, Any] | None = None,
) -> SmallMotion:
    """Return the equations of motion of a ``source`` for small coordinates and speeds, to an order.

    Parameters
    ----------
    source : ClosedForm or Lagrangian or Equations
        A closed form, a Lagrangian or equations.
    order : int, default 1
        Every product of up to so many small quantities is kept, 1 to 20.
    about : mapping of str to objects, optional
        Values that coordinates and speeds are near to, by name, 0 if left out.

    Returns
    -------
    SmallMotion
        Taylor's series of the equations; coordinates that occur, speeds and accelerations are small
        of the first order.

    Raises
    ------
    InputError
        For an order below 1 or above 20, unknown names, and where the equations have no series.

    Notes
    -----
    Units and signs are those of the source.

    Examples
    --------
    >>> q, u = sp.symbols("q u", real=True)
    >>> pendulum = Lagrangian("pendulum", {q: u}, u**2 / 2, -sp.cos(q))
    >>> small_motion(pendulum, 3).equations
    (-q**3/6 + q + u_dot,)
    """
    given = equations_of(source)
    if isinstance(order, bool) or not isinstance(order, int) or not 1 <= order <= LARGEST:
        raise InputError(
            f"the order is no whole number from 1 to {LARGEST}", where=given.name, got=shown(order)
        )
    near = {given.symbol(n): as_expression(x) for n, x in dict(about or {}).items()}
    scale = sp.Dummy("scale")
    moving = (*given.occurring, *given.speeds, *given.accelerations)
    scaled = {s: near.get(s, sp.S.Zero) + scale * s for s in moving}
    found = []
    for e in given.residuals:
        series, term = sp.S.Zero, e.xreplace(scaled)
        for k in range(order + 1):
            value = term.xreplace({scale: sp.S.Zero}).doit()
            if value.has(sp.zoo, sp.nan, sp.oo):
                raise InputError("the equations have no series there", where=given.name, got=str(e))
            series += value / sp.factorial(k)
            term = sp.diff(term, scale)
        found.append(sp.expand(series))
    return SmallMotion(order, {s: near.get(s, sp.S.Zero) for s in moving}, tuple(found))
