"""SymPy's mechanics in and out.

In: its joints and bodies, or a tree. Out: a tree, or Lagrange's method of it.
Imports: `eom.errors`, `eom.exact`, `eom.kinematics`, `eom.multibody.algebra`, `eom.multibody.closed`,
`eom.multibody.model`, `eom.quantities`, `eom.system`.
"""
