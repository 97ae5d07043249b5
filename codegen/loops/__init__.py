"""Texts of integrators with their whole loop.

In: programs, tableaux. Out: C and JavaScript: steps, Taylor coefficients, projection, events, look-out.
Imports: `codegen.derivatives`, `codegen.frontend`, `codegen.ir`, `codegen.native`, `codegen.passes`,
`codegen.targets`, `codegen.watch`, `eom.errors`, `eom.fields`, `eom.quantities`.
"""
