"""What follows from the lines of a note itself, whatever their letters mean.

In: formulas with verdicts. Out: which of them follow from earlier ones, and which do but for a slip.
Imports: `eom.checker.infer`, `eom.checker.judge`, `eom.checker.mean`, `eom.checker.read`, `eom.errors`,
`eom.limits`, `eom.system`, `eom.terms`.
"""
