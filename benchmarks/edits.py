"""``python -m benchmarks.edits``: every single edit of the true equations of judged notes, judged.

Each edit changes one node of a formula: a sign, a factor, a term or factor less, operands exchanged,
another index, a dot, a tilde or a transpose lost, another frame, sine for cosine. Whether an edit is
true is decided without the checker's worlds: by 60-digit numerics on smooth motions
(`tests.eom.oracle`), under the assumptions that the equation needed before the edit. An edit that is
false there may be true under others, which the checker then names; these are looked at in the same way,
and counted apart.

The command fails where a true edit is called wrong, or less than 98 % of the false ones are called wrong
or ill-formed. Of an edit that is caught, what was there before the edit should be among the first three
corrections, where there is a module that finds any.
"""

from __future__ import annotations

import random
import sys
from collections import Counter
from collections.abc import Callable, Container, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import click

from benchmarks.checking import GIVEN, SHOWN, lexicon_of, note, read_truth, same
from eom.checker.judge.judge import HOLDS, UNDER
from eom.checker.judge.models import equations
from eom.checker.judge.notes import Understood, reread, understand
from eom.checker.judge.verdicts import GRAVE, Verdict, verdict
from eom.checker.mean.claims import Claim, claims, defined
from eom.checker.mean.values import Value
from eom.checker.read.documents import load
from eom.checker.read.spans import Source, Span
from eom.checker.read.statements import Formula, read_piece, split
from eom.checker.read.symbol_shape import DOTS, Look
from eom.checker.read.syntax import (
    Accent,
    Addition,
    Call,
    Derivative,
    Fraction,
    Group,
    Marks,
    Node,
    Number,
    Product,
    Scripts,
    Symbol,
    transform,
    walk,
)
from eom.checker.read.writing import latex
from eom.checker.repair.explaining import corrected
from eom.errors import InputError
from tests.eom import oracle

OWN = Path("tests/eom/checker/unseen")
CAUGHT = {"wrong", "ill-formed"}
FRAMES = ("I", "A", "B", "N")

# -- edits ---------------------------------------------------------------------------------------


def _signs(node: Node) -> Iterator[Node]:
    if isinstance(node, Addition):
        for k, sign in enumerate(node.signs):
            if sign in {"+", "-", ""}:
                new = "" if sign == "-" and not k else "-" if sign != "-" else "+"
                yield replace(node, signs=(*node.signs[:k], new, *node.signs[k + 1 :]))


def _factors(node: Node) -> Iterator[Node]:
    if isinstance(node, Product) and not node.operator:
        yield replace(node, factors=(Number("2"), *node.factors))
    if isinstance(node, Fraction) and isinstance(node.below, Number):
        yield node.above
    if isinstance(node, Number) and node.text.isdigit() and node.text != "0":
        yield replace(node, text=str(2 * int(node.text)))


def _dropped(node: Node) -> Iterator[Node]:
    if isinstance(node, Addition) and len(node.terms) > 1:
        for k in range(len(node.terms)):
            signs = (*node.signs[:k], *node.signs[k + 1 :])
            terms = (*node.terms[:k], *node.terms[k + 1 :])
            if signs[0] == "+":
                signs = ("", *signs[1:])
            plain = len(terms) == 1 and not signs[0]
            yield terms[0] if plain else replace(node, terms=terms, signs=signs)
    if isinstance(node, Product):
        for k in range(len(node.factors)):
            rest = (*node.factors[:k], *node.factors[k + 1 :])
            yield rest[0] if len(rest) == 1 else replace(node, factors=rest)


def _exchanged(node: Node) -> Iterator[Node]:
    if isinstance(node, Product) and len(node.factors) == 2:
        yield replace(node, factors=node.factors[::-1])


def _dots(node: Node) -> Iterator[Node]:
    if isinstance(node, Accent) and node.mark in DOTS:
        names = list(DOTS)
        k = names.index(node.mark)
        yield replace(node, mark=names[k - 1]) if k else node.base
    if isinstance(node, Derivative) and node.operand is not None:
        yield node.operand


def _marks(node: Node) -> Iterator[Node]:
    if isinstance(node, Accent) and node.mark in {"tilde", "hat"}:
        yield node.base
    if isinstance(node, Scripts) and isinstance(node.sup, Marks):
        yield replace(node, sup=None)
        for mark in ("bullet", "circ"):
            if node.sup.names[0] in {"bullet", "circ"} and mark not in node.sup.names:
                yield replace(node, sup=Marks((mark,) * len(node.sup.names)))


def _transposed(node: Node) -> Iterator[Node]:
    if isinstance(node, Scripts) and isinstance(node.sup, Symbol) and node.sup.name in {"T", "top"}:
        yield replace(node, sup=None)


def _frames(node: Node) -> Iterator[Node]:
    if isinstance(node, Derivative) and isinstance(node.frame, Symbol):
        for name in FRAMES:
            if name != node.frame.name:
                yield replace(node, frame=replace(node.frame, name=name))


def _functions(node: Node) -> Iterator[Node]:
    if isinstance(node, Call) and node.function in {"sin", "cos"}:
        yield replace(node, function="cos" if node.function == "sin" else "sin")


def _indices(node: Node) -> Iterator[Node]:
    sub = node.sub if isinstance(node, Scripts) else None
    inside = sub.body if isinstance(sub, Group) else sub
    if isinstance(inside, Number) and set(inside.text) <= set("123"):
        for k, digit in enumerate(inside.text):
            for new in "123".replace(digit, ""):
                text = inside.text[:k] + new + inside.text[k + 1 :]
                yield replace(node, sub=replace(inside, text=text))
        if len(set(inside.text)) == 2:
            yield replace(node, sub=replace(inside, text=inside.text[::-1]))
    if isinstance(inside, Product) and len(inside.factors) == 2:
        yield replace(node, sub=replace(inside, factors=inside.factors[::-1]))


EDITS: dict[str, Callable[[Node], Iterator[Node]]] = {
    "sign": _signs,
    "factor": _factors,
    "dropped": _dropped,
    "exchanged": _exchanged,
    "dot": _dots,
    "mark": _marks,
    "transpose": _transposed,
    "frame": _frames,
    "function": _functions,
    "index": _indices,
}
"""Kind of edit, and what may stand in the place of a node."""


def edits(tree: Node) -> Iterator[tuple[str, Node]]:
    """Yield every tree that is one edit away, each once, with the kind of the edit."""
    seen = {tree}
    inside = set(_labels(tree))
    for node in (n for n in walk(tree) if id(n) not in inside):
        for kind, rule in EDITS.items():
            for new in rule(node):
                put = replace(new, span=node.span)
                whole = _put(tree, node, put)
                if whole not in seen:
                    seen.add(whole)
                    yield kind, whole


def _labels(tree: Node) -> Iterator[int]:
    """Yield the identities of nodes in scripts, which are names; an edit of an index is one of its base."""
    for node in walk(tree):
        if isinstance(node, Scripts):
            for script in (node.sub, node.sup, node.presub, node.presup):
                yield from (id(n) for n in walk(script)) if script is not None else ()


def _put(tree: Node, place: Node, new: Node) -> Node:
    return transform(tree, lambda n: new if n is place else n)


# -- formulas with what they refer to --------------------------------------------------------------


@dataclass(frozen=True)
class Original:
    """A true formula: as it was understood, its verdict, and what the note says before it."""

    name: str
    understood: Understood
    judged: Verdict
    definitions: Mapping[Look, Value]
    before: tuple[Understood, ...]

    @property
    def tree(self) -> Node:
        """The tree of the formula."""
        assert self.understood.formula.reading is not None
        return self.understood.formula.reading.tree

    @cached_property
    def confirmed(self) -> bool:
        """Whether the formula is true by the oracle, which else lacks an assumption and knows no edit."""
        try:
            return is_true(self.understood.claims, self)
        except (oracle.Undefined, InputError, KeyError, ArithmeticError, AttributeError):
            return False

    def edited(self, tree: Node) -> Understood:
        """Return the formula with another tree, at the same place of the note."""
        formula = self.understood.formula
        assert formula.reading is not None
        reading = replace(formula.reading, tree=tree)
        above = self.before[-1] if self.before else None
        previous = above.formula.statements if above else ()
        statements = split(tree, previous, [text for text, _ in reading.tags])
        known, found = dict(self.definitions), list[Claim]()
        for one in statements:
            new = claims(
                one, self.understood.lexicon, known, (*(above.claims if above else ()), *found)
            )
            known |= defined(new)
            found += new
        edited = Formula(formula.piece, reading, statements)
        return replace(self.understood, formula=edited, claims=tuple(found))


def originals(
    folder: Path, lexica: Path | None = None, only: Container[str] = ()
) -> Iterator[Original]:
    """Yield the displays of judged notes, all or ``only`` some, that are true and judged so."""
    truth = read_truth(folder / "truth.json")
    names = sorted({key.split(":")[0] for key in truth})
    for name in (n for n in names if not only or n in only):
        path = note(folder, name)
        yield from _of_note(name, understand(load(path), lexicon_of(path, lexica)), truth)


def _of_note(
    name: str, found: tuple[Understood, ...], truth: Mapping[str, Any]
) -> Iterator[Original]:
    definitions: dict[Look, Value] = {}
    above: tuple[Understood, ...] = ()
    number = 0
    for one in found:
        if one.formula.piece.kind == "display":
            number += 1
            key = f"{name}:E{number}"
            true = key in truth and truth[key].verdict in {"holds", "holds_under"}
            judged = verdict(one, GIVEN) if true and not one.repairs else None
            if judged is not None and judged.verdict in {HOLDS, UNDER}:
                yield Original(key, one, judged, dict(definitions), above)
            above = (one,)
        definitions |= defined(one.claims)


# -- truth ---------------------------------------------------------------------------------------


def is_true(found: tuple[Claim, ...], original: Original) -> bool:
    """Return whether claims are true by the oracle, under what the original ones needed.

    Raises `oracle.Undefined` and `InputError` where it cannot tell.
    """
    first = original.judged.claims
    if len(found) != len(first):
        raise InputError("another number of claims")
    pairs = zip(found, first, strict=True)
    return all(_true_under(c, _needed(j.judgement)) for c, j in pairs)


def _needed(judgement: Any, number: int = 0) -> tuple[str, ...]:
    own = judgement.sets[number] if judgement.sets else ()
    return tuple(sorted({*GIVEN, *judgement.context, *own}))


def _true_under(claim: Claim, names: tuple[str, ...]) -> bool:
    return all(oracle.is_true(q, names, claim.scalars) for q in equations(claim))


def outcome(original: Original, tree: Node) -> tuple[str, Verdict | None, Understood]:
    """Return what became of an edit, in words: what is true, and what the checker says."""
    edited = original.edited(tree)
    ours = verdict(edited, GIVEN)
    whole = not any(c.findings or not c.members for c in edited.claims) and edited.claims
    if not whole or not original.confirmed:
        return f"without a value, {ours.verdict}", ours, edited
    try:
        if is_true(edited.claims, original):
            return f"true, {ours.verdict}", ours, edited
        if ours.verdict == UNDER and _true_elsewhere(ours):
            return "true under others", ours, edited
    except (oracle.Undefined, InputError, KeyError, ArithmeticError, AttributeError):
        return f"without a value, {ours.verdict}", ours, edited
    return f"false, {ours.verdict}", ours, edited


def _true_elsewhere(ours: Verdict) -> bool:
    """Return whether the oracle agrees with every set that the checker names."""
    return all(
        _true_under(j.claim, _needed(j.judgement, k))
        for j in ours.claims
        for k in range(max(len(j.judgement.sets), 1))
    )


# -- corrections ---------------------------------------------------------------------------------


def undone(original: Original, tree: Node) -> bool:
    """Return whether the formula before the edit is among the first corrections, or one equal to it.

    The edit is written out and read again, so that its places are those of its own text.
    """
    text = latex(tree)
    piece = original.understood.formula.piece
    piece = replace(piece, source=Source(text), span=Span(0, len(text)), body=text, macros={})
    formula = read_piece(piece, original.understood.around.previous)
    if formula.reading is None:
        return False
    claims = reread(original.understood, formula.reading.tree)
    edited = replace(original.understood, formula=formula, claims=claims, repairs=())
    judged = next((j for j in verdict(edited, GIVEN).claims if j.verdict in GRAVE), None)
    if judged is None:
        return False
    wanted = latex(original.tree)
    return any(same(edited, c.latex, wanted) for c in corrected(edited, judged, GIVEN)[:SHOWN])


# -- counting ------------------------------------------------------------------------------------


@dataclass
class Count:
    """Outcomes by kind of edit, what was judged wrongly, corrections that were looked for and found."""

    by_kind: dict[str, Counter[str]] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)
    tried: Counter[str] = field(default_factory=Counter)
    undone: Counter[str] = field(default_factory=Counter)
    missing: list[str] = field(default_factory=list)

    def add(self, kind: str, original: Original, tree: Node, corrected: bool = False) -> None:
        """Judge an edit and count it; ``corrected``: look for its correction, too."""
        found, ours, _ = outcome(original, tree)
        self.by_kind.setdefault(kind, Counter())[found] += 1
        if found in FAULTS:
            self.faults.append(f"{found}: {original.name}, {kind}: {latex(tree)[:200]}")
        grave = ours is not None and ours.verdict in CAUGHT and not found.startswith("true")
        if corrected and grave:
            self.tried[kind] += 1
            right = undone(original, tree)
            self.undone[kind] += right
            if not right:
                self.missing.append(f"{found}: {original.name}, {kind}: {latex(tree)[:300]}")
                click.echo(self.missing[-1], err=True)

    @property
    def total(self) -> Counter[str]:
        """Outcomes of all kinds."""
        return sum(self.by_kind.values(), Counter())

    def these(self, *begins: str) -> int:
        """Return how many outcomes begin with one of some words."""
        return sum(n for found, n in self.total.items() if found.startswith(begins))

    @property
    def false(self) -> int:
        """How many edits are false."""
        return self.these("false")

    @property
    def caught(self) -> int:
        """How many false edits are called wrong or ill-formed."""
        return self.these("false, wrong", "false, ill-formed")

    @property
    def alarms(self) -> int:
        """How many true edits are called wrong or ill-formed."""
        return self.these("true, wrong", "true, ill-formed")

    @property
    def words(self) -> str:
        """The counts so far in a line."""
        caught = f"{self.alarms} true ones called wrong, {self.caught} of {self.false} false caught"
        return f"{caught}, {self.undone.total()} of {self.tried.total()} undone"

    @property
    def missed(self) -> bool:
        """Whether the demands are missed."""
        return bool(self.alarms) or 100 * self.caught < 98 * self.false


FAULTS = {
    *("true, wrong", "true, ill-formed"),
    *("false, holds", "false, holds under", "false, definition", "false, undecided"),
}


def report(count: Count) -> Iterator[str]:
    """Yield the lines of the report."""
    total = count.total
    yield f"{total.total()} edits of true equations"
    for kind, found in count.by_kind.items():
        words = ", ".join(f"{n} {text}" for text, n in sorted(found.items()))
        yield f"  {kind}: {words}"
    yield f"true edits called wrong or ill-formed: {count.alarms} of {count.these('true, ')}"
    yield f"false edits called wrong or ill-formed: {count.caught} of {count.false}"
    for kind, tried in count.tried.items():
        yield f"  {kind}: undone by one of {SHOWN} corrections: {count.undone[kind]} of {tried}"
    if count.tried:
        all_ = count.tried.total()
        yield f"the line before the edit among {SHOWN} corrections: {count.undone.total()} of {all_}"
    yield from count.faults
    yield from (f"not undone: {text}" for text in count.missing)


def run(found: list[Original], most: int | None, seed: int, corrected: bool = False) -> Count:
    """Judge edits of some originals; with ``most`` so many of them, at random."""
    all_ = [(o, kind, tree) for o in found for kind, tree in edits(o.tree)]
    if most is not None and most < len(all_):
        all_ = random.Random(seed).sample(all_, most)
    count = Count()
    for k, (original, kind, tree) in enumerate(all_, 1):
        count.add(kind, original, tree, corrected)
        if k % 50 == 0:
            click.echo(f"{k} of {len(all_)}: {count.words}", err=True)
    return count


@click.command()
@click.argument("folders", nargs=-1, type=click.Path(path_type=Path, exists=True))
@click.option("--lexica", type=click.Path(path_type=Path, exists=True), help="Of the first folder.")
@click.option("--note", "only", multiple=True, help="Name of a note; all by default.")
@click.option("--most", type=int, help="Judge at most so many edits, at random.")
@click.option("--seed", default=0, show_default=True)
@click.option("--corrections", is_flag=True, help="Look for corrections, too.")
def main(
    folders: tuple[Path, ...],
    lexica: Path | None,
    only: tuple[str, ...],
    most: int | None,
    seed: int,
    corrections: bool,
) -> None:
    """Judge edits of the true equations of FOLDERS, by default of our own notes."""
    found = list[Original]()
    for folder in folders or (OWN,):
        found += originals(folder, lexica if folder in folders[:1] else None, only)
    count = run(found, most, seed, corrections)
    for line in report(count):
        click.echo(line)
    sys.exit(count.missed)


if __name__ == "__main__":
    main()
