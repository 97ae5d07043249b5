"""Closed forms, where they are proved to hold.

In: a compiled system with the values of a run. Out: trajectories of the free body, the heavy top and
the spinner.
Imports: `codegen.compiling`, `codegen.frontend`, `codegen.ir`, `codegen.native`, `codegen.targets`,
`eom.errors`, `eom.fields`, `eom.quantities`, `eom.rotations`.
"""
