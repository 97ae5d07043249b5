"""Steady states, linear motion about them, sensitivities.

In: compiled systems. Out: `Equilibrium`, eigenvalues and modes, derivatives of trajectories.
Imports: `codegen.compiling`, `codegen.derivatives`, `codegen.frontend`, `codegen.integrate`,
`codegen.ir`, `codegen.native`, `codegen.runs`, `eom.errors`, `eom.quantities`, `eom.system`.
"""
