r"""An index that a formula lets run over the three axes: (r = 1, 2, 3), for i = 1, 2, 3, i = x, y, z."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from eom.checker.mean.claims import Claim
from eom.checker.read.statements import Statement
from eom.checker.read.symbol_shape import labels, seen
from eom.checker.read.syntax import Dots, Group, Node, Number, Relation, Sequence, Symbol, walk

SETS = (("1", "2", "3"), ("x", "y", "z"))


def running(statements: Iterable[Statement]) -> str:
    """Return the letter that one of the statements of a formula lets run over the axes, or ""."""
    for statement in statements:
        for part in (statement, *(condition for _, condition in statement.conditions)):
            letter = listed(part)
            if letter:
                return letter
    return ""


def listed(part: Statement) -> str:
    """Return the letter that a statement lets run over the axes, or ""."""
    if len(part.members) == 2 and part.signs[0].name in {"=", "in"}:
        left, right = part.members
        inside = right.body if isinstance(right, Group) else right
        items = inside.items if isinstance(inside, Sequence) else ()
        return _over(left, items)
    if len(part.members) != 1 or not isinstance(part.members[0], Group):
        return ""
    body = part.members[0].body
    items = body.items if isinstance(body, Sequence) else ()
    first = items[0] if items else None
    if not isinstance(first, Relation) or [g.name for g in first.signs] != ["="]:
        return ""
    return _over(first.members[0], (first.members[1], *items[1:]))


def _over(left: Node, items: tuple[Node, ...]) -> str:
    """Return a letter that takes the values 1, 2, 3; dots may stand for what lies between."""
    if not isinstance(left, Symbol) or not all(
        isinstance(n, Number | Symbol | Dots) for n in items
    ):
        return ""
    words = tuple("".join(labels(n)) for n in items if not isinstance(n, Dots))
    dotted = any(isinstance(n, Dots) for n in items)
    shown = any(words == s or (dotted and words in {(s[0], s[2]), s}) for s in SETS)
    return left.name if shown else ""


def labelled(statement: Statement, letter: str) -> bool:
    """Tell whether a letter is a label of a symbol in a statement."""
    looks = (seen(n) for m in statement.members for n in walk(m))
    return any(
        g is not None and (letter,) in {c[-1:] for c in (*g.look.corners, *map(labels, g.raised))}
        for g in looks
    )


def unnamed(claim: Claim, letter: str) -> Claim:
    """Return a claim that defines no symbol with the letter as a label: it is three of them."""
    look = claim.defines
    named = look is not None and any(letter in c for c in look.corners)
    return replace(claim, defines=None) if named else claim
