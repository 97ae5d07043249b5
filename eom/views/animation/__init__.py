"""Where bodies are and what they look like: pages and films of them.

In: scenes and results. Out: tracks and figures as data, one page of HTML, GIF, APNG, WebP.
Imports: `codegen.runs`, `eom.errors`, `eom.expressions`, `eom.kinematics`, `eom.mass`,
`eom.multibody.algebra`, `eom.multibody.constrained`, `eom.multibody.files`, `eom.multibody.model`,
`eom.multibody.recursion`, `eom.multibody.system`, `eom.opening`, `eom.quantities`, `eom.rotations`,
`eom.scenes`, `eom.structure`, `eom.system`, `eom.views.draw`.
"""
