"""Run time against error: programs side by side on the same cases.

In: cases with references. Out: points of time and error.
Imports: `codegen.compiling`, `codegen.frontend`, `codegen.integrate`, `codegen.native`,
`codegen.precision`, `codegen.runs`, `eom.errors`, `eom.system`.
"""
