"""Named quantities, definitions over them, and what is assumed of them: the parts of a system."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from eom.errors import InputError, entries, is_text, shown, typed_fields
from eom.expressions import as_expression
from eom.units import Dimension, read

Expr = Any  # a SymPy expression; SymPy ships no types


TIME = sp.Symbol("t", real=True)


@dataclass(frozen=True)
class Quantity:
    """A symbol with its SI unit, a one-line meaning and its LaTeX form.

    ``symbol``: of SymPy, as a rule with ``real=True``. ``unit``: as text, for example kg m^2 or rad/s
    (`eom.units`); ``1`` where there is none, nothing where it is not stated. ``meaning``, ``latex``: for
    pages; nothing is computed from them. ``default``: of a state or parameter, its value in runs that give
    none by name.
    Raises `InputError` for what is no symbol, no text, an unknown unit, and a default that is no finite
    number.
    """

    symbol: Expr
    unit: str = ""
    meaning: str = ""
    latex: str = ""
    default: float | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if not isinstance(self.symbol, sp.Symbol):
            raise InputError("not a symbol", where="a quantity", got=shown(self.symbol),
                             expected="a SymPy symbol")  # fmt: skip
        if not (
            isinstance(self.unit, str)
            and isinstance(self.meaning, str)
            and isinstance(self.latex, str)
        ):
            raise InputError("unit, meaning and LaTeX are texts", where=f"quantity {self.name!r}")
        if self.unit:
            _known_unit(self)
        if self.default is not None and not is_finite(self.default):
            raise InputError("the default is no finite number", where=f"quantity {self.name!r}",
                             got=shown(self.default))  # fmt: skip

    @property
    def name(self) -> str:
        """The symbol's name."""
        return str(self.symbol.name)

    @property
    def dimension(self) -> Dimension | None:
        """The dimension of its unit; None where that is not stated.

        >>> Quantity(sp.Symbol("M"), "N m").dimension.words
        'kg m^2/s^2'
        """
        return read(self.unit).dimension if self.unit else None

    @property
    def description(self) -> str:
        """The meaning, with the unit in brackets."""
        return self.meaning + (f" [{self.unit}]" if self.unit not in {"", "1"} else "")


@dataclass(frozen=True)
class Definition:
    """A named expression: an intermediate, an output or a constant of the motion.

    ``quantity``: the name, with its SI unit. ``expression``: over states, parameters, inputs, time and
    definitions before it. Raises `InputError` for what is no quantity, and no expression.
    """

    quantity: Quantity
    expression: Expr

    def __post_init__(self) -> None:
        if not isinstance(self.quantity, Quantity):
            raise InputError("not a quantity", where="a definition", got=shown(self.quantity),
                             expected="a Quantity")  # fmt: skip
        if not isinstance(self.expression, sp.Basic):
            object.__setattr__(self, "expression", as_expression(self.expression))

    @property
    def name(self) -> str:
        """The name of the quantity that is defined."""
        return self.quantity.name

    @property
    def symbol(self) -> Expr:
        """The symbol of the quantity that is defined."""
        return self.quantity.symbol


@typed_fields
@dataclass(frozen=True)
class Singularity:
    """A configuration in which the chosen coordinates fail: ``expression`` is zero there.

    ``expression``: over states, parameters, inputs and time; its absolute value is the distance from the
    configuration, in its own unit. ``coordinate`` is the state to name in a report (the middle angle of a
    rotation sequence). ``meaning``: what happens there; ``hint``: what to do about it. Raises `InputError`
    for what is no expression.
    """

    expression: Expr
    coordinate: Expr
    meaning: str = ""
    hint: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "expression", as_expression(self.expression))
        as_symbol(self.coordinate, "coordinate of a singularity")


@typed_fields
@dataclass(frozen=True)
class Assumption:
    """What was assumed, as data that can be tested on numbers.

    Every expression of ``vanish`` is zero and every one of ``nonnegative`` is at least zero when
    the assumption holds. The expressions may use symbols that the system no longer has, so that
    values given for them can be tested against what was assumed. ``meaning``: in words. What has no
    expressions is stated and not tested. Raises `InputError` for what is no expression, and a
    tolerance below zero.
    """

    name: str
    meaning: str
    vanish: tuple[Expr, ...] = ()
    nonnegative: tuple[Expr, ...] = ()
    tolerance: float = 1e-9
    """How far from holding values may be, relative to the largest of them."""

    def __post_init__(self) -> None:
        for name in ("vanish", "nonnegative"):
            object.__setattr__(self, name, as_expressions(getattr(self, name), name))
        if not self.tolerance >= 0:
            raise InputError("the tolerance is negative", where=f"assumption {self.name!r}",
                             got=self.tolerance)  # fmt: skip


def _known_unit(given: Quantity) -> None:
    """Raise `InputError` for an unknown unit, with the quantity that has it."""
    try:
        read(given.unit)
    except InputError as error:
        raise error.at(f"unit of {given.name}") from None


def is_finite(value: Any) -> bool:
    """Return whether a value is a finite real number."""
    try:
        return not isinstance(value, str | bytes) and math.isfinite(value)
    except (TypeError, OverflowError):
        return False


def as_symbol(value: Any, where: str) -> Expr:
    """Return a symbol with a name that can be written. Raises `InputError` for anything else."""
    if not isinstance(value, sp.Symbol) or not is_text(value.name):
        raise InputError("not a symbol", where=where, got=shown(value), expected="a SymPy symbol")
    return value


def as_expressions(values: Any, where: str) -> tuple[Expr, ...]:
    """Return the entries of a list or matrix as expressions. Raises `InputError` for anything else."""
    rows = list(values) if isinstance(values, sp.MatrixBase) else entries(values, where)
    return tuple(v if isinstance(v, sp.Basic) else as_expression(v) for v in rows)
