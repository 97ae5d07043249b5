"""Pictures of one body and its motion.

In: scenes, histories, moments of inertia. Out: pictures.
Imports: `codegen.closed`, `eom.errors`, `eom.kinematics`, `eom.mechanics`, `eom.opening`,
`eom.rotations`, `eom.scenes`, `eom.views.animation`, `eom.views.draw`, `eom.views.time`.
"""
