"""What people look at, made from motions that `codegen` computes: the outer layer with `eom.commands`.

In: scenes, results, mass properties. Out: pictures, animations, live pages.
Imports: `codegen.measure.workprecision`, `eom.errors`, `eom.opening`, `eom.views.animation`,
`eom.views.body`, `eom.views.draw`, `eom.views.time`, `eom.views.tree`.
"""
