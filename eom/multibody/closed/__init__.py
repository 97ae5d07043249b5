"""Closed forms of small trees by Lagrange, Kane and Newton-Euler, term by term.

Imports: `eom.derivations`, `eom.errors`, `eom.exact`, `eom.fields`, `eom.multibody.algebra`,
`eom.multibody.model`, `eom.quantities`, `eom.system`, `eom.typeset`.
"""

from eom.multibody.closed.forms import (
    METHODS,
    ClosedForm,
    Comparison,
    Term,
    absolute_angles,
    closed_form,
    compare,
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
]
