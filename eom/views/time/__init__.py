"""Histories of a run, and run time against error.

In: results, measured points. Out: pictures.
Imports: `codegen.measure.workprecision`, `codegen.runs`, `eom.errors`, `eom.opening`, `eom.quantities`,
`eom.system`, `eom.views.draw`.
"""
