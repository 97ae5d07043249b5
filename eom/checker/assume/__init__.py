"""What a note assumes, in words and formulas.

In: pieces of a note. Out: assumptions by the formulas for which they hold.
Imports: `eom.checker.judge`, `eom.checker.mean`, `eom.checker.read`, `eom.errors`, `eom.terms`,
`eom.worlds`.
"""
