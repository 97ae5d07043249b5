"""How accurate generated code is, and solutions with many digits.

In: compiled systems, points. Out: errors against 50 digits with their causes; reference solutions.
Imports: `codegen.compiling`, `codegen.derivatives`, `codegen.frontend`, `codegen.ir`,
`codegen.loops`, `codegen.passes`, `codegen.watch`, `eom.displays`, `eom.errors`, `eom.quantities`,
`eom.system`, `eom.units`.
"""
