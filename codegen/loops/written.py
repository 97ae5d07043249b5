"""The integrators that can stand beside generated C, as a table: a row is a name and what it writes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from codegen.frontend.layout import Layout
from codegen.ir.program import Program
from codegen.loops import runge_kutta, taylor
from codegen.loops.tableaux import DOP853, DP5, TSIT5, Tableau
from eom.errors import InputError, unknown_name

Files = Callable[[Program, Layout, float], Mapping[str, str]]
"""From a program, its layout and a relative tolerance to texts by file name."""


@dataclass(frozen=True)
class Choice:
    """Which integrator is written, by name, and the relative tolerance that it shall suit."""

    name: str = "dop853"
    rtol: float = 1e-9


@dataclass(frozen=True)
class Written:
    """A name, what it is, and the files that it writes."""

    name: str
    meaning: str
    files: Files


def _runge_kutta(tableau: Tableau, meaning: str) -> Written:
    return Written(
        tableau.name, meaning, lambda p, layout, rtol: runge_kutta.files(tableau, p, layout)
    )


def _taylor(program: Program, layout: Layout, rtol: float) -> Mapping[str, str]:
    return taylor.files(program, layout, taylor.order_of(rtol))


NONE = "none"
ROWS = (
    _runge_kutta(DOP853, "explicit Runge-Kutta of order 8"),
    _runge_kutta(DP5, "explicit Runge-Kutta of order 5, of Dormand and Prince"),
    _runge_kutta(TSIT5, "explicit Runge-Kutta of order 5, of Tsitouras"),
    Written("taylor", "Taylor series, order from the relative tolerance", _taylor),
    Written(NONE, "the functions alone", lambda p, layout, rtol: {}),
)


def files(choice: Choice, program: Program, layout: Layout) -> Mapping[str, str]:
    """Return the files of an integrator. Raises `InputError` as `check` does."""
    return check(choice).files(program, layout, choice.rtol)


def check(choice: Choice) -> Written:
    """Return a row of the table.

    Raises `InputError` for unknown names and a tolerance that is not positive.
    """
    row = next((row for row in ROWS if row.name == choice.name), None)
    if row is None:
        raise unknown_name("integrator", choice.name, [row.name for row in ROWS])
    if not choice.rtol > 0:
        raise InputError("rtol is not positive", got=choice.rtol)
    return row
