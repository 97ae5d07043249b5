"""From text to statements.

In: files and texts of notes. Out: pieces in their order, formulas as trees with a place on every node,
statements.
Imports: `eom.errors`, `eom.typeset`.
"""
