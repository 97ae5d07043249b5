"""What may stand for a term of a line, with its value."""

from __future__ import annotations

from dataclasses import dataclass, replace

from eom.checker.mean.values import Value
from eom.checker.read.paths import NOTHING, Path
from eom.checker.read.syntax import Node
from eom.checker.repair.cells import Suspects
from eom.checker.repair.lines import Addend, Line, Signature, signature, worth
from eom.checker.repair.palette import Palette
from eom.checker.repair.slips import DROPPED, TERM, Edit, Slip, edits
from eom.terms.terms import Term

SUBJECT = 0.15
"""What it weighs more to turn the sign of what a line is about: the slip is rather on the other side."""


@dataclass(frozen=True)
class Option:
    """What may stand for a term: another node, the other sign, or nothing; with its value.

    ``old``, ``new``: what changes within the term, at ``paths``; ``added``: what is added to cells
    of a table, by their places, with signs.
    """

    addend: Addend
    slip: Slip
    weight: float
    old: Node
    new: Node
    node: Node
    sign: int
    term: Term | None = None
    signature: Signature | None = None
    paths: tuple[Path, ...] = ((),)
    added: tuple[tuple[tuple[int, int], str], ...] = ()


def options(
    line: Line, addend: Addend, palette: Palette, suspects: Suspects | None = None
) -> list[Option]:
    """Return what may stand for a term and has a value, the most plausible first.

    ``suspects``: the cells of its table that may be at fault, where that is known.
    """
    found = []
    value = worth(line, addend.node)
    member = next(m for m in line.members if m.number == addend.member)
    if value is not None:
        own = (value.term, signature(value))
        turned = _option(addend, TERM, addend.node, addend.node, -addend.sign, *own)
        alone = len(member.addends) == 1 and member is line.members[0]
        found.append(replace(turned, weight=turned.weight + (SUBJECT if alone else 0.0)))
    if len(member.addends) > 1:
        found.append(_option(addend, DROPPED, addend.node, NOTHING, addend.sign, None, None))
    spared = suspects.spares if suspects is not None else _nowhere
    for edit in edits(addend.node, palette, spared):
        new = worth(line, edit.tree)
        if new is not None and not (value is not None and new.term == value.term):
            found.append(_edited(addend, edit, new))
    return sorted(found, key=lambda o: o.weight)


def _nowhere(_: Path) -> bool:
    return False


def _option(
    addend: Addend,
    slip: Slip,
    old: Node,
    new: Node,
    sign: int,
    term: Term | None,
    kind: Signature | None,
) -> Option:
    return Option(addend, slip, slip.weight, old, new, new, sign, term, kind)


def _edited(addend: Addend, edit: Edit, value: Value) -> Option:
    return Option(
        addend,
        edit.slip,
        edit.weight,
        edit.old,
        edit.new,
        edit.tree,
        addend.sign,
        value.term,
        signature(value),
        edit.paths,
    )
