"""Checking of hand derivations: a note is read, given meaning and judged line by line.

In: Markdown, LaTeX, notebooks, code. Out: a report: verdicts with reasons, repairs and counterexamples.
Imports: nothing of ours.
"""
