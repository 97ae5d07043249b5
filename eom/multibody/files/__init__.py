"""Scenes of trees, and robots.

In: TOML, URDF or MJCF. Out: `TreeScene`s: trees, parameters, initial states, outputs.
Imports: `eom.errors`, `eom.kinematics`, `eom.mass`, `eom.mechanics`, `eom.multibody.algebra`,
`eom.multibody.constrained`, `eom.multibody.model`, `eom.multibody.recursion`, `eom.multibody.system`,
`eom.quantities`, `eom.rotations`, `eom.scenes`, `eom.system`, `eom.units`.
"""
