"""Replacing what is known: statements, definitions, and what vanishes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eom.terms.rules.basic import Rule, everywhere
from eom.terms.terms import INDICES, Equation, Term, relabel, zero
from eom.terms.vocabulary import definition


def match(pattern: Term, term: Term, bound: Mapping[str, str]) -> dict[str, str] | None:
    """Return what the free indices of ``pattern`` stand for in ``term``, or None."""
    if (pattern.head, len(pattern.args)) != (term.head, len(term.args)):
        return None
    if pattern.head == "atom":
        return _match_labels(pattern.data, term.data, dict(bound))
    if pattern.head in {"sum", "integral"}:
        return _match_sum(pattern, term, bound)
    if pattern.data != term.data:
        return None
    found: dict[str, str] | None = dict(bound)
    for p, t in zip(pattern.args, term.args, strict=True):
        found = match(p, t, found) if found is not None else None
    return found


def _match_sum(pattern: Term, term: Term, bound: Mapping[str, str]) -> dict[str, str] | None:
    """Match the summands; the indices of the sums correspond, and nothing else stands for them."""
    ours, theirs = pattern.data[0], term.data[0]
    if pattern.data[1:] != term.data[1:]:
        return None
    found = match(pattern.args[0], term.args[0], {**bound, ours: theirs})
    if found is None:
        return None
    outer = {k: v for k, v in found.items() if k != ours}
    if theirs in outer.values():
        return None
    return {**outer, **({ours: bound[ours]} if ours in bound else {})}


def _match_labels(
    pattern: tuple[Any, ...], term: tuple[Any, ...], found: dict[str, str]
) -> dict[str, str] | None:
    if pattern[0] != term[0] or len(pattern) != len(term):
        return None
    for p, t in zip(pattern[1:], term[1:], strict=True):
        wanted = found.setdefault(p, t) if p in INDICES and t in {*INDICES, "P"} else p
        if wanted != t:
            return None
    return found


def use(statement: Equation, backwards: bool = False) -> Rule:
    """Return the rule that replaces the left side of ``statement`` by its right, for any index."""
    old, new = statement.left, statement.right
    if backwards:
        old, new = new, old

    def rule(node: Term) -> Term:
        found = match(old, node, {})
        return node if found is None else relabel(new, found)

    return everywhere(rule)


def put(old: Term, new: Term) -> Rule:
    """Return the rule that replaces ``old``, with its very indices, by ``new``."""
    return everywhere(lambda n: new if n == old else n)


def unfold(*names: str) -> Rule:
    """Return the rule that replaces the named quantities by what defines them."""

    def rule(node: Term) -> Term:
        if node.head == "atom" and node.data[0] in names:
            return definition(node) or node
        return node

    return everywhere(rule)


def fold_into(*quantities: Term) -> Rule:
    """Return the rule that replaces the definition of each quantity by its name."""

    def rule(node: Term) -> Term:
        for q in quantities:
            meaning = definition(q)
            found = match(meaning, node, {}) if meaning is not None else None
            if found is not None:
                return relabel(q, found)
        return node

    return everywhere(rule)


# -- components ------------------------------------------------------------------------------


def vanish(*terms: Term) -> Rule:
    """Return the rule that puts zero for each of ``terms``."""
    return everywhere(lambda n: zero(n.kind) if n in terms else n)
