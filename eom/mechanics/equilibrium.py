"""Whether a stated point is an equilibrium or a steady motion of a system, exactly, over its parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import sympy as sp

from eom.errors import InputError, unknown_name
from eom.exact.identity import vanishes
from eom.system import System, as_expression

Expr = Any


def remainders(
    system: System, values: Mapping[Any, Expr], cyclic: Iterable[Any] = ()
) -> dict[str, Expr]:
    """Return the rates, by names of states, that do not vanish at a point: none at an equilibrium.

    ``values``: expressions over parameters and inputs, by name or symbol, for states, and if need be for
    inputs and parameters. States that are left out keep their symbols: the point is then one for all
    their values. ``cyclic``: states that may run; their own rates do not matter, and no other rate may
    depend on them. What is left says what must hold, as relations between parameters. Floats are the
    dyadic numbers that they are. Decided as in `eom.exact.identity.vanishes`.
    Raises `InputError` for unknown names, values of cyclic states, and cyclic states of a system with a
    mass matrix.

    >>> from eom.mechanics.rigidbody import free_rigid_body
    >>> spin = {"omega_1": 0, "omega_2": sp.Symbol("nu"), "omega_3": 0}
    >>> remainders(free_rigid_body(), spin)
    {}
    """
    symbols = {q.name: q.symbol for q in (*system.states, *system.inputs, *system.parameters)}
    where = f"system {system.name!r}"

    def symbol(given: Any) -> Expr:
        name = given if isinstance(given, str) else str(given)
        if name not in symbols:
            raise unknown_name("state, input or parameter", name, symbols, where)
        return symbols[name]

    point = {symbol(k): _exact(v) for k, v in values.items()}
    running = {symbol(c) for c in cyclic}
    if running & set(point):
        raise InputError(
            "a cyclic state has no value", where=where,
            got=", ".join(sorted(s.name for s in running & set(point))),
        )  # fmt: skip
    if running and system.mass_matrix is not None:
        raise InputError("cyclic states need explicit rates", where=where, got="a mass matrix")
    for d in system.definitions:
        point[d.symbol] = d.expression.xreplace(point)
    found = {
        q.name: rate.xreplace(point)
        for q, rate in zip(system.states, system.rates, strict=True)
        if q.symbol not in running
    }
    return {name: rate for name, rate in found.items() if not vanishes(rate)}


def is_equilibrium(system: System, values: Mapping[Any, Expr], cyclic: Iterable[Any] = ()) -> bool:
    """Return whether all rates but those of cyclic states vanish at a point; see `remainders`."""
    return not remainders(system, values, cyclic)


def _exact(value: Any) -> Expr:
    expression = as_expression(value)
    return expression.xreplace({x: sp.Rational(x) for x in expression.atoms(sp.Float)})
