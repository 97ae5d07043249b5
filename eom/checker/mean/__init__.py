"""What symbols mean: trees become typed values with dimensions.

In: statements, a lexicon, the words around them. Out: claims, the system or solid that a note is about,
findings on what does not fit.
Imports: `eom.checker.read`, `eom.errors`, `eom.expressions`, `eom.fields`, `eom.kinematics`,
`eom.limits`, `eom.mass`, `eom.mechanics`, `eom.multibody.files`, `eom.opening`, `eom.quantities`,
`eom.rotations`, `eom.scenes`, `eom.system`, `eom.terms`, `eom.typeset`, `eom.units`, `eom.worlds`.
"""
