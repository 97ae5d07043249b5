"""The C compiler and its cache, children and memory; what loops and drivers hand each other.

In: C text. Out: loaded functions, trajectories.
Imports: `codegen.ir`, `eom.errors`.
"""
