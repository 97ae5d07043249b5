"""Statements of vector mechanics as typed terms.

In: names of the vocabulary. Out: terms and equations, which rules rewrite and worlds evaluate.
Imports: `eom.errors`, `eom.expressions`.
"""
