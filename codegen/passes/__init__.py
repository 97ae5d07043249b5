"""From program to program, each pass with its law.

In: programs. Out: programs of the same values that cost less or lose fewer digits.
Imports: `codegen.frontend`, `codegen.ir`, `eom.errors`, `eom.system`.
"""
