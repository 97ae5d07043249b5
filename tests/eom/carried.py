"""Lines of a finished derivation as worlds can judge them: the way in which it verified them itself."""

from dataclasses import replace

from eom.terms.rules import apply, slopes, spelt_out


def carried(derived, equation):
    """Return a line with bodies of its own spelt out and partial derivatives carried out."""
    rules = (spelt_out(derived.own), slopes(derived.scalars, derived.own))
    left, right = (apply(rules, t) for t in (equation.left, equation.right))
    return replace(equation, left=left, right=right)
