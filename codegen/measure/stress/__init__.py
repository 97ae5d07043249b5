"""Numerical stability: checks that are measured, each against a bound that follows from something.

In: systems and runs. Out: rows of measured and allowed.
Imports: `codegen.closed`, `codegen.compiling`, `codegen.frontend`, `codegen.integrate`, `codegen.ir`,
`codegen.measure.workprecision`, `codegen.native`, `codegen.passes`, `codegen.precision`,
`codegen.runs`, `codegen.targets`, `eom.errors`, `eom.interrupts`, `eom.quantities`, `eom.rotations`,
`eom.system`, `eom.tables`.
"""
