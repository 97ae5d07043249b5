"""Closed forms of small trees by Lagrange, Kane and Newton-Euler, term by term, under constraints too.

Imports: `eom.derivations`, `eom.errors`, `eom.exact`, `eom.fields`, `eom.multibody.algebra`,
`eom.multibody.constrained`, `eom.multibody.model`, `eom.multibody.recursion`, `eom.quantities`,
`eom.system`, `eom.typeset`.
"""

from eom.multibody.closed.forms import (
    METHODS,
    ClosedForm,
    Comparison,
    Term,
    absolute_angles,
    closed_form,
    compare,
    with_attitude,
)
from eom.multibody.closed.pages import show, tree_page

__all__ = [
    "METHODS",
    "ClosedForm",
    "Comparison",
    "Term",
    "absolute_angles",
    "closed_form",
    "compare",
    "show",
    "tree_page",
    "with_attitude",
]
