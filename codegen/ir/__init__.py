"""The program: operations, instructions, folding laws, groups of results, the reference evaluator.

In: numbers and slots. Out: `Program`s, their values in doubles, to 50 digits and with error bounds.
Imports: `eom.errors`, `eom.fields`, `eom.tables`.
"""
