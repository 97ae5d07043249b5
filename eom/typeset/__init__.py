"""Typesetting: formulas as boxes, pages as blocks, in four notations and five markups.

In: terms, expressions, systems. Out: text, LaTeX, MathML, Markdown and HTML.
Imports: `eom.errors`, `eom.quantities`, `eom.system`, `eom.terms`.
"""
