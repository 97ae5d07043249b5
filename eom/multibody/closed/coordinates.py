"""Coordinates in place of those of the joints: which they may be, and what their rates are called."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from eom.errors import InputError, near_matches
from eom.multibody.algebra.values import is_number
from eom.multibody.model.model import Tree
from eom.system import TIME, Quantity

Expr = Any


def dotted(name: str) -> str:
    """Return the name of a rate: ``u_dot`` of ``u``, ``q_ddot`` of ``q_dot``."""
    return f"{name.removesuffix('_dot')}_ddot" if name.endswith("_dot") else f"{name}_dot"


def q_dot(q: Quantity) -> Quantity:
    """Return the rate of a chosen coordinate, as a quantity."""
    unit = {"rad": "rad/s", "m": "m/s"}.get(q.unit, "")
    return Quantity(sp.Symbol(f"{q.name}_dot", real=True), unit, f"rate of {q.name}")


def new_coordinates(tree: Tree, chosen: Mapping[Expr, Expr]) -> tuple[Quantity, ...]:
    """Return the new coordinates, in the order of those that they replace."""
    where = f"tree {tree.name!r}: coordinates"
    allowed = {
        c.symbol: c
        for j in tree.ordered
        if j.motion is None and None not in j.row.paired(j.attitude) and j.row.name != "fixed"
        for c in j.coordinates
    }
    for q in chosen:
        if q not in allowed:
            raise InputError(
                f"cannot replace {q}",
                where=where,
                expected="a coordinate whose rate is a speed, of a joint that moves freely",
                hint=near_matches(str(q), [c.name for c in allowed.values()]),
            )
    for j in tree.ordered:
        if 0 < sum(c.symbol in chosen for c in j.coordinates) < len(j.coordinates):
            raise InputError(
                "replace all coordinates of a joint or none", where=f"{where}: {j.name}"
            )
    if any(TIME in e.free_symbols for e in chosen.values()):
        raise InputError("new coordinates cannot depend on time", where=where)
    parameters = set().union(*(_constants(tree)))
    new: dict[Expr, Quantity] = {}
    for old in (o for o in allowed if o in chosen):
        for s in sorted(chosen[old].free_symbols - parameters, key=str):
            new.setdefault(s, Quantity(s, allowed[old].unit, "coordinate"))
    others = [s for s in new if s in allowed and s not in chosen]
    if others or len(new) != len(chosen):
        raise InputError(
            "new coordinates are not as many as those that they replace",
            where=where,
            got=", ".join(str(s) for s in new) or "none",
            expected=f"{len(chosen)} new symbols in place of {', '.join(map(str, chosen))}",
        )
    return tuple(new.values())


def _constants(tree: Tree) -> list[set[Expr]]:
    """Return the symbols of placements and bodies: lengths and angles that a coordinate may rest on."""
    found: list[set[Expr]] = [set()]
    for j in tree.joints:
        for place in (j.on_parent, j.on_child):
            given = (*place.position, *(x for row in place.rotation for x in row), *j.rest)
            found += [x.free_symbols for x in given if not is_number(x)]
    return found
