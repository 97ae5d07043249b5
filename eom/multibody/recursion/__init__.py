"""Recursions over a tree, for scalars of any kind.

In: a tree and the values of its coordinates and speeds. Out: motion, forces, mass matrix, forward and
inverse dynamics, energies, counts of operations.
Imports: `eom.errors`, `eom.fields`, `eom.multibody.algebra`, `eom.multibody.model`.
"""
