"""From a program and a target to functions.

In: systems, programs. Out: `Compiled`, its Jacobians and batches, events, inputs, systems in time since
a start.
Imports: `codegen.derivatives`, `codegen.frontend`, `codegen.ir`, `codegen.loops`, `codegen.native`,
`codegen.passes`, `codegen.targets`, `eom.errors`, `eom.limits`, `eom.quantities`, `eom.system`.
"""
