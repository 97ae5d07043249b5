"""What would make a wrong line true, and where it fails.

In: a wrong claim with the trees of its note. Out: corrections in the writer's LaTeX, states in small
numbers, what is left over.
Imports: `eom.checker.judge`, `eom.checker.mean`, `eom.checker.read`, `eom.checker.report`,
`eom.errors`, `eom.exact`, `eom.fields`, `eom.system`, `eom.terms`, `eom.worlds`.
"""
