"""Functional mock-up units: a system with its values and its integrator as an archive for other tools.

In: compiled systems, values by name. Out: files of an archive as bytes, and the archive.
Imports: `codegen.compiling`, `codegen.frontend`, `codegen.integrate`, `codegen.ir`, `codegen.loops`,
`codegen.native`, `codegen.passes`, `codegen.runs`, `codegen.targets`, `eom.errors`,
`eom.quantities`, `eom.system`, `eom.units`.
"""
