"""Live pages: the equations of a scene, integrated where they are looked at.

In: a scene. Out: one page of HTML with generated JavaScript.
Imports: `codegen.frontend`, `codegen.ir`, `codegen.loops`, `codegen.passes`, `codegen.targets`,
`eom.errors`, `eom.kinematics`, `eom.mechanics`, `eom.multibody.algebra`,
`eom.multibody.constrained`, `eom.multibody.files`, `eom.multibody.model`, `eom.multibody.recursion`,
`eom.multibody.system`, `eom.opening`, `eom.quantities`, `eom.rotations`, `eom.scenes`, `eom.system`,
`eom.terms`, `eom.typeset`, `eom.views.animation`, `eom.views.draw`.
"""
