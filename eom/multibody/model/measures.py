"""The units of what a tree is made of: whether its expressions are of the dimensions of their places."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import Any

from eom.dimensions import Dimensions
from eom.errors import unknown_name
from eom.multibody.algebra.values import Value, is_decimal, is_number
from eom.quantities import TIME

KINDS = ("values", "decimals")
"""What numbers in the equations of trees may be."""


def checked(tree: Any) -> str:
    """Return what numbers in the equations of a tree are: a row of `eom.system.NUMBERS`.

    Raises `InputError` for an expression over parameters or inputs with units that has another one than its
    place; numbers in it may be values with units. Nothing is checked where the tree says what they are.
    """
    if tree.numbers:
        if tree.numbers not in KINDS:
            raise unknown_name("kind of numbers", tree.numbers, KINDS, f"tree {tree.name!r}")
        return str(tree.numbers)
    rows = list(_measured(tree))
    own = [(q.symbol, q.unit) for q in (*tree.parameters, *tree.inputs) if q.unit]
    stated = {symbol for symbol, _ in own}
    known = Dimensions([*own, *_moving(tree)], counts=False, time=TIME) if own else None
    for where, x, unit in rows if known else ():
        if known and not is_number(x) and x.free_symbols & stated:
            known.check(x, where, unit)
    return "decimals" if any(is_decimal(x) for _, x, _ in rows) else "values"


def _moving(tree: Any) -> Iterator[tuple[Any, str]]:
    """Yield coordinates, speeds and motors with their units, and time."""
    of_joints = (q for j in tree.joints for q in (*j.coordinates, *j.speeds, *j.motors))
    of_rotors = (q for r in tree.rotors for q in (*r.states, *r.motors))
    yield from ((q.symbol, q.unit) for q in chain(of_joints, of_rotors))
    yield TIME, "s"


def _measured(tree: Any) -> Iterator[tuple[str, Value, str]]:
    """Yield all values with places and units, these as far as they are known."""
    where = f"tree {tree.name!r}: gravity"
    yield from ((where, x, "m/s^2") for x in tree.gravity)
    yield from ((f"{where}_gradient", x, "1/s^2") for row in tree.gravity_gradient for x in row)
    for joint in tree.joints:
        yield from joint.measured(joint.speeds)
    groups = (tree.bodies, tree.loads, tree.constraints, tree.rotors, tree.springs, tree.jets)
    yield from (row for group in groups for part in group for row in part.measured())
