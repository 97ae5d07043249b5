"""From a system, or SymPy's mechanics, to a program.

In: a `System`. Out: a program, the layout of its arrays, what is known of its structure.
Imports: `codegen.ir`, `eom.errors`, `eom.limits`, `eom.quantities`, `eom.system`, `eom.tables`,
`eom.units`.
"""
