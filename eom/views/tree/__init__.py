"""Sketches of scenes of any model, and diagrams of trees of bodies.

In: scenes, trees. Out: pictures.
Imports: `eom.errors`, `eom.mechanics`, `eom.multibody.algebra`, `eom.multibody.files`,
`eom.multibody.model`, `eom.multibody.recursion`, `eom.multibody.system`, `eom.opening`, `eom.scenes`,
`eom.views.animation`, `eom.views.body`, `eom.views.draw`.
"""
