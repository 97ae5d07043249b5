"""Index notation: letters below symbols that stand for numbers, summed where they stand twice."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import product
from typing import Any

import sympy as sp

from eom.checker.mean.elaborator import Elaborator
from eom.checker.mean.lexicon import AXES
from eom.checker.mean.tables import (
    cell,
)
from eom.checker.mean.values import (
    UNDECIDED,
    Refusal,
    refuse,
)
from eom.checker.read.statements import Statement
from eom.checker.read.symbol_shape import Look, labels, seen
from eom.checker.read.syntax import (
    Addition,
    BigOperator,
    Node,
    Relation,
    children,
)

LETTERS = frozenset("ijklmn")
Known = Callable[[Look, Mapping[str, str]], bool]
"""Whether a symbol has a meaning where indices stand for numbers."""
COUNTS = tuple(map(str, range(1, 13)))
AXIAL = 3
"""How many numbers an index takes where no symbol limits it."""
MAX_DUMMIES, MAX_FREE = 4, 4
UNIT = ("delta", 2)
ALTERNATING = (("epsilon", 3), ("varepsilon", 3), ("e", 3))


def run_over(node: BigOperator) -> tuple[str, ...]:
    """Return the letters over which a sum runs; none of a sum that leaves one out, and of no sum."""
    try:
        found, excluded = indices_of(node)
    except Refusal:
        return ()
    return () if excluded or node.sign != "sum" else found


def indices_of(node: BigOperator) -> tuple[tuple[str, ...], str]:
    """Return the indices of a sum, and the label that its only index does not take."""
    lower = node.lower
    if isinstance(lower, Relation) and len(lower.members) == 2:
        first, second = (labels(m) for m in lower.members)
        start = lower.signs[0].name == "=" and second == ("1",)
        if len(first) == 1 and start:
            return first, ""
        if len(first) == len(second) == 1 and lower.signs[0].name == "!=":
            return first, second[0]
    elif lower is not None:
        found = tuple(w for w in labels(lower) if w != ",")
        if found and all(len(w) == 1 and w.isalpha() for w in found):
            return found, ""
    raise refuse(UNDECIDED, "a sum over something unknown", node.span, expected="such as i = 1")


def numbered(look: Look, indices: Mapping[str, str]) -> Any:
    """Return the number that Kronecker's or Levi-Civita's symbol is; None for anything else."""
    given = [indices.get(w, w) for w in look.sub]
    shape = (look.name, len(given))
    axes = given if shape == UNIT and all(map(str.isdigit, given)) else [AXES.get(g) for g in given]
    if None in axes or look.accents or look.sup or shape not in {UNIT, *ALTERNATING}:
        return None
    values = [int(a) for a in axes if a is not None]
    return sp.KroneckerDelta(*values) if shape == UNIT else sp.LeviCivita(*values)


def _below(look: Look, known: Known) -> tuple[str, ...]:
    """Return the letters below a symbol that stand for numbers, with which it has a meaning."""
    letters = tuple(w for w in look.sub if w in LETTERS)
    whole = letters and not known(look, {}) and known(look, dict.fromkeys(letters, "1"))
    return letters if whole else ()


def indexed(node: Node, known: Known) -> Iterator[tuple[Look, tuple[str, ...]]]:
    """Yield the symbols of a formula that have a meaning with numbers for indices below, and these."""
    found = seen(node)
    if found is None:
        for part in children(node):
            yield from indexed(part, known)
    elif letters := _below(found.look, known):
        yield found.look, letters


def letters_of(node: Node, known: Known) -> Iterator[str]:
    """Yield the indices of a term as often as they stand there, of a sum those of its terms once."""
    if isinstance(node, Addition):
        yield from frozenset[str]().union(*(once(t, known) for t in node.terms))
        return
    found = seen(node)
    if found is not None:
        yield from _below(found.look, known)
    else:
        for part in children(node):
            yield from letters_of(part, known)


def numberings(
    letters: Iterable[str], trees: Iterable[Node], known: Known
) -> Iterator[dict[str, str]]:
    """Yield all numbers for letters with which every symbol that has them below has a meaning."""
    letters = tuple(letters)
    looks = [found for tree in trees for found in indexed(tree, known)]

    def runs(letter: str, number: str) -> bool:
        own = [(look, words) for look, words in looks if letter in words]
        return all(
            known(look, {**dict.fromkeys(words, "1"), letter: number}) for look, words in own
        )

    found = [[n for n in COUNTS if runs(letter, n)] for letter in letters]
    ranges = [numbers if len(numbers) < len(COUNTS) else COUNTS[:AXIAL] for numbers in found]
    yield from (dict(zip(letters, numbers, strict=True)) for numbers in product(*ranges))


def is_known(e: Elaborator, look: Look) -> bool:
    """Return whether a symbol has a meaning, or is defined."""
    own = look.numbered(e.indices)
    found = e.lexicon.find(look, e.indices) is not None or own in e.definitions
    return found or cell(e.lexicon, own) is not None


def knows(e: Elaborator) -> Known:
    """Return the test whether a symbol has a meaning, with more indices given."""

    def known(look: Look, more: Mapping[str, str]) -> bool:
        indices = {**e.indices, **more}
        return numbered(look, indices) is not None or is_known(replace(e, indices=indices), look)

    return known


def summed(node: Node, e: Elaborator) -> Iterator[dict[str, str]]:
    """Yield the values of letters that stand twice in a term, one summand each; nothing for no sum."""
    if isinstance(node, Addition | BigOperator):
        return
    known = knows(e)
    counts = Counter(w for w in letters_of(node, known) if w not in e.indices)
    twice = sorted(w for w, n in counts.items() if n == 2)
    if 0 < len(twice) <= MAX_DUMMIES:
        yield from numberings(twice, (node,), known)


def free(statement: Statement, e: Elaborator) -> tuple[dict[str, str], ...]:
    """Return all values of the letters that stand once in each term of a statement; none for no such."""
    known = knows(e)
    shared = frozenset[str]().union(*(once(m, known) for m in statement.members))
    if not 0 < len(shared) <= MAX_FREE:
        return ()
    return tuple(numberings(sorted(shared), statement.members, known))


def once(node: Node, known: Known) -> frozenset[str]:
    """Return the letters that stand once in a term, or in the terms of a sum."""
    if isinstance(node, BigOperator):
        return once(node.body, known) - frozenset(run_over(node))
    return frozenset(w for w, n in Counter(letters_of(node, known)).items() if n == 1)
