"""Tools that measure.

In: compiled systems, runs. Out: tables and pictures' data.
Imports: `codegen.native`.
"""
