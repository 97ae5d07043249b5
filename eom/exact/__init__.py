"""Exact arithmetic: identities and integrals that no rounding decides.

In: SymPy expressions and exact numbers. Out: values in prime fields, series, truths that are proved or
have a bound on their chance.
Imports: `eom.errors`, `eom.expressions`, `eom.fields`.
"""
