"""Random exact models of mechanics, in which statements are true or not.

In: assumptions; systems. Out: worlds and solutions, and the values of terms in them.
Imports: `eom.errors`, `eom.exact`, `eom.fields`, `eom.limits`, `eom.rotations`, `eom.system`,
`eom.terms`.
"""
