"""What bodies are, how they hang together, and what holds them: data that is checked.

In: numbers and symbols. Out: `Tree`s of bodies, joints, attachments and constraints.
Imports: `eom.dimensions`, `eom.errors`, `eom.kinematics`, `eom.mass`, `eom.multibody.algebra`,
`eom.quantities`, `eom.structure`, `eom.system`.
"""
