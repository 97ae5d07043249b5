"""What rules are made of: applying them everywhere, to one place, or until nothing changes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import reduce

from eom.terms.terms import Term, replace

Rule = Callable[[Term], Term]


def everywhere(rule: Rule) -> Rule:
    """Return the rule that applies ``rule`` to every node, children first."""
    return lambda term: replace(term, rule)


def until_stable(rule: Rule) -> Rule:
    """Apply ``rule`` to all nodes again and again until nothing changes."""

    def repeated(term: Term) -> Term:
        for _ in range(50):
            new = replace(term, rule)
            if new == term:
                return term
            term = new
        raise AssertionError("a rule does not come to an end")

    return repeated


def at(target: Term, *rules: Rule) -> Rule:
    """Return ``rules`` applied to the occurrences of ``target`` alone."""
    return lambda term: replace(term, lambda n: apply(rules, n) if n == target else n)


def inside(head: str, *rules: Rule) -> Rule:
    """Return ``rules`` applied within the nodes of one head."""

    def rule(node: Term) -> Term:
        return apply(rules, node) if node.head == head else node

    return lambda term: replace(term, rule)


def apply(rules: Iterable[Rule], term: Term) -> Term:
    """Apply rules one after the other."""
    return reduce(lambda t, rule: rule(t), rules, term)


# -- replacing by what is known --------------------------------------------------------------
