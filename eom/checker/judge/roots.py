"""Equations of magnitudes: both sides squared where each is seen to be nothing below zero."""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.terms.terms import SCALAR, Equation, Term, expr


def squared(equation: Equation) -> Equation:
    """Return the equation of the squares if both sides are numbers or products of roots, else itself.

    What is squared is not negative, so that neither equation says more than the other.
    """
    sides = (equation.left, equation.right)
    if any(s.kind != SCALAR or s.head not in {"expr", "zero"} for s in sides):
        return equation
    found = [_square(_expression(s)) for s in sides]
    if None in found or not any(_has_root(_expression(s)) for s in sides):
        return equation
    return Equation(expr(found[0]), expr(found[1]), equation.relation)


def _expression(term: Term) -> Any:
    return term.data[0] if term.head == "expr" else sp.Integer(0)


def _has_root(expression: Any) -> bool:
    return any(
        p.is_Pow and p.exp.is_Rational and p.exp.q == 2 for p in sp.preorder_traversal(expression)
    )


def _square(expression: Any) -> Any:
    """Return the square of a product of numbers that are not negative and roots; None for others."""
    result = sp.Integer(1)
    for factor in sp.Mul.make_args(expression):
        if factor.is_Rational and factor >= 0:
            result *= factor**2
        elif factor.is_Pow and factor.exp.is_Rational and factor.exp.q == 2:
            result *= factor.base ** (2 * factor.exp)
        elif isinstance(factor, sp.Abs):
            result *= factor.args[0] ** 2
        else:
            return None
    return result
