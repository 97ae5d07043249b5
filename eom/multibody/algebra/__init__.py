"""Scalars of any kind and spatial vectors over them.

In: numbers, SymPy expressions, residues, dual numbers. Out: sums and products that cost what they must;
rigid transforms.
Imports: `eom.errors`, `eom.exact`, `eom.expressions`, `eom.fields`, `eom.quantities`,
`eom.system`.
"""
