"""Systems that were derived elsewhere: SymPy's mechanics, or bare states with rates or M and f.

Functions of time become plain symbols: coordinates and speeds are states, other functions of time
are inputs, and so are their derivatives (prescribed motion), each under a name of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from eom.errors import InputError
from eom.quantities import Quantity
from eom.system import BodyAttitude, System, as_expression, nodes

Expr = Any

Parts = tuple[list[Expr], list[Expr], Expr]
"""States, right sides, mass matrix."""
_TIME = "t"
"""The name of time in SymPy's mechanics."""

ACCEPTED = (
    "an eom.System, SymPy's KanesMethod, LagrangesMethod, JointsMethod or mechanics System, "
    "(states, rates), or (states, mass matrix, forces)"
)


def as_system(given: Any, name: str = "", attitudes: Sequence[BodyAttitude] = ()) -> System:
    """Return ``given`` as a system. Raises `InputError` for anything else than `ACCEPTED`.

    A pair is (states, rates); a triple (states, M, f) means M d(states)/dt = f. States may be
    symbols or functions of time. ``attitudes``: bodies among the states, over the same; they are proved.
    """
    if isinstance(given, System):
        return replace(given, attitudes=(*given.attitudes, *attitudes)) if attitudes else given
    kind = type(given).__name__
    if kind in _METHODS and type(given).__module__.startswith("sympy."):
        states, rates, mass = _METHODS[kind](given)
    elif isinstance(given, tuple) and len(given) in {2, 3}:
        states, *rest = given
        rates = _entries(rest[-1], "rates")
        mass = sp.Matrix(rest[0]) if len(rest) == 2 else None
    else:
        raise InputError(
            "not a system of equations",
            got=kind,
            expected=ACCEPTED,
            hint="call derive() of a scene" if hasattr(given, "derive") else "",
        )
    return _plain(name or kind.lower(), _entries(states, "states"), rates, mass, attitudes)


def _entries(values: Any, what: str) -> list[Expr]:
    if not isinstance(values, Iterable):
        raise InputError(f"{what} are not a list", got=type(values).__name__)
    found = list(values)
    if not all(isinstance(v, sp.Expr | int | float) for v in found):
        raise InputError(f"{what} are not expressions", got=str(found)[:200])
    return [as_expression(v) for v in found]


def _kane(method: Any) -> Parts:
    """Coordinates by their kinematics, solved by SymPy; speeds by mass matrix and forces."""
    _ready(method, "KanesMethod", "kanes_equations(bodies, loads)")
    kinematics = method.kindiffdict()
    velocities = [kinematics[_rate(c)] for c in method.q]
    return _second_order(method, list(method.u), velocities)


def _lagrange(method: Any) -> Parts:
    """Coordinates and their rates."""
    _ready(method, "LagrangesMethod", "form_lagranges_equations()")
    rates = [_rate(c) for c in method.q]
    return _second_order(method, rates, rates)


def _rate(coordinate: Expr) -> Expr:
    return coordinate.diff(*coordinate.args)


def _ready(method: Any, kind: str, call: str) -> None:
    """Refuse a method without equations, and one with constraints."""
    try:
        mass, forcing = method.mass_matrix, method.forcing
    except (ValueError, AttributeError) as error:
        raise InputError(f"{kind} has no equations yet", hint=f"call {call} first") from error
    n = len(method.u)
    dependent = [v for group in _DEPENDENT for v in getattr(method, group, ())]
    if mass.shape != (n, n) or len(forcing) != n or dependent:
        raise InputError(
            f"{kind} with constraints",
            got=f"{len(forcing)} equations for {n} speeds",
            expected="independent coordinates and speeds",
        )


_DEPENDENT = ("_qdep", "_udep")
"""Where KanesMethod keeps dependent coordinates and speeds."""


def _second_order(method: Any, speeds: list[Expr], velocities: list[Expr]) -> Parts:
    mass = sp.diag(sp.eye(len(velocities)), method.mass_matrix)
    return [*method.q, *speeds], [*velocities, *method.forcing], mass


def _mechanics_system(system: Any) -> Parts:
    if system.eom_method is None:
        raise InputError("the mechanics System has no equations yet", hint="call form_eoms() first")
    return _METHODS[type(system.eom_method).__name__](system.eom_method)


def _joints(joints: Any) -> Parts:
    """The method that has formed the equations of SymPy's (deprecated) JointsMethod."""
    if joints.method is None:
        raise InputError("JointsMethod has no equations yet", hint="call form_eoms() first")
    return _METHODS[type(joints.method).__name__](joints.method)


_METHODS = {
    "KanesMethod": _kane,
    "LagrangesMethod": _lagrange,
    "System": _mechanics_system,
    "JointsMethod": _joints,
}


def _plain(
    name: str,
    states: Sequence[Expr],
    rates: Sequence[Expr],
    mass: Expr | None,
    attitudes: Sequence[BodyAttitude],
) -> System:
    """Exchange functions of time and derivatives for plain symbols, and sort these by role."""
    stated = [e for a in attitudes for e in a.expressions]
    everything = [*rates, *(mass if mass is not None else ()), *stated]
    spelt = {s: sp.Symbol(_name_of(s), real=True) for s in states}
    inputs = [f for f in _functions_of_time(everything) if f not in spelt]
    spelt |= {f: sp.Symbol(_name_of(f), real=True) for f in inputs}
    _distinct(spelt)
    known = dict(spelt)
    new_rates = [_exchanged(r, known) for r in rates]
    new_mass = (
        None if mass is None else sp.ImmutableMatrix(mass.applyfunc(lambda e: _exchanged(e, known)))
    )
    new_attitudes = tuple(a.over(lambda e: _exchanged(e, known)) for a in attitudes)
    stated = [e for a in new_attitudes for e in a.expressions]
    free = {s for s in nodes((*new_rates, *(new_mass or ()), *stated)) if isinstance(s, sp.Symbol)}
    time = next((s for s in free if s.name == _TIME), sp.Symbol(_TIME))
    parameters = sorted(free - set(spelt.values()) - {time}, key=str)
    return System(
        name=name,
        states=tuple(Quantity(spelt[s]) for s in states),
        rates=tuple(new_rates),
        mass_matrix=new_mass,
        parameters=tuple(Quantity(s) for s in parameters),
        inputs=tuple(Quantity(spelt[f]) for f in inputs),
        time=time,
        attitudes=new_attitudes,
    )


def _exchanged(expression: Expr, known: dict[Expr, Expr]) -> Expr:
    """Put what ``known`` says for its keys, a derivative before the function in it; it grows."""
    stack = [expression]
    while stack:
        node = stack[-1]
        waiting = [] if node in known else [a for a in node.args if a not in known]
        if waiting:
            stack += waiting
            continue
        stack.pop()
        if node not in known:
            args = [known[a] for a in node.args]
            same = all(a is b for a, b in zip(args, node.args, strict=True))
            known[node] = node if same else node.func(*args)
    return known[expression]


def _functions_of_time(expressions: Iterable[Expr]) -> list[Expr]:
    """Return functions and derivatives, in the order of their names; others than of time are refused."""
    found = {e for e in nodes(expressions) if isinstance(e, AppliedUndef | sp.Derivative)}
    for f in found:
        inner = f.expr if isinstance(f, sp.Derivative) else f
        if [str(a) for a in inner.args] != [_TIME]:
            raise InputError("not a function of time alone", got=f, expected="f(t), or a symbol")
    inner = {f.expr for f in found if isinstance(f, sp.Derivative)}
    bare = {f for f in found if f not in inner or _occurs_alone(f, expressions)}
    return sorted(bare, key=_name_of)


def _occurs_alone(f: Expr, expressions: Iterable[Expr]) -> bool:
    """Return whether ``f`` is used other than under a derivative."""
    hidden = {d: sp.Integer(0) for e in expressions for d in e.atoms(sp.Derivative) if d.has(f)}
    return any(e.xreplace(hidden).has(f) for e in expressions)


def _name_of(e: Expr) -> str:
    """Return q1 for q1(t), q1_dot and q1_ddot for its derivatives."""
    if isinstance(e, sp.Derivative):
        count = sum(int(n) for _, n in e.variable_count)
        return f"{_name_of(e.expr)}_{'d' * count}ot"
    return str(e.func.__name__) if isinstance(e, AppliedUndef) else str(e)


def _distinct(spelt: Mapping[Expr, Expr]) -> None:
    names = [s.name for s in spelt.values()]
    twice = sorted({n for n in names if names.count(n) > 1})
    if twice:
        raise InputError("two variables get one name", got=", ".join(twice))
