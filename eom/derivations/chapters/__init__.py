"""The chapters: derivations of the lectures' equations and of what goes beyond them.

In: nothing; a function for each derivation, which `eom.derivations.derive` asks for by name.
Imports: `eom.derivations`, `eom.exact`, `eom.expressions`, `eom.kinematics`, `eom.mass`,
`eom.mechanics`, `eom.quantities`, `eom.system`, `eom.terms`, `eom.terms.rules`.
"""
