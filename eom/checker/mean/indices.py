r"""Index notation: what stands twice in a term is summed, what stands once runs over the axes.

An index is a letter below symbols that have no meaning with it, and one with the number of an axis there:
``\epsilon_{ijk}x_jp_k``. So a letter that labels particles stays one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import product
from typing import Any

import sympy as sp

from eom.checker.mean.lexicon import AXES, Lexicon
from eom.checker.read.statements import Statement
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.syntax import Addition, BigOperator, Node, children

LETTERS = frozenset("ijklmn")
COUNTS = ("1", "2", "3")
MAX_DUMMIES, MAX_FREE = 4, 2
UNIT = ("delta", 2)
ALTERNATING = (("epsilon", 3), ("varepsilon", 3), ("e", 3))


def numbered(look: Look, indices: Mapping[str, str]) -> Any:
    """Return the number that Kronecker's or Levi-Civita's symbol is; None for anything else."""
    axes = [AXES.get(indices.get(w, w)) for w in look.sub]
    shape = (look.name, len(axes))
    if None in axes or look.accents or look.sup or shape not in {UNIT, *ALTERNATING}:
        return None
    values = [int(a) for a in axes if a is not None]
    return sp.KroneckerDelta(*values) if shape == UNIT else sp.LeviCivita(*values)


def _letters(node: Node, known: Callable[[Look, Mapping[str, str]], bool]) -> Iterator[str]:
    """Yield the indices of a term, as often as they stand there."""
    found = seen(node)
    if found is not None:
        look = found.look
        letters = [w for w in look.sub if w in LETTERS]
        if letters and not known(look, {}) and known(look, dict.fromkeys(letters, "1")):
            yield from letters
    else:
        for part in children(node):
            yield from _letters(part, known)


def _knows(lexicon: Lexicon, bound: Mapping[str, str]) -> Callable[[Look, Mapping[str, str]], bool]:
    def known(look: Look, more: Mapping[str, str]) -> bool:
        indices = {**bound, **more}
        return numbered(look, indices) is not None or lexicon.find(look, indices) is not None

    return known


def summed(node: Node, lexicon: Lexicon, bound: Mapping[str, str]) -> Iterator[dict[str, str]]:
    """Yield the values of letters that stand twice in a term, one summand each; nothing for no sum."""
    if isinstance(node, Addition | BigOperator):
        return
    counts = Counter(w for w in _letters(node, _knows(lexicon, bound)) if w not in bound)
    twice = sorted(w for w, n in counts.items() if n == 2)
    if 0 < len(twice) <= MAX_DUMMIES:
        yield from (
            dict(zip(twice, axes, strict=True)) for axes in product(COUNTS, repeat=len(twice))
        )


def free(statement: Statement, lexicon: Lexicon) -> tuple[dict[str, str], ...]:
    """Return all values of the letters that stand once in each term of a statement; none for no such."""
    known = _knows(lexicon, {})
    once = [_once(m, known) for m in statement.members]
    shared = frozenset[str]().union(*once)
    if not 0 < len(shared) <= MAX_FREE:
        return ()
    letters = sorted(shared)
    return tuple(
        dict(zip(letters, axes, strict=True)) for axes in product(COUNTS, repeat=len(letters))
    )


def _once(member: Node, known: Callable[[Look, Mapping[str, str]], bool]) -> frozenset[str]:
    """Return the letters that stand once in the terms of a member."""
    terms: Iterable[Node] = member.terms if isinstance(member, Addition) else (member,)
    counts = (Counter(_letters(t, known)) for t in terms)
    return frozenset(w for c in counts for w, n in c.items() if n == 1)
