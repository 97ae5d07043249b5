"""A whole note: context, errors carried forward, remarks; many notes in processes.

In: files or texts, settings. Out: a `Report` each.
Imports: `eom.checker.consequence`, `eom.checker.infer`, `eom.checker.judge`,
`eom.checker.mean`, `eom.checker.prose_claims`, `eom.checker.read`, `eom.checker.repair`,
`eom.checker.report`, `eom.derivations`, `eom.errors`, `eom.fields`, `eom.interrupts`,
`eom.limits`, `eom.opening`, `eom.system`, `eom.terms`, `eom.terms.rules`, `eom.typeset`,
`eom.worlds`.
"""
