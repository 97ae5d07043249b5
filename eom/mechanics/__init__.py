"""Systems of single bodies, derived from momentum, and what is known of their motion.

In: inertia, attitude, torques. Out: `System`s; free motion, steady spins, equilibria, constants of the
motion.
Imports: `eom.dimensions`, `eom.errors`, `eom.exact`, `eom.expressions`, `eom.fields`, `eom.kinematics`,
`eom.mass`, `eom.quantities`, `eom.rotations`, `eom.structure`, `eom.system`.
"""
