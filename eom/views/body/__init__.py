"""Pictures of one body and its motion, and of what derivations speak of.

In: scenes, histories, moments of inertia, derivations. Out: pictures.
Imports: `codegen.closed`, `eom.derivations`, `eom.errors`, `eom.kinematics`, `eom.mass`, `eom.mechanics`,
`eom.opening`, `eom.rotations`, `eom.scenes`, `eom.terms`, `eom.typeset`, `eom.views.animation`,
`eom.views.draw`, `eom.views.time`.
"""
