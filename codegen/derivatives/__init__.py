"""Derivatives of programs.

In: programs. Out: programs of Jacobians, products, Taylor recurrences.
Imports: `codegen.frontend`, `codegen.ir`, `codegen.passes`, `eom.errors`, `eom.tables`.
"""
