"""Scenes of one body: a file or an object becomes a system with its numbers.

In: TOML or Python. Out: `Scene`s: systems without what is left out, parameters, initial states.
Imports: `eom.dimensions`, `eom.displays`, `eom.errors`, `eom.exact`, `eom.expressions`, `eom.kinematics`,
`eom.mass`, `eom.mechanics`, `eom.proof`, `eom.quantities`, `eom.rotations`, `eom.structure`,
`eom.system`, `eom.units`.
"""
