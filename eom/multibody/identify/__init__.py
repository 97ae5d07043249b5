"""What of a tree's parameters its motion shows.

In: a tree. Out: inverse dynamics linear in the parameters, and the base parameters.
Imports: `eom.errors`, `eom.exact`, `eom.fields`, `eom.multibody.algebra`, `eom.multibody.model`,
`eom.multibody.recursion`, `eom.quantities`, `eom.rotations`, `eom.system`.
"""
