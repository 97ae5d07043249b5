"""Why a comparison is wrong: the sign turned, or a slip in one of its sides; where the opposite holds.

Why a relation between free scalars is wrong: slips that were made, what is left over, small numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain, islice, pairwise
from typing import Any

import sympy as sp

from eom.checker.judge.inequalities import ORDERS, difference
from eom.checker.judge.judge import HOLDS, WRONG, judge, models_of
from eom.checker.judge.notes import Understood, reread
from eom.checker.judge.scalars import Scalars
from eom.checker.mean.claims import PROPORTIONAL, Claim
from eom.checker.mean.values import Value
from eom.checker.read.grammar import read_formula
from eom.checker.read.paths import Path, at, find, put
from eom.checker.read.spans import Span
from eom.checker.read.symbol_shape import seen
from eom.checker.read.syntax import Addition, Group, Integral, Node, Number, Relation, walk
from eom.checker.read.writing import latex
from eom.checker.repair.candidates import Workshop
from eom.checker.repair.counterexample import base_of, failing
from eom.checker.repair.lines import (
    Addend,
    Line,
    Palette,
    around,
    line,
    palette,
    statement_of,
    symbols,
    worth,
)
from eom.checker.repair.residual import Pools
from eom.checker.repair.slips import edits
from eom.checker.report.findings import Correction, Counterexample, Explanation
from eom.errors import InputError
from eom.fields import Singular
from eom.worlds.evaluate import Evaluator
from eom.worlds.special import revealing

TRIED = 60
"""Slips of the sides that are tried at most."""
SHOWN = 3
TURNED: dict[str, tuple[str, ...]] = {
    "<": (">", ">="),
    ">": ("<", "<="),
    "<=": (">=", ">"),
    ">=": ("<=", "<"),
}
"""What may have been meant by a sign of order: its contrary, strictly or not."""


_WRITTEN = {"<": "<", ">": ">", "<=": r"\le", ">=": r"\ge"}


@dataclass(frozen=True)
class _Tried:
    """A tree in which a slip is undone, with words for it, and where the slip is."""

    tree: Node
    change: str
    slip: str
    place: Node
    new: str


def unordered(
    understood: Understood, claim: Claim, given: Iterable[str] = ()
) -> Explanation | None:
    """Return why a chain with signs of order is wrong; None for a claim that is none."""
    if not ORDERS & set(claim.relations) or understood.formula.reading is None:
        return None
    given = tuple(given)
    wrong = line(understood, claim)
    k = _link(claim, given)
    if wrong is None or k is None:
        return Explanation()
    found = islice(_repairs(understood, wrong, k, given), SHOWN)
    members = tuple(m for m in wrong.members if m.number in {k, k + 1})
    pair = replace(wrong, members=members)
    shop = Workshop(pair, {}, _values(pair), Pools(pair, _values(pair)))
    return Explanation(
        residual=latex(_difference(wrong, k)),
        blamed=tuple(at(wrong.tree, m.path).span for m in members if m.path is not None),
        corrections=tuple(found),
        counterexample=failing(shop, (members[0], members[1]), given)
        if len(members) == 2
        else None,
    )


def _link(claim: Claim, given: tuple[str, ...]) -> int | None:
    """Return the first link that is wrong by itself."""
    for k, relation in enumerate(claim.relations):
        if relation in ORDERS and judge(_alone(claim, k), given).verdict == WRONG:
            return k
    return None


def _alone(claim: Claim, k: int) -> Claim:
    """Return a link of a chain as a claim."""
    return replace(claim, members=claim.members[k : k + 2], relations=claim.relations[k : k + 1])


def _values(pair: Line) -> dict[Addend, Value | None]:
    return {a: worth(pair, a.node) for m in pair.members for a in m.addends}


def _difference(wrong: Line, k: int) -> Node:
    """Return the left less the right side, as they are written."""
    left, right = (at(wrong.tree, m.path) for m in wrong.members[k : k + 2] if m.path is not None)
    if right == Number("0"):
        return left
    if left == Number("0"):
        return Addition((_bracketed(right),), ("-",))
    return Addition((left, _bracketed(right)), ("", "-"))


def _bracketed(node: Node) -> Node:
    return Group(node) if isinstance(node, Addition) else node


# -- repairs -----------------------------------------------------------------------------------------


def _edited(
    tree: Node, sides: Iterable[tuple[Path | None, float]], have: Palette, most: int
) -> Iterator[_Tried]:
    """Yield a formula with one slip undone in a side, the likeliest first.

    ``sides``: their places, and what it weighs more to edit them; ``most``: slips that are tried.
    """
    found = [
        (e.weight + more, e, path)
        for path, more in sides
        if path is not None
        for e in edits(at(tree, path), have)
    ]
    for _, edit, path in sorted(found, key=lambda f: f[0])[:most]:
        old, new = latex(edit.first.old), latex(edit.first.new)
        change = f"{edit.slip.words}: ${old}$ should be ${new}$"
        whole = put(tree, path, edit.tree)
        yield _Tried(whole, change, edit.slip.name, at(tree, path), latex(edit.tree))


def _corrected(
    understood: Understood, tried: Iterable[_Tried], mends: Callable[[tuple[Claim, ...]], bool]
) -> Iterator[Correction]:
    """Yield those formulas of which the claims are right when they are read again."""
    for one in tried:
        with suppress(InputError):
            claims = reread(understood, one.tree)
            if len(claims) == len(understood.claims) and mends(claims):
                text = latex(one.tree)
                yield Correction(text, one.change, one.slip, one.place.span, one.new)


def _repairs(
    understood: Understood, wrong: Line, k: int, given: tuple[str, ...]
) -> Iterator[Correction]:
    sides = [(m.path, 0.0) for m in wrong.members[k : k + 2]]
    slips = _edited(wrong.tree, sides, palette(understood, wrong), TRIED)

    def mends(claims: tuple[Claim, ...]) -> bool:
        claim, link = claims[wrong.number], _alone(claims[wrong.number], k)
        possible = not claim.verdict and not _empty(link) and _may_hold(link)
        return possible and judge(link, given).verdict == HOLDS

    return _corrected(understood, chain(_turned(wrong, k), slips), mends)


def _may_hold(link: Claim) -> bool:
    """Return whether a comparison holds in one special motion, so that more worlds are worth their time."""
    special = next(revealing(frozenset()))
    try:
        term, _ = difference(link)
        return bool(Evaluator(special.world, link.scalars).lowest(term) >= 0)
    except (InputError, Singular):
        return True


def _empty(claim: Claim) -> bool:
    """Return whether a claim compares two things that are the same."""
    return any(a.term == b.term for a, b in zip(claim.members, claim.members[1:], strict=False))


def _turned(wrong: Line, k: int) -> Iterator[_Tried]:
    """Yield the line with the sign of order turned, the likelier one first."""
    found = _relation(wrong, k)
    if found is None:
        return
    path, relation, place = found
    sign = relation.signs[place]
    for name in TURNED.get(sign.name, ()):
        signs = (*relation.signs[:place], replace(sign, name=name), *relation.signs[place + 1 :])
        tree = put(wrong.tree, path, replace(relation, signs=signs))
        text = _WRITTEN[name]
        change = f"the sign of order: ${_WRITTEN[sign.name]}$ should be ${text}$"
        yield _Tried(tree, change, "sign of order", sign, text)


def _relation(wrong: Line, k: int) -> tuple[Path, Relation, int] | None:
    """Return the chain that holds a link: its path, itself, the place of the link."""
    path = wrong.members[k].path
    if path is None:
        return None
    for end in range(len(path) - 1, -1, -1):
        here = at(wrong.tree, path[:end])
        if isinstance(here, Relation):
            return path[:end], here, path[end][1][0]
    return None


TRIED_SCALARS = 240
"""Slips that are tried at most."""
INSIDE = 0.2
"""What it weighs more to edit a side that integrates: the slip is rather in the value."""
MAX_TERMS = 4
"""Terms of what is left over at most."""
DRAWN = ((1, 2, 3, 4), (2, 3, 1, 5), (3, 1, 2, 4))
"""Small numbers for the letters, in the order of the alphabet."""
MAX_DIGITS = 14

Expr = Any


def between_scalars(understood: Understood, claim: Claim) -> Explanation | None:
    """Return why a relation between free scalars is wrong; None for any other claim."""
    models = models_of(claim)
    if not isinstance(models, Scalars) or understood.formula.reading is None:
        return None
    statement = statement_of(understood, claim)
    if statement is None or models.wrong is None or PROPORTIONAL in claim.relations:
        return Explanation()
    k = models.wrong
    members = statement.members[k : k + 2]
    left, right = (e.xreplace(models.meanings) for e in models.said[k])
    letters = _letters(members)
    return Explanation(
        residual=_residual(left - right, letters),
        blamed=_blamed(models, members, k),
        corrections=tuple(islice(_scalar_repairs(understood, models, k, members), SHOWN)),
        counterexample=_example(members, left, right, letters),
    )


def _blamed(models: Scalars, members: tuple[Node, ...], k: int) -> tuple[Span, ...]:
    """Return the side at fault: the right one, or the left one where the rest of the chain agrees."""
    rest = range(1, len(models.said))
    left = k == 0 and rest and all(map(models.agrees, rest))
    return (members[0 if left else 1].span,)


def _scalar_repairs(
    understood: Understood, models: Scalars, k: int, members: tuple[Node, ...]
) -> Iterator[Correction]:
    """Yield the formula with one slip undone, so that the link is an identity; the likeliest first.

    Where no slip is known that does, the side that is no integral is given the value of the other.
    """
    tree = understood.formula.reading.tree  # type: ignore[union-attr]
    number = next(j for j, c in enumerate(understood.claims) if c is models.claim)
    sides = [(find(tree, m), INSIDE if _integrates(m) else 0.0) for m in members]
    near = _near(understood, members)
    done: set[tuple[Expr, ...]] = set()

    def mends(claims: tuple[Claim, ...]) -> bool:
        found = _mended(replace(understood, claims=claims), claims[number], k)
        new = bool(found) and found not in done
        done.add(found)
        return new

    slips = _edited(tree, sides, Palette(symbols=near, factors=near[:8], near=()), TRIED_SCALARS)
    found = _corrected(understood, slips, mends)
    first = next(found, None)
    if first is not None:
        yield first
        yield from found
    else:
        yield from _corrected(understood, _valued(tree, models.said[k], members), mends)


def _integrates(node: Node) -> bool:
    return any(isinstance(n, Integral) for n in walk(node))


def _valued(tree: Node, values: tuple[Expr, ...], members: tuple[Node, ...]) -> Iterator[_Tried]:
    """Yield the formula with one side replaced by the value of the other."""
    place = 0 if _integrates(members[1]) and not _integrates(members[0]) else 1
    old, path = members[place], find(tree, members[place])
    value = sp.factor_terms(sp.expand(values[1 - place]))
    with suppress(InputError):
        new = read_formula(_named(value, _letters(members))).tree
        whole = put(tree, path, new) if path is not None else tree
        change = f"another value: ${latex(old)}$ should be ${latex(new)}$"
        yield _Tried(whole, change, "value", old, latex(new))


def _mended(understood: Understood, claim: Claim, k: int) -> tuple[Expr, ...]:
    """Return both sides of a link that is an identity in another formula; none where it is not."""
    models = models_of(claim)
    if not isinstance(models, Scalars) or k not in models.links:
        return ()
    nodes = statement_of(understood, claim)
    alike = nodes is None or any(a == b for a, b in pairwise(nodes.members))
    if alike or models.wrong is not None or not models.agrees(k):
        return ()
    return tuple(map(sp.expand, models.said[k]))


def _near(understood: Understood, members: tuple[Node, ...]) -> tuple[Node, ...]:
    """Return letters of the relation, then of the note around it."""
    trees = [*members, *around(understood)]
    return tuple(dict.fromkeys(n for t in trees for n in symbols(t) if _is_letter(n)))[:16]


def _is_letter(node: Node) -> bool:
    given = seen(node)
    return given is not None and given.look.name.isalpha() and not given.dots


# -- what is left over, and numbers --------------------------------------------------------------------


def _letters(members: tuple[Node, ...]) -> dict[str, str]:
    """Return the LaTeX of letters, by the names of their symbols."""
    found: dict[str, str] = {}
    for node in (n for m in members for n in symbols(m)):
        given, plain = seen(node), latex(base_of(node))
        if given is not None:
            for look in (given.look, given.with_label()):
                if look is not None:
                    found.setdefault(look.text, plain)
    return found


def _named(expression: Expr, letters: Mapping[str, str]) -> str:
    names = {s: letters.get(s.name, s.name) for s in expression.free_symbols}
    return str(sp.latex(expression, symbol_names=names, fold_short_frac=False))


def _residual(difference: Expr, letters: Mapping[str, str]) -> str:
    """Return the left less the right side, "" where it is long or cannot be read."""
    found = sp.expand(difference)
    if found == 0 or len(sp.Add.make_args(found)) > MAX_TERMS:
        return ""
    try:
        return latex(read_formula(_named(found, letters)).tree)
    except InputError:
        return ""


def _example(
    members: tuple[Node, ...], left: Expr, right: Expr, letters: Mapping[str, str]
) -> Counterexample | None:
    """Return small numbers for the letters at which both sides are computed and differ."""
    free = sorted(left.free_symbols | right.free_symbols, key=str)
    for row in DRAWN:
        values = {s: sp.Integer(row[k % len(row)]) for k, s in enumerate(free)}
        sides = [sp.simplify(e.xreplace(values)) for e in (left, right)]
        if (
            any(s.has(sp.zoo, sp.nan, sp.oo) for s in sides)
            or sp.simplify(sides[0] - sides[1]) == 0
        ):
            continue
        texts = [str(sp.latex(s)) for s in sides]
        if max(map(len, texts)) <= 4 * MAX_DIGITS:
            shown = tuple((letters.get(s.name, s.name), str(v)) for s, v in values.items())
            return Counterexample(shown, tuple(zip(map(latex, members), texts, strict=True)))
    return None
