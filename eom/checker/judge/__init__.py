"""Whether a claim is true, and under what.

In: claims. Out: judgements: verdicts with the smallest sets of assumptions.
Imports: `eom.checker.mean`, `eom.checker.read`, `eom.derivations`, `eom.errors`, `eom.exact`,
`eom.fields`, `eom.limits`, `eom.quantities`, `eom.system`, `eom.terms`, `eom.typeset`,
`eom.worlds`.
"""
