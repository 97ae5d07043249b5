"""Why a comparison is wrong: the sign turned, or a slip in one of its sides; where the opposite holds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import islice

from eom.checker.explanation import Correction, Explanation
from eom.checker.judge.inequalities import ORDERS, difference
from eom.checker.judge.judge import HOLDS, WRONG, judge
from eom.checker.judge.notes import Understood, reread
from eom.checker.mean.claims import Claim
from eom.checker.mean.values import Value
from eom.checker.read.paths import Path, at, put
from eom.checker.read.syntax import Addition, Group, Node, Number, Relation
from eom.checker.read.writing import latex
from eom.checker.repair.candidates import Workshop
from eom.checker.repair.counterexample import failing
from eom.checker.repair.lines import Addend, Line, line, worth
from eom.checker.repair.lost import Pools
from eom.checker.repair.palette import palette
from eom.checker.repair.slips import edits
from eom.errors import InputError
from eom.fields import Singular
from eom.worlds.evaluate import Evaluator
from eom.worlds.special import telling

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


def _repairs(
    understood: Understood, wrong: Line, k: int, given: tuple[str, ...]
) -> Iterator[Correction]:
    number = wrong.number
    for tried in (*_turned(wrong, k), *islice(_slips(understood, wrong, k), TRIED)):
        claims = reread(understood, tried.tree)
        if len(claims) != len(understood.claims) or claims[number].verdict:
            continue
        link = _alone(claims[number], k)
        if _empty(link) or not _may_hold(link) or judge(link, given).verdict != HOLDS:
            continue
        text = latex(tried.tree)
        yield Correction(text, tried.change, tried.slip, tried.place.span, tried.new)


def _may_hold(link: Claim) -> bool:
    """Tell whether a comparison holds in one special motion, so that more worlds are worth their time."""
    special = next(telling(frozenset()))
    try:
        term, _ = difference(link)
        return bool(Evaluator(special.world, link.scalars).lowest(term) >= 0)
    except (InputError, Singular):
        return True


def _empty(claim: Claim) -> bool:
    """Tell whether a claim compares two things that are the same."""
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


def _slips(understood: Understood, wrong: Line, k: int) -> Iterator[_Tried]:
    """Yield the line with one slip undone in a side of a link, the likeliest first."""
    have = palette(understood, wrong)
    found = []
    for member in wrong.members[k : k + 2]:
        if member.path is not None:
            found += [(e, member.path) for e in edits(at(wrong.tree, member.path), have)]
    for edit, path in sorted(found, key=lambda f: f[0].weight):
        tree = put(wrong.tree, path, edit.tree)
        change = f"{edit.slip.words}: ${latex(edit.old)}$ should be ${latex(edit.new)}$"
        yield _Tried(tree, change, edit.slip.name, at(wrong.tree, path), latex(edit.tree))
