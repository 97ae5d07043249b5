"""Steady states, linear motion about them, sensitivities.

In: compiled systems. Out: `Equilibrium`, eigenvalues and modes, derivatives of trajectories.
Imports: `codegen.compiling`, `codegen.derivatives`, `codegen.frontend`, `codegen.ir`, `codegen.runs`,
`eom.errors`, `eom.quantities`, `eom.system`.
"""
