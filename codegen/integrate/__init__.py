"""Methods as a table, and what drives them.

In: a `Task`: a compiled system with its problem. Out: trajectories, by our loops, on groups, by SciPy
and SUNDIALS, in lanes.
Imports: `codegen.closed`, `codegen.compiling`, `codegen.derivatives`, `codegen.frontend`, `codegen.ir`,
`codegen.loops`, `codegen.native`, `codegen.passes`, `codegen.targets`, `codegen.watch`, `eom.errors`,
`eom.quantities`, `eom.tables`.
"""
