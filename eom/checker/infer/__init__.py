"""What a note's symbols mean, found from the note itself: words, books, types.

In: a document. Out: a draft of its lexicon, each entry with its evidence.
Imports: `eom.checker.mean`, `eom.checker.read`, `eom.errors`, `eom.limits`, `eom.terms`.
"""
