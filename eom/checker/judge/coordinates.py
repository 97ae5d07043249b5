"""Partial derivatives of quantities of a system by its coordinates, rates, speeds and momenta.

Energies are functions of coordinates and speeds that need not be rates: those of a body are components of
its angular velocity. So speeds are written in coordinates and their rates first; what is held beside
the variable is then what the formula is written in. A momentum in a formula is a variable in the place of
the rate that belongs to it, as in Hamilton's equations with all of them, and in Routh's with some.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from eom.checker.mean.dimensions import dimension
from eom.checker.mean.model import PLACES
from eom.errors import InputError
from eom.system import Expr, System
from eom.terms.terms import Term, expr
from eom.worlds.solutions import rate, real_point
from eom.worlds.worlds import SLOPE

MOMENTA = ("kg m/s", "kg m^2/s")
DIGITS = 30
_NEARLY = 1e-15


@dataclass(frozen=True)
class Chart:
    """Symbols for the rates of coordinates, and speeds in terms of coordinates and those symbols."""

    rates: Mapping[Expr, Expr]
    speeds: Mapping[Expr, Expr]
    kinematics: Mapping[Expr, Expr]


@lru_cache(maxsize=16)
def chart(system: System) -> Chart:
    """Return coordinates and speeds. Raises `InputError` where there are not as many of both."""
    named = enumerate(zip(system.states, system.rates, strict=True))
    found = {q.symbol: (k, r) for k, (q, r) in named if q.unit in PLACES}
    places = {s: system.expand(r) for s, (_, r) in found.items()}
    used = frozenset().union(*(r.free_symbols for r in places.values()))
    speeds = [q.symbol for q in system.states if q.unit not in PLACES and q.symbol in used]
    plain = all(_is_explicit(system, k) for k, _ in found.values())
    if len(found) != len(speeds) or not plain:
        raise InputError("the coordinates of this system are no independent ones", got=system.name)
    rates = {s: sp.Dummy(f"{s}_rate", real=True) for s in places}
    kinematic = sp.Matrix(list(places.values()))
    matrix = kinematic.jacobian(speeds)
    if matrix.free_symbols & set(speeds):
        raise InputError("speeds that are not linear in the rates of coordinates", got=system.name)
    rest = kinematic.subs(dict.fromkeys(speeds, 0))
    solved = matrix.LUsolve(sp.Matrix(list(rates.values())) - rest)
    spelt = dict(zip(speeds, map(sp.simplify, solved), strict=True))
    return Chart(rates, spelt, {d: places[s] for s, d in rates.items()})


def _is_explicit(system: System, k: int) -> bool:
    """Return whether the rate of a state stands alone in its equation."""
    matrix = system.mass_matrix
    return matrix is None or list(matrix[k, :]) == list(sp.eye(matrix.rows)[k, :])


Momenta = Mapping[Expr, tuple[Expr, Expr]]
"""Symbols of momenta, with what they are in speeds, and the coordinate of each."""


def derivative(
    system: System,
    f: Expr,
    variable: Expr,
    held: Momenta | None = None,
    canonical: Collection[str] = (),
) -> Expr:
    """Return the partial derivative of an expression over quantities of a system, rates among them.

    ``held``: symbols that the note has for momenta; ``canonical``: names of functions of coordinates and
    momenta. Raises `InputError` for what is no variable, and where it is open what is held beside it.
    """
    known, momenta = chart(system), {**_momenta(system), **(held or {})}
    own = {s: m for s, m in momenta.items() if s in f.free_symbols}
    by_all = not {str(s) for s in f.free_symbols}.isdisjoint(canonical)
    if by_all or (variable in momenta and variable not in own):
        own |= {variable: momenta[variable]} if variable in momenta else {}
        own = _all_momenta(system, own)
    loose = _loose(system, f) - own.keys()
    full = _written_out(system, f, {*own, *loose}).xreplace(
        {rate(s): d for s, d in known.rates.items()}
    )
    if variable in known.rates and not own and _is_energy(system, f, full):
        raise _open(str(f))
    by = known.rates.get(variable.args[0], variable) if isinstance(variable, rate) else variable
    if loose and full.free_symbols & {*known.speeds, *known.rates.values()}:
        raise _open(f"{f} has momenta beside other speeds")
    if own or by not in known.speeds:
        full = full.xreplace(known.speeds)
    full = full.xreplace(_without_rates(system, known, own)) if own else full
    if by in known.speeds:
        full = full.xreplace(known.kinematics)
    variables = {*known.rates, *known.rates.values(), *known.speeds, *own, *loose, system.time}
    if by not in variables or full.has(rate):
        raise InputError("no partial derivative of a quantity of this system", got=variable)
    return full.diff(by).xreplace({d: rate(s) for s, d in known.rates.items()})


@lru_cache(maxsize=16)
def _conjugate(system: System) -> frozenset[Expr]:
    """Return what is the derivative of an energy of the system by a rate."""
    known, point = chart(system), real_point(system, 0)
    named = (*system.outputs, *system.invariants)
    energies = [d for d in named if dimension(d.quantity.unit) == dimension("J")]
    at_rates = {d: r.evalf(DIGITS, subs=point) for d, r in known.kinematics.items()}

    def value(e: Expr) -> Expr:
        return e.xreplace(known.speeds).xreplace(at_rates).evalf(DIGITS, subs=point)

    rates = {rate(s): d for s, d in known.rates.items()}
    full = [_written_out(system, d.expression, ()).xreplace(rates) for d in energies]
    slopes = [value(e.xreplace(known.speeds).diff(d)) for e in full for d in rates.values()]
    likely = [d for d in named if dimension(d.quantity.unit) in map(dimension, MOMENTA)]
    values = {d.symbol: value(_written_out(system, d.expression, ())) for d in likely}
    return frozenset(s for s, v in values.items() if any(_same(v, w) for w in slopes))


def _momenta(system: System) -> dict[Expr, tuple[Expr, Expr]]:
    """Return the momenta of coordinates, by the names of both."""
    outputs = {d.quantity.name: d for d in (*system.outputs, *system.invariants)}
    named = ((outputs.get(f"p_{q}"), q) for q in chart(system).rates)
    return {
        d.symbol: (d.expression, q)
        for d, q in named
        if d is not None and d.symbol in _conjugate(system)
    }


def _all_momenta(system: System, own: Momenta) -> dict[Expr, tuple[Expr, Expr]]:
    """Return some momenta with those of all other coordinates. Raises `InputError` if one is not known."""
    places = set(chart(system).rates)
    missing = places - {q for _, q in own.values()}
    found = {**own, **{s: m for s, m in _momenta(system).items() if m[1] in missing}}
    if {q for _, q in found.values()} != places:
        raise _open("not all momenta are known")
    return found


def _loose(system: System, f: Expr) -> set[Expr]:
    """Return the momenta in a formula, whatever coordinates they belong to."""
    return set(f.free_symbols & _conjugate(system))


def _without_rates(system: System, known: Chart, own: Momenta) -> dict[Expr, Expr]:
    """Return the rates that belong to momenta in terms of these."""
    gone = [known.rates[q] for _, q in own.values()]
    if len(set(gone)) != len(gone):
        raise _open("two momenta of one coordinate")
    left = [
        _written_out(system, e, ())
        .xreplace({rate(s): d for s, d in known.rates.items()})
        .xreplace(known.speeds)
        for e, _ in own.values()
    ]
    matrix = sp.Matrix(left).jacobian(gone)
    rest = sp.Matrix(left).xreplace(dict.fromkeys(gone, sp.S.Zero))
    solved = matrix.LUsolve(sp.Matrix(list(own)) - rest)
    return dict(zip(gone, solved, strict=True))


def _open(got: str) -> InputError:
    return InputError(
        "whether rates or momenta are held is open",
        got=got,
        expected="a function of coordinates and rates alone, or one that is written with momenta",
    )


def _same(a: Expr, b: Expr) -> bool:
    return bool((a - b).is_number and abs(a - b) < _NEARLY * (1 + abs(a)))


def _written_out(system: System, f: Expr, own: Iterable[Expr]) -> Expr:
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
    return any(_same(v, first) for v in rest)


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
