"""What counts as an expression, and its parts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Any

import sympy as sp

from eom.errors import InputError, shown

Expr = Any  # a SymPy expression; SymPy ships no types


def as_expression(value: Any) -> Expr:
    """Return a number or SymPy expression as a SymPy expression; text is never read as one.

    Raises `InputError` for everything else, strings above all.
    """
    try:
        if isinstance(value, str | bytes | Mapping):
            raise TypeError
        return sp.sympify(value, strict=True)
    except (sp.SympifyError, TypeError, ValueError, AttributeError):
        raise InputError(
            "not a number or a SymPy expression",
            got=shown(value),
            hint="build expressions from SymPy symbols; formulas as text belong in a scene",
        ) from None


def saturate(value: Any, low: Any, high: Any) -> Expr:
    """Return ``value`` where it is between ``low`` and ``high``, else the nearer of the two.

    Parameters
    ----------
    value : number or expression
        What is limited, in one unit with the limits.
    low, high : number or expression
        The limits.

    Returns
    -------
    expression
        Of expressions max(low, min(value, high)), whose kinks runs find as they find those of any
        formula; where ``low`` is above ``high`` that is ``low``.

    Raises
    ------
    InputError
        For numbers in the wrong order, and what is no expression.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> saturate(x, -1, 1).subs(x, 3)
    1
    """
    value, low, high = map(as_expression, (value, low, high))
    for name, given in (("value", value), ("low", low), ("high", high)):
        if not isinstance(given, sp.Expr) or given.is_extended_real is False or given is sp.nan:
            raise InputError("only real numbers have an order", where=f"saturate, {name}",
                             got=shown(given), expected="a real number or expression")  # fmt: skip
    if (low > high) == True:  # noqa: E712 - may be undecided
        raise InputError("limits are in the wrong order", where="saturate",
                         got=f"{shown(low)} to {shown(high)}", expected="the lower one first")  # fmt: skip
    as_written = not value.is_number  # comparing long expressions would take SymPy minutes
    return sp.Max(low, sp.Min(value, high, evaluate=not as_written), evaluate=not as_written)


def nodes(expressions: Iterable[Expr]) -> Iterator[Expr]:
    """Yield each distinct subexpression of some expressions once."""
    stack = list(expressions)
    seen = set(stack)
    while stack:
        node = stack.pop()
        yield node
        fresh = [a for a in node.args if a not in seen]
        seen.update(fresh)
        stack += fresh


UNUSABLE = (sp.Derivative, sp.core.function.AppliedUndef)


def is_over(expression: Expr, known: set[Expr]) -> bool:
    """Return quickly whether an expression is one, over known symbols, with no function of time in it."""
    if not isinstance(expression, sp.Basic):
        return False
    for node in objects(expression):
        if node.is_Symbol:
            if node not in known:
                return False
        elif isinstance(node, UNUSABLE):
            return False
    return True


def objects(expression: Expr) -> list[Expr]:
    """Return an expression and its parts, each object that has parts once: nothing is compared."""
    found = [expression]
    seen: set[int] = set()  # all that is seen stays in the list: no number is used again
    for node in found:
        args = node.args
        if args and id(node) not in seen:
            seen.add(id(node))
            found += args
    return found


def free_symbols(expressions: Iterable[Expr]) -> set[Expr]:
    """Return the free symbols of some expressions, however deep they nest: SymPy's own walk recurses.

    What has a rule of its own (an integral, a sum over an index) is asked itself.
    """
    found: set[Expr] = set()
    stack = list(expressions)
    seen = set(stack)
    while stack:
        node = stack.pop()
        kind: Any = type(node)
        if not node.args or _binds(kind):
            found |= node.free_symbols
            continue
        fresh = [a for a in node.args if a not in seen]
        seen.update(fresh)
        stack += fresh
    return found


@cache
def _binds(kind: type) -> bool:
    """Return whether expressions of a type have a rule of their own for their free symbols."""
    own = next(vars(c)["free_symbols"] for c in kind.__mro__ if "free_symbols" in vars(c))
    return own is not vars(sp.Basic)["free_symbols"]


def replaced(expression: Expr, rule: Mapping[Expr, Expr]) -> Expr:
    """Return an expression with some of its parts replaced, each distinct part once.

    Law: what ``expression.xreplace(rule)`` gives, without its recursion and without walking again
    through what occurs twice.
    """
    if not rule:
        return expression
    new: dict[Expr, Expr] = dict(rule)
    stack = [expression]
    while stack:
        node = stack[-1]
        waiting = [a for a in node.args if isinstance(a, sp.Basic) and a not in new]
        if node in new or not waiting:
            stack.pop()
            new.setdefault(node, _with_arguments(node, new))
        else:
            stack += waiting
    return new[expression]


def _with_arguments(node: Expr, new: Mapping[Expr, Expr]) -> Expr:
    """Return a node over the replacements of its arguments; the node itself where none changes."""
    arguments = [new.get(a, a) for a in node.args]
    same = all(x is y for x, y in zip(arguments, node.args, strict=True))
    return node if same else node.func(*arguments)
