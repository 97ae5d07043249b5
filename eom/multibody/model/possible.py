"""What numbers for the parameters of a tree must hold, so that its bodies can exist, as assumptions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp

from eom.mass.inertia import physical
from eom.multibody.algebra.values import is_number
from eom.quantities import Assumption

if TYPE_CHECKING:
    from eom.multibody.model.model import Body, Tree

SLACK = 1e-12
"""Of conditions on moments, relative to the largest of the values that they are made of."""


def assumptions(tree: Tree) -> tuple[Assumption, ...]:
    """Return that masses are not negative, and that moments of inertia obey the triangle inequality.

    One for each body, and each rotor, of which parameters decide that; numbers were tested when the tree
    was made. A guard tests them on values (`codegen.frontend.structure`), those of ensembles, too.
    """
    found = [a for body in tree.bodies for a in _of_body(body)]
    for rotor in tree.rotors:
        found += _not_negative(rotor.inertia, f"rotor {rotor.name}", "inertia")
    for constraint in tree.constraints:
        for word in ("radius", "length"):
            size = getattr(constraint, word, 1)
            found += _not_negative(size, f"constraint {constraint.name}", word)
    return tuple(found)


def _not_negative(given: Any, where: str, what: str) -> list[Assumption]:
    if is_number(given) or not isinstance(given, sp.Expr):
        return []
    meaning = f"{what} of {where} is not negative"
    return [Assumption(f"{what}_not_negative", meaning, nonnegative=(given,), tolerance=0.0)]


def _of_body(body: Body) -> list[Assumption]:
    found = _not_negative(body.mass, f"body {body.name}", "mass")
    J = body.central_inertia
    if all(is_number(x) for row in J for x in row):
        return found
    conditions = physical(
        sp.ImmutableMatrix([[sp.sympify(x, strict=True) for x in row] for row in J])
    )
    meaning = (
        f"no moment of inertia of body {body.name} about its centre of mass exceeds the sum of the "
        "other two (triangle inequality)"
    )
    return [
        *found,
        Assumption(
            "physical_inertia", meaning, nonnegative=conditions.nonnegative, tolerance=SLACK
        ),
    ]
