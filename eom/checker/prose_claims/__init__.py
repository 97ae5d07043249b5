"""What a note says in English: assumptions, and claims in sentences.

In: pieces of a note, its formulas judged. Out: assumptions by the formulas for which they hold; findings:
propositions that hold, fail with an example, or stay open.
Imports: `eom.checker.judge`, `eom.checker.mean`, `eom.checker.read`,
`eom.checker.repair`, `eom.checker.report`, `eom.errors`, `eom.exact`, `eom.fields`, `eom.limits`,
`eom.mechanics`, `eom.terms`, `eom.worlds`.
"""
