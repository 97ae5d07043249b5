"""Mass properties by integration, the catalogue of solids, principal axes.

In: regions, solids, meshes, inertia matrices. Out: mass, centre and inertia about a point; principal
axes and moments.
Imports: `eom.errors`, `eom.exact`, `eom.expressions`, `eom.kinematics`, `eom.quantities`.
"""
