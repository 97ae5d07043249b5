"""What a note's symbols mean, found from the note itself: words, systems, books, types.

In: a document. Out: a draft of its lexicon, each entry with its evidence; what is open.
Imports: `eom.checker.judge`, `eom.checker.mean`, `eom.checker.read`, `eom.checker.report`, `eom.errors`,
`eom.limits`, `eom.terms`, `eom.worlds`.
"""
