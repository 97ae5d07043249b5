"""Constraints: relations, which of them are independent, multipliers or elimination.

In: a tree with constraints. Out: consistent configurations and equations of motion that keep the
relations.
Imports: `eom.errors`, `eom.multibody.algebra`, `eom.multibody.model`, `eom.multibody.recursion`,
`eom.quantities`, `eom.system`.
"""
