"""A tree as a `System`.

In: a tree. Out: its system with outputs, constants, reactions; residual form.
Imports: `eom.errors`, `eom.limits`, `eom.multibody.algebra`, `eom.multibody.constrained`,
`eom.multibody.model`, `eom.multibody.recursion`, `eom.quantities`, `eom.system`.
"""
