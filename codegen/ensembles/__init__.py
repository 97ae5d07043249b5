"""Many trajectories of one system, and their statistics.

In: distributions, arrays of initial values. Out: `Ensemble`s, summaries, stores on disk.
Imports: `codegen.compiling`, `codegen.frontend`, `codegen.integrate`, `codegen.ir`,
`codegen.native`, `codegen.precision`, `codegen.runs`, `eom.errors`, `eom.quantities`, `eom.system`,
`eom.units`.
"""
