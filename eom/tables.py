"""One-dimensional tables: measured curves that stand in equations as functions.

>>> x = sp.Symbol("x", real=True)
>>> lift = Table("lift", [0, 10, 20], [0, 1.1, 0.8])
>>> lift(x / 2), lift(x / 2).diff(x), lift(15).evalf(4)
(lift(x/2), lift'(x/2)/2, 0.9500)
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cached_property
from math import isfinite
from typing import Any, Self

import sympy as sp

from eom.errors import InputError, entries, is_text, quoted, shown, unknown_name
from eom.system import as_expression

Expr = Any
Rows = tuple[tuple[Fraction, ...], ...]
DIGITS = 50
"""Slopes of splines are solved for with so many digits and rounded once."""
OUTSIDE = {
    "hold": "the end values go on",
    "linear": "the end slopes go on",
}


MOST_DERIVATIVES = 100
"""How often a table is differentiated at most; from the fourth time on it is zero."""


@dataclass(frozen=True)
class Table:
    """A function of one variable, given by values at breakpoints; call it on an expression.

    Parameters
    ----------
    name : str
        By which generated code calls it.
    breakpoints : tuple of floats
        With ``values`` K numbers each, K at least 2; they increase, in any consistent units.
    values : tuple of floats
        K numbers.
    kind : str, default "linear"
        ``linear``; ``cubic``, the spline with two continuous derivatives and not-a-knot ends, which
        may overshoot; ``pchip``, cubic with one continuous derivative, monotone where the values
        are.
    outside : str, default "hold"
        What holds beyond the first and last breakpoint: ``hold``, the end values, or ``linear``,
        the end slopes.
    order : int, default 0
        How often the function has been differentiated; at a breakpoint a derivative that jumps has
        its value from the right.

    Raises
    ------
    InputError
        For fewer than two breakpoints, breakpoints that do not increase, numbers that are not
        finite, lists of different lengths, and unknown words.

    References
    ----------
    de Boor, A Practical Guide to Splines (1978), ch. IV; Fritsch and Butland, SIAM J. Sci. Stat.
    Comput. 5, 1984.
    """

    name: str
    breakpoints: tuple[float, ...]
    values: tuple[float, ...]
    kind: str = "linear"
    outside: str = "hold"
    order: int = 0

    def __post_init__(self) -> None:
        if not is_text(self.name) or not self.name.strip():
            raise InputError("a table needs a name", got=shown(self.name))
        where = f"table {self.name!r}"
        for field in ("breakpoints", "values"):
            object.__setattr__(self, field, _numbers(getattr(self, field), field, where))
        if not (isinstance(self.order, int) and 0 <= self.order <= MOST_DERIVATIVES):
            raise InputError("a table has no such derivative", where=where, got=shown(self.order))
        _check(self, where)

    def __call__(self, argument: Any) -> Expr:
        """Return the function applied to an expression.

        Parameters
        ----------
        argument : object
            In the unit of the breakpoints.

        Returns
        -------
        expression
            In the unit of the values.

        Raises
        ------
        InputError
            For text.
        """
        return TableFunction(_Data(self), as_expression(argument))

    @property
    def derivative(self) -> Table:
        """The table of the derivative."""
        return replace(self, order=self.order + 1)

    @property
    def degree(self) -> int:
        """Degree of the polynomials between breakpoints; -1 if all of them are zero."""
        return max(_DEGREES[self.kind] - self.order, -1)

    @property
    def label(self) -> str:
        """The name, with a prime for each differentiation."""
        return self.name + "'" * self.order

    @property
    def flat_outside(self) -> bool:
        """Whether the function is constant on each side beyond the breakpoints."""
        return not any(any(row[1:]) for row in (self.exact_rows[0], self.exact_rows[-1]))

    @cached_property
    def exact_rows(self) -> Rows:
        """Coefficients c0, c1, ... of each polynomial in x - a; the last one ends at infinity.

        Row 0 holds below the first breakpoint and a is that breakpoint; row i holds from breakpoint
        a = ``breakpoints[i - 1]`` on. All rows have the same length.
        """
        rows = _polynomials(self)
        for _ in range(self.order):
            rows = tuple(tuple(k * c for k, c in enumerate(row))[1:] for row in rows)
        width = max(self.degree, 0) + 1
        return tuple((*row, *[Fraction(0)] * width)[:width] for row in rows)

    @cached_property
    def rows(self) -> tuple[tuple[float, ...], ...]:
        """`exact_rows`, each coefficient rounded to the nearest double."""
        return tuple(tuple(map(float, row)) for row in self.exact_rows)

    def anchor(self, x: Any) -> tuple[int, float]:
        """Return the row that holds at a place, and the breakpoint that it counts from.

        Parameters
        ----------
        x : number
            In the unit of the breakpoints.

        Returns
        -------
        tuple of int, float
            The number of the row, from 0, and the breakpoint.
        """
        row = bisect_right(self.breakpoints, x)
        return row, self.breakpoints[max(row - 1, 0)]

    def at(self, x: Fraction) -> Fraction:
        """Return the exact value at a rational number.

        Parameters
        ----------
        x : Fraction
            In the unit of the breakpoints.

        Returns
        -------
        Fraction
            Breakpoints and values are taken as the doubles that they are.
        """
        row, start = self.anchor(x)
        value, h = Fraction(0), x - Fraction(start)
        for c in reversed(self.exact_rows[row]):
            value = value * h + c
        return value


def _numbers(given: Any, field: str, where: str) -> tuple[float, ...]:
    try:
        numbers = tuple(float(v) for v in entries(given, where))
    except (TypeError, ValueError, OverflowError):  # an `InputError` is a `ValueError`
        raise InputError(
            f"{field} of a table are not numbers", where=where, got=quoted(given)
        ) from None
    wrong = next((k for k, v in enumerate(numbers) if not isfinite(v)), None)
    if wrong is not None:
        raise InputError(
            f"{field} of a table are not finite",
            where=where,
            got=f"entry {wrong + 1}: {numbers[wrong]}",
        )
    return numbers


def _check(table: Table, where: str) -> None:
    b = table.breakpoints
    if len(b) != len(table.values):
        raise InputError(
            "breakpoints and values of a table differ in number",
            where=where,
            got=f"{len(b)} breakpoints, {len(table.values)} values",
        )
    if len(b) < 2:
        raise InputError("a table needs two breakpoints at least", where=where, got=len(b))
    back = next((k for k in range(1, len(b)) if not b[k - 1] < b[k]), None)
    if back is not None:
        raise InputError(
            "breakpoints of a table do not increase",
            where=where,
            got=f"{b[back - 1]!r}, {b[back]!r} at places {back} and {back + 1}",
            hint="sort the pairs, and keep one of those with the same breakpoint",
        )
    for word, known, what in ((table.kind, _SLOPES, "kind"), (table.outside, OUTSIDE, "outside")):
        if not isinstance(word, str) or word not in known:
            raise unknown_name(f"{what} of table", word, known, where)
    try:
        _ = table.rows
    except OverflowError:
        raise InputError(
            "a slope of a table is beyond double precision",
            where=where,
            hint="scale breakpoints or values",
        ) from None


# -- polynomials between the breakpoints --------------------------------------------------------------


def _polynomials(table: Table) -> Rows:
    """Return the rows of the table before any differentiation."""
    x, y = ([Fraction(v) for v in values] for values in (table.breakpoints, table.values))
    slopes = _SLOPES[table.kind](table.breakpoints, table.values)
    secants = [(y[k + 1] - y[k]) / (x[k + 1] - x[k]) for k in range(len(x) - 1)]
    inner: list[tuple[Fraction, ...]]
    if slopes is None:
        inner = [(y[k], s) for k, s in enumerate(secants)]
        ends = secants[0], secants[-1]
    else:
        inner = [
            _hermite(x[k + 1] - x[k], y[k], secants[k], slopes[k], slopes[k + 1])
            for k in range(len(secants))
        ]
        ends = slopes[0], slopes[-1]
    below, above = ((v, s if table.outside == "linear" else Fraction(0)) for v, s in
                    ((y[0], ends[0]), (y[-1], ends[1])))  # fmt: skip
    return (below, *inner, above)


def _hermite(
    h: Fraction, y: Fraction, secant: Fraction, left: Fraction, right: Fraction
) -> tuple[Fraction, ...]:
    """Coefficients of the cubic with slopes ``left`` and ``right`` at the ends of an interval."""
    return (y, left, (3 * secant - 2 * left - right) / h, (left + right - 2 * secant) / h**2)


Slopes = Callable[[Sequence[float], Sequence[float]], list[Fraction] | None]


def _rounded(slopes: Callable[[list[Decimal], list[Decimal]], list[Decimal]]) -> Slopes:
    """Solve for the slopes at the breakpoints with `DIGITS` digits from steps and secants."""

    def solve(x: Sequence[float], y: Sequence[float]) -> list[Fraction]:
        with localcontext() as context:
            context.prec = DIGITS
            a, b = ([Decimal(v) for v in values] for values in (x, y))
            h = [a[k + 1] - a[k] for k in range(len(a) - 1)]
            d = [(b[k + 1] - b[k]) / h[k] for k in range(len(h))]
            found = d * 2 if len(d) == 1 else slopes(h, d)
            return [Fraction(float(s)) if isfinite(float(s)) else _too_large() for s in found]

    return solve


def _too_large() -> Fraction:
    raise OverflowError


def _not_a_knot(h: list[Decimal], d: list[Decimal]) -> list[Decimal]:
    """Slopes of the spline whose third derivative does not jump at the second breakpoints.

    With three breakpoints it is the parabola through them.
    """
    n = len(d) + 1
    if n == 3:
        middle = (h[1] * d[0] + h[0] * d[1]) / (h[0] + h[1])
        return [2 * d[0] - middle, middle, 2 * d[1] - middle]
    lower = [Decimal(0), *h[1:], h[-1] + h[-2]]
    diagonal = [h[1], *(2 * (h[k - 1] + h[k]) for k in range(1, n - 1)), h[-2]]
    upper = [h[0] + h[1], *h[:-1], Decimal(0)]
    right = [
        _end(h[0], h[1], d[0], d[1]),
        *(3 * (h[k] * d[k - 1] + h[k - 1] * d[k]) for k in range(1, n - 1)),
        _end(h[-1], h[-2], d[-1], d[-2]),
    ]
    for k in range(1, n):
        factor = lower[k] / diagonal[k - 1]
        diagonal[k] -= factor * upper[k - 1]
        right[k] -= factor * right[k - 1]
    slopes = [right[-1] / diagonal[-1]]
    for k in range(n - 2, -1, -1):
        slopes.append((right[k] - upper[k] * slopes[-1]) / diagonal[k])
    return slopes[::-1]


def _end(h: Decimal, next_h: Decimal, d: Decimal, next_d: Decimal) -> Decimal:
    both = h + next_h
    return ((h + 2 * both) * next_h * d + h * h * next_d) / both


def _monotone(h: list[Decimal], d: list[Decimal]) -> list[Decimal]:
    """Weighted harmonic means of neighbouring secants, zero where these change sign."""
    inner = []
    for k in range(1, len(d)):
        if d[k - 1] * d[k] <= 0:
            inner.append(Decimal(0))
            continue
        w1, w2 = 2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]
        inner.append((w1 + w2) / (w1 / d[k - 1] + w2 / d[k]))
    return [_monotone_end(h, d), *inner, _monotone_end(h[::-1], d[::-1])]


def _monotone_end(h: list[Decimal], d: list[Decimal]) -> Decimal:
    """The slope of the parabola through three points, kept from changing direction."""
    slope = ((2 * h[0] + h[1]) * d[0] - h[0] * d[1]) / (h[0] + h[1])
    if slope * d[0] <= 0:
        return Decimal(0)
    return 3 * d[0] if d[0] * d[1] <= 0 and abs(slope) > 3 * abs(d[0]) else slope


_SLOPES: dict[str, Slopes] = {
    "linear": lambda x, y: None,
    "cubic": _rounded(_not_a_knot),
    "pchip": _rounded(_monotone),
}
_DEGREES = {"linear": 1, "cubic": 3, "pchip": 3}


# -- in expressions -------------------------------------------------------------------------------------


class _Data(sp.Atom):  # type: ignore[misc]
    """A table as a leaf of an expression."""

    __slots__ = ("table",)
    is_commutative = True

    def __new__(cls, table: Table) -> Self:
        data = sp.Atom.__new__(cls)
        data.table = table
        return data  # type: ignore[no-any-return]

    def __getnewargs__(self) -> tuple[Table]:
        return (self.table,)

    def _hashable_content(self) -> tuple[Any, ...]:
        """What is compared; SymPy orders factors by it."""
        t = self.table
        return (t.name, t.order, t.kind, t.outside, t.breakpoints, t.values)

    def sort_key(self, order: Any = None) -> Any:  # noqa: ARG002 - SymPy's own
        content = (1, (str(self._hashable_content()),))
        return self.class_key(), content, sp.S.One.sort_key(), sp.S.One

    def _sympystr(self, printer: Any) -> str:  # noqa: ARG002 - SymPy's own
        return str(self.table.label)


class TableFunction(sp.Function):  # type: ignore[misc]
    """A table applied to an expression: ``args`` are the table's data and the argument."""

    nargs = 2

    @property
    def table(self) -> Table:
        """The table that is applied."""
        return self.args[0].table  # type: ignore[no-any-return]

    def fdiff(self, argindex: int = 2) -> Expr:
        """Return the table of the derivative at the same argument."""
        if argindex != 2:
            raise sp.ArgumentIndexError(self, argindex)
        derived = self.table.derivative
        return derived(self.args[1]) if derived.degree >= 0 else sp.S.Zero

    def _eval_derivative(self, s: Expr) -> Expr:
        return self.fdiff() * self.args[1].diff(s)

    def _eval_is_commutative(self) -> bool:
        return True

    def _eval_is_extended_real(self) -> Any:
        return self.args[1].is_extended_real

    def _eval_is_finite(self) -> Any:
        return True if self.args[1].is_finite else None

    def _eval_evalf(self, prec: int) -> Expr:
        argument = self.args[1]._eval_evalf(prec + 10)
        if argument is None or not (argument.is_Float or argument.is_Rational):
            return None
        exact = sp.Rational(argument)
        value = self.table.at(Fraction(int(exact.p), int(exact.q)))
        return sp.Rational(value.numerator, value.denominator)._eval_evalf(prec)

    def _sympystr(self, printer: Any) -> str:
        return f"{self.table.label}({printer.doprint(self.args[1])})"

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        primes = "'" * self.table.order
        name = rf"\operatorname{{{_spelt(self.table.name)}}}{primes}"
        power = f"^{{{exp}}}" if exp else ""
        power = f"^{{{primes} {exp}}}" if exp and primes else power
        name = name.removesuffix(primes) if exp else name
        return rf"{name}{power}{{\left({printer._print(self.args[1])} \right)}}"

    def _mathml_presentation(self, printer: Any) -> Any:
        row = printer.dom.createElement("mrow")
        name = printer.dom.createElement("mi")
        name.appendChild(printer.dom.createTextNode(self.table.label))
        fence = printer.dom.createElement("mfenced")
        fence.appendChild(printer._print(self.args[1]))
        for part in (name, fence):
            row.appendChild(part)
        return row


def _spelt(name: str) -> str:
    """Spell a name for LaTeX: signs with a meaning there get a backslash or are left out."""
    return "".join(f"\\{c}" if c in "_&%$#{} " else "" if c in "\\^~" else c for c in name)
