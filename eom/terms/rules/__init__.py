"""Rewriting rules of vector mechanics: from a term to an equal one.

A rule is a function ``Term -> Term`` that knows one law; a derivation applies rules and gives the
reason. Rules know no physics beyond the calculus of vectors, sums and derivatives: everything else
enters through `use` and `put`, which replace one side of an established statement by the other.

Imports: `eom.kinematics`, `eom.terms`.
"""

from eom.terms.rules.basic import Rule, apply, at, everywhere, inside, until_stable
from eom.terms.rules.calculus import (
    combine,
    differentiate,
    differentiate_in,
    differentiate_terms,
    differentiate_under,
    distribute,
    into_sums,
    symmetrise,
    take_out,
)
from eom.terms.rules.columns import by_way_of, components, compute, entrywise, scalars_in
from eom.terms.rules.known import fold_into, match, put, unfold, use, vanish
from eom.terms.rules.vectors import (
    associate,
    bac_cab,
    commute,
    dyadic_form,
    factor_left,
    factor_right,
    flip_crosses,
    linear_in,
    order_dots,
    ordered,
    parallel,
    regroup,
    regroup_right,
    scalar_triple,
    seen_from,
    swap,
    symmetric,
    transport,
    triple_zero,
)

__all__ = [
    "Rule",
    "apply",
    "associate",
    "at",
    "bac_cab",
    "by_way_of",
    "combine",
    "commute",
    "components",
    "compute",
    "differentiate",
    "differentiate_in",
    "differentiate_terms",
    "differentiate_under",
    "distribute",
    "dyadic_form",
    "entrywise",
    "everywhere",
    "factor_left",
    "factor_right",
    "flip_crosses",
    "fold_into",
    "inside",
    "into_sums",
    "linear_in",
    "match",
    "order_dots",
    "ordered",
    "parallel",
    "put",
    "regroup",
    "regroup_right",
    "scalar_triple",
    "scalars_in",
    "seen_from",
    "swap",
    "symmetric",
    "symmetrise",
    "take_out",
    "transport",
    "triple_zero",
    "unfold",
    "until_stable",
    "use",
    "vanish",
]
