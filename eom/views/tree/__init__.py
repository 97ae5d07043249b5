"""Pictures of trees of bodies.

In: trees and their scenes. Out: pictures.
Imports: `eom.errors`, `eom.multibody.algebra`, `eom.multibody.files`, `eom.multibody.model`,
`eom.multibody.recursion`, `eom.views.animation`, `eom.views.body`, `eom.views.draw`.
"""
