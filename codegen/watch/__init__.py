"""What no step may pass over.

In: programs. Out: how far arguments may move, which are watched, bounds by intervals.
Imports: `codegen.derivatives`, `codegen.ir`, `eom.errors`, `eom.tables`.
"""
