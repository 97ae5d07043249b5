"""Named quantities, definitions over them, and what is assumed of them: the parts of a system."""

from __future__ import annotations

import math
from collections.abc import Mapping
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

    Parameters
    ----------
    symbol : symbol
        Of SymPy, as a rule with ``real=True``.
    unit : str, optional
        As text, for example kg m^2 or rad/s (`eom.units`); ``1`` where there is none, nothing where
        it is not stated.
    meaning : str, optional
        In one line, for pages; nothing is computed from it.
    latex : str, optional
        How it is typeset; by default from the name.
    default : float, optional
        Of a state or parameter, its value in runs that give none by name.
    held : bool, default False
        Of a parameter, whether it is a state that keeps its initial value, which runs then take
        among the initial values too.

    Raises
    ------
    InputError
        For what is no symbol, no text, no truth value, an unknown unit, and a default that is no
        finite number.
    """

    symbol: Expr
    unit: str = ""
    meaning: str = ""
    latex: str = ""
    default: float | None = field(default=None, repr=False)
    held: bool = field(default=False, repr=False)

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
        if not isinstance(self.held, bool):
            raise InputError(
                "held is true or false", where=f"quantity {self.name!r}", got=shown(self.held)
            )
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

        No `InputError` is raised any more.

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

    Parameters
    ----------
    quantity : Quantity
        The name, with its SI unit.
    expression : expression
        Over states, parameters, inputs, time and definitions before it.

    Raises
    ------
    InputError
        For what is no quantity, and no expression.
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
class Sampling:
    """Laws of control that are evaluated with a period; their inputs are held between samples.

    ``laws``: an input each, with the expression of its value; ``states``: of the control itself, with the
    expression of the next value each. All are over what is there just before a sample. The first sample is
    at the start of a run, the others follow after a ``period`` each (s). Inputs take their values ``delay``
    (s) after the sample, which may be longer than a period; states at the sample itself. Until then they
    have the values that a run gives, or the defaults of the quantities, or zero.

    Raises `InputError` for a period that is no positive finite time, and a delay that is negative.
    """

    laws: tuple[Definition, ...]
    states: tuple[Definition, ...] = ()
    period: float = 1.0
    delay: float = 0.0

    def __post_init__(self) -> None:
        checked_times(self.period, self.delay, "a sampled law")

    @property
    def rows(self) -> tuple[Definition, ...]:
        """All that a sample gives, in order: what the inputs become, then the states."""
        return (*self.laws, *self.states)

    @property
    def symbols(self) -> tuple[Expr, ...]:
        """The symbols that are held, in the same order."""
        return tuple(d.symbol for d in self.rows)


def checked_times(period: Any, delay: Any, where: str) -> None:
    """Raise `InputError` for a period (s) that is not positive and finite, or such a delay below zero."""
    if not is_finite(period) or isinstance(period, complex) or not period > 0:
        raise InputError("the period of samples is no positive time", where=where, got=shown(period),
                         expected="a finite number of seconds above zero")  # fmt: skip
    if not is_finite(delay) or isinstance(delay, complex) or not delay >= 0:
        raise InputError("the delay is no time", where=where, got=shown(delay),
                         expected="a finite number of seconds, zero or more")  # fmt: skip


@typed_fields
@dataclass(frozen=True)
class Singularity:
    """A configuration in which the chosen coordinates fail: ``expression`` is zero there.

    Parameters
    ----------
    expression : expression
        Over states, parameters, inputs and time; its absolute value is the distance from the
        configuration, in its own unit.
    coordinate : expression
        The state to name in a report (the middle angle of a rotation sequence).
    meaning : str, optional
        What happens there.
    hint : str, optional
        What to do about it.

    Raises
    ------
    InputError
        For what is no expression.
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

    Parameters
    ----------
    name : str
        By which pages and errors call it.
    meaning : str
        In words.
    vanish : tuple of expressions, optional
        Expressions each of which is zero when it holds.
    nonnegative : tuple of expressions, optional
        Expressions each of which is at least zero when it holds.

    Raises
    ------
    InputError
        For what is no expression, and a tolerance below zero.

    Notes
    -----
    The expressions may use symbols that the system no longer has, so that values given for them can
    be tested against what was assumed. What has no expressions is stated and not tested.
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


def quantity_of(value: Any, where: str) -> Quantity:
    """Return a quantity as it is, a symbol as a quantity. Raises `InputError` for anything else."""
    if not isinstance(value, Quantity):
        return Quantity(as_symbol(value, where))
    as_symbol(value.symbol, where)
    if not (is_text(value.unit) and is_text(value.meaning) and is_text(value.latex)):
        raise InputError("unit, meaning and LaTeX are texts", where=where, got=shown(value))
    return value


def quantities_of(values: Any, where: str) -> tuple[Quantity, ...]:
    """Return the quantities of a list. Raises `InputError` for anything else."""
    return tuple(quantity_of(v, where) for v in entries(values, where))


def definition_of(value: Any, where: str) -> Definition:
    """Return a definition as it is, or one of a pair of name and expression."""
    if isinstance(value, Definition):
        quantity_of(value.quantity, where)
        return value
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise InputError("not a definition", where=where, got=shown(value),
                         expected="a Definition, or a name and an expression")  # fmt: skip
    name, expression = value
    quantity = sp.Symbol(name, real=True) if is_text(name) else name
    return Definition(quantity_of(quantity, where), as_expression(expression))


def definitions_of(values: Any, where: str) -> tuple[Definition, ...]:
    """Return the definitions of a list, or of expressions by name. Raises `InputError` for others."""
    rows = list(values.items()) if isinstance(values, Mapping) else entries(values, where)
    return tuple(definition_of(v, where) for v in rows)
