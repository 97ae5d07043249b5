"""Partial derivatives of quantities of a system by its coordinates, rates, speeds and momenta.

Energies are functions of coordinates and speeds that need not be rates: those of a body are components of
its angular velocity. So speeds are written in coordinates and their rates first; what is held beside
the variable is then what the formula is written in. Momenta in a formula without rates are variables of
their own, as in Hamilton's equations.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from eom.checker.mean.dimensions import dimension
from eom.checker.mean.model import PLACES, imposed
from eom.errors import InputError
from eom.system import Expr, System
from eom.terms.terms import Term, expr
from eom.worlds.solutions import rate, real_point
from eom.worlds.worlds import SLOPE

MOMENTA = ("kg m/s", "kg m^2/s")
DIGITS = 30


@dataclass(frozen=True)
class Chart:
    """Symbols for the rates of coordinates, and speeds in terms of coordinates and those symbols."""

    rates: Mapping[Expr, Expr]
    speeds: Mapping[Expr, Expr]
    kinematics: Mapping[Expr, Expr]


@lru_cache(maxsize=16)
def chart(system: System) -> Chart:
    """Return coordinates and speeds. Raises `InputError` where there are not as many of both."""
    named = zip(system.states, system.rates, strict=True)
    found = {q.symbol: r for q, r in named if q.unit in PLACES}
    given = imposed(system)
    loads = {q.name for q in system.states if q.name in given and q.unit not in PLACES}
    held = {*loads, *(f"{n}_dot" for n in loads)}
    others = (q for q in system.states if q.unit not in PLACES and q.name not in held)
    speeds = [q.symbol for q in others]
    if len(found) != len(speeds) or not _plain(system, found):
        raise InputError("the coordinates of this system are no independent ones", got=system.name)
    places = {s: system.expand(r) for s, r in found.items()}
    rates = {s: sp.Dummy(f"{s}_rate", real=True) for s in places}
    kinematic = sp.Matrix(list(places.values()))
    matrix = kinematic.jacobian(speeds)
    if matrix.free_symbols & set(speeds):
        raise InputError("speeds that are not linear in the rates of coordinates", got=system.name)
    rest = kinematic.subs(dict.fromkeys(speeds, 0))
    solved = matrix.LUsolve(sp.Matrix(list(rates.values())) - rest)
    spelt = dict(zip(speeds, map(sp.simplify, solved), strict=True))
    return Chart(rates, spelt, {d: places[s] for s, d in rates.items()})


def _plain(system: System, coordinates: Collection[Expr]) -> bool:
    """Return whether rates of coordinates are not solved for together with others."""
    if system.mass_matrix is None:
        return True
    places = [k for k, q in enumerate(system.states) if q.symbol in coordinates]
    rows = (system.mass_matrix.row(k) for k in places)
    return all(r[k] == 1 and sum(map(bool, r)) == 1 for k, r in zip(places, rows, strict=True))


def derivative(system: System, f: Expr, variable: Expr, held: Collection[Expr] = ()) -> Expr:
    """Return the partial derivative of an expression over quantities of a system, rates among them.

    ``held``: symbols that are variables of their own. Raises `InputError` for what is no variable, and
    where it is open what is held beside it.
    """
    known = chart(system)
    outputs = {d.symbol: d for d in (*system.outputs, *system.invariants)}
    others = f.free_symbols & (outputs.keys() | known.speeds.keys())
    momenta = {s for s in outputs if _is_momentum(outputs[s].quantity.unit)}
    by_momenta = variable in momenta or (variable in known.rates and others <= momenta)
    own = {*held, *(momenta if by_momenta else ())}
    if f.free_symbols & momenta - own:
        raise _open(f"{f} has momenta beside other speeds")
    if variable in own and variable not in f.free_symbols:
        raise InputError("this is not written in the momentum that it is differentiated by", got=f)
    full = _written_out(system, f, own).xreplace({rate(s): d for s, d in known.rates.items()})
    if variable in known.rates and not own & f.free_symbols and _is_energy(system, f, full):
        raise _open(str(f))
    by = known.rates.get(variable.args[0], variable) if isinstance(variable, rate) else variable
    full = full.xreplace(known.kinematics if by in known.speeds else known.speeds)
    variables = {*known.rates, *known.rates.values(), *known.speeds, *own}
    if by not in variables or full.has(rate):
        raise InputError("no partial derivative of a quantity of this system", got=variable)
    return full.diff(by).xreplace({d: rate(s) for s, d in known.rates.items()})


def _open(got: str) -> InputError:
    return InputError(
        "whether rates or momenta are held is open",
        got=got,
        expected="a function of coordinates and rates alone, or of coordinates and momenta alone",
    )


def _is_momentum(unit: str) -> bool:
    return dimension(unit) in map(dimension, MOMENTA)


def _written_out(system: System, f: Expr, own: Collection[Expr]) -> Expr:
    """Return an expression over states, parameters and inputs, and what is a variable of its own."""
    found: dict[Any, Expr] = {}
    states = {q.symbol for q in (*system.states, *system.parameters, *system.inputs)}
    for d in (*system.outputs, *system.invariants):
        if d.symbol not in {*own, *states} and d.expression != d.symbol:
            found.setdefault(d.symbol, d.expression)
    while f.free_symbols & found.keys():
        f = f.xreplace(found)
    return system.expand(f)


def _is_energy(system: System, f: Expr, full: Expr) -> bool:
    """Return whether an expression is the total energy, and more than a kinetic one by its name."""
    energies = [
        d.expression for d in system.invariants if dimension(d.quantity.unit) == dimension("J")
    ]
    if f.is_Symbol and str(f) in {"T", "kinetic_energy"}:
        return False
    known, point = chart(system), real_point(system, 0)
    at_rates = {d: r.evalf(DIGITS, subs=point) for d, r in known.kinematics.items()}
    values = [full.xreplace(at_rates)] + [_written_out(system, e, ()) for e in energies]
    first, *rest = (v.evalf(DIGITS, subs=point) for v in values)
    return any((first - v).is_number and abs(first - v) < 10**-15 * (1 + abs(v)) for v in rest)


def share(left: Iterable[Term], right: Iterable[Term], free: Collection[str]) -> bool:
    """Return whether sides have the same coordinates (``free``: their kinds) and a function of these."""
    sides = [[tuple(map(str, a.data)) for a in side] for side in (left, right)]
    variables = [
        {tuple(v.split(" ", 1)) for d in s if d[0] == "function" for v in d[2:]} for s in sides
    ]
    moving = [v | {d for d in s if d[0] in free} for v, s in zip(variables, sides, strict=True)]
    functions = [{d[1].split(SLOPE)[0] for d in s if d[0] == "function"} for s in sides]
    return moving[0] == moving[1] and bool(functions[0] & functions[1])


def addends(term: Term) -> Iterator[Term]:
    """Yield the terms of a sum, those within an expression as well; none of a zero."""
    if term.head == "add":
        for a in term.args:
            yield from addends(a)
    elif term.head == "expr":
        yield from (expr(a) for a in sp.Add.make_args(term.data[0]))
    elif not term.is_zero:
        yield term
