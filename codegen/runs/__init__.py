"""One run: arguments in, a `Result` out, and how good it is.

In: a system, initial values, a span. Out: `Result`s, drift, estimates of error, files.
Imports: `codegen.compiling`, `codegen.frontend`, `codegen.integrate`, `codegen.ir`, `codegen.loops`,
`codegen.native`, `codegen.precision`, `eom.displays`, `eom.errors`,
`eom.quantities`, `eom.system`.
"""
