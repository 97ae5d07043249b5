"""Claims in English sentences.

In: prose around formulas. Out: findings: propositions that hold, fail with an example, or stay open.
Imports: `eom.checker.assume`, `eom.checker.judge`, `eom.checker.mean`, `eom.checker.read`,
`eom.checker.repair`, `eom.checker.report`, `eom.errors`, `eom.exact`, `eom.fields`, `eom.limits`,
`eom.mechanics`, `eom.terms`, `eom.worlds`.
"""
