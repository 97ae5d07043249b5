"""Why a relation between free scalars is wrong: slips that were made, what is left over, small numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from itertools import islice, pairwise
from typing import Any

import sympy as sp

from eom.checker.explanation import Correction, Counterexample, Explanation
from eom.checker.judge.notes import Understood, reread
from eom.checker.mean.claims import Claim
from eom.checker.mean.parameters import FALSE, IDENTITY, RESTS, Link, expressions, links
from eom.checker.read.grammar import read_formula
from eom.checker.read.looks import seen
from eom.checker.read.paths import at, find, put
from eom.checker.read.places import Span
from eom.checker.read.syntax import Integral, Node
from eom.checker.read.trees import walk
from eom.checker.read.writing import latex
from eom.checker.repair.counterexample import base_of
from eom.checker.repair.lines import _statement
from eom.checker.repair.offers import Palette
from eom.checker.repair.palette import around, symbols
from eom.checker.repair.slips import Edit, edits
from eom.errors import InputError

TRIED_SCALARS = 240
"""Slips that are tried at most."""
SHOWN = 3
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
    if claim.parameters is None or understood.formula.reading is None:
        return None
    statement = _statement(understood, claim)
    found = links(claim)
    k = next((k for k, link in enumerate(found) if link.kind == FALSE), None)
    if statement is None or k is None:
        return Explanation()
    members = statement.members[k : k + 2]
    known = {r.symbol: r.value for r in claim.parameters.relations}
    left, right = (e.xreplace(known) for e in expressions(claim)[k : k + 2])
    letters = _letters(members)
    return Explanation(
        residual=_residual(left - right, letters),
        blamed=_blamed(found, members, k),
        corrections=tuple(islice(_scalar_repairs(understood, claim, members, k, letters), SHOWN)),
        counterexample=_example(members, left, right, letters),
    )


def _blamed(found: tuple[Link, ...], members: tuple[Node, ...], k: int) -> tuple[Span, ...]:
    """Return the side at fault: the right one, or the left one where the rest of the chain agrees."""
    last = all(link.kind in {IDENTITY, RESTS} for link in found[k + 1 :]) and len(found) > k + 1
    return (members[0 if last and k == 0 else 1].span,)


# -- repairs -----------------------------------------------------------------------------------------


def _scalar_repairs(
    understood: Understood,
    claim: Claim,
    members: tuple[Node, ...],
    k: int,
    letters: Mapping[str, str],
) -> Iterator[Correction]:
    """Yield the formula with one slip undone, so that the link is an identity; the likeliest first.

    Where no slip is known that does, the side that is no integral is given the value of the other.
    """
    tree = understood.formula.reading.tree  # type: ignore[union-attr]
    number = next(j for j, c in enumerate(understood.claims) if c is claim)
    paths = [find(tree, m) for m in members]
    have = Palette(symbols=(near := _near(understood, members)), factors=near[:8], near=())
    pairs = [
        (e.weight + (INSIDE if _integrates(m) else 0.0), e, p)
        for m, p in zip(members, paths, strict=True)
        for e in edits(m, have)
    ]
    done: set[tuple[Expr, ...]] = set()
    for _, edit, path in sorted(pairs, key=lambda f: f[0])[:TRIED_SCALARS]:
        if path is None:
            continue
        whole = put(tree, path, edit.tree)
        sides = _mended(understood, whole, number, k)
        if sides and sides not in done:
            done.add(sides)
            yield _correction(edit, whole, at(tree, path))
    if not done:
        yield from _valued(understood, claim, members, k, letters)


def _integrates(node: Node) -> bool:
    return any(isinstance(n, Integral) for n in walk(node))


def _valued(
    understood: Understood,
    claim: Claim,
    members: tuple[Node, ...],
    k: int,
    letters: Mapping[str, str],
) -> Iterator[Correction]:
    """Yield the formula with one side replaced by the value of the other."""
    tree = understood.formula.reading.tree  # type: ignore[union-attr]
    number = next(j for j, c in enumerate(understood.claims) if c is claim)
    place = 0 if _integrates(members[1]) and not _integrates(members[0]) else 1
    path = find(tree, members[place])
    value = sp.factor_terms(sp.expand(expressions(claim)[k + 1 - place]))
    with suppress(InputError):
        new = read_formula(_named(value, letters)).tree
        whole = put(tree, path, new) if path is not None else tree
        if _mended(understood, whole, number, k):
            change = f"another value: ${latex(members[place])}$ should be ${latex(new)}$"
            yield Correction(latex(whole), change, "value", members[place].span, latex(new))


def _mended(understood: Understood, tree: Node, number: int, k: int) -> tuple[Expr, ...]:
    """Return both sides of a link that is an identity in another tree; none where it is not."""
    with suppress(InputError):
        claims = reread(understood, tree)
        claim = claims[number] if len(claims) == len(understood.claims) else None
        if claim is None or claim.parameters is None:
            return ()
        found = links(claim)
        nodes = _statement(replace(understood, claims=claims), claim)
        alike = nodes is None or any(a == b for a, b in pairwise(nodes.members))
        good = len(found) > k and found[k].kind in {IDENTITY, RESTS}
        if good and not alike and FALSE not in {f.kind for f in found}:
            return tuple(sp.expand(e) for e in expressions(claim)[k : k + 2])
    return ()


def _correction(edit: Edit, tree: Node, old: Node) -> Correction:
    change = f"{edit.slip.words}: ${latex(edit.old)}$ should be ${latex(edit.new)}$"
    return Correction(latex(tree), change, edit.slip.name, old.span, latex(edit.tree))


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
