r"""Frames, places, bodies and laws of motion of a note's own, as a lexicon declares them.

``[turned]``: frames, each from another about one of its axes through an angle; ``[placed]``: points by
vectors from the inertial origin; ``[bodies]``: their masses, frames and moments of inertia;
``[[determined]]``: laws, with the coordinates that they give. Formulas are LaTeX, in the letters of the
lexicon.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.elaborator import Elaborator
from eom.checker.mean.values import Refusal
from eom.checker.read.grammar import read_formula
from eom.checker.read.syntax import Relation
from eom.errors import InputError
from eom.terms import rules
from eom.terms.own import Law, Own, OwnBody, OwnFrame
from eom.terms.terms import SCALAR, VECTOR, Equation, Term, zero
from eom.worlds.own import Furnished

if TYPE_CHECKING:
    from eom.checker.mean.lexicon import Lexicon

Data = Mapping[str, Any]
TABLES: dict[str, frozenset[str]] = {
    "turned": frozenset({"from", "axis", "angle"}),
    "bodies": frozenset({"mass", "frame", "moments"}),
    "determined": frozenset({"law", "gives"}),
}
"""Tables whose entries are tables, with the keys of these."""
KEYS = ("turned", "placed", "bodies", "determined")
"""Tables of a lexicon that declare what moves."""


@dataclass(frozen=True)
class Moving:
    """What a note declares of its own; ``scalars``: its letters; ``drawn``: worlds with it, made once."""

    own: Own
    scalars: Mapping[Any, Term]
    drawn: Furnished = field(compare=False, repr=False)

    def spelt(self, equation: Equation, scalars: Mapping[Any, Term]) -> Equation:
        """Return an equation with own bodies spelt out and partial derivatives carried out."""
        carry = partial(_carried, self.own, {**scalars, **self.scalars})
        return Equation(carry(equation.left), carry(equation.right), equation.relation)

    def meanings(self, scalars: Mapping[Any, Term]) -> dict[Any, Term]:
        """Return what symbols stand for, spelt out in the same way."""
        whole = {**scalars, **self.scalars}
        return {s: _carried(self.own, whole, t) for s, t in whole.items()}

    def worlds_with(self, scalars: Mapping[Any, Term]) -> Furnished:
        """Return the same worlds, in which these symbols have their meanings, too."""
        return Furnished(self.own, self.meanings(scalars), self.drawn.known)


OPEN = "only equations between these are judged"
"""Why a relation of another kind between what moves stays open."""


def _carried(own: Own, scalars: Mapping[Any, Term], term: Term) -> Term:
    return rules.slopes(scalars, own)(rules.spelt_out(own)(term))


def checked(data: Data, where: str) -> Data:
    """Return what of a lexicon declares what moves, in shape. Raises `InputError` for all else."""
    found = {key: data[key] for key in KEYS if key in data}
    for key, rows in found.items():
        kind, shown = (list, "[[determined]]") if key == "determined" else (Mapping, f"[{key}]")
        if not isinstance(rows, kind):
            raise InputError("not a table", where=f"{where}{key}", got=rows, expected=shown)
        named = rows.items() if isinstance(rows, Mapping) else enumerate(rows)
        for name, row in named:
            _check(key, row, f"{where}{key} > {name}")
    return found


def _check(key: str, row: Any, where: str) -> None:
    if key == "placed":
        if not isinstance(row, str):
            raise InputError("not a formula", where=where, got=row, expected="a vector in LaTeX")
        return
    if not isinstance(row, Mapping) or not set(row) <= TABLES[key]:
        raise InputError(
            "not such a table", where=where, got=row, expected=", ".join(sorted(TABLES[key]))
        )


def moving(lexicon: Lexicon) -> Moving:
    """Return what a lexicon declares. Raises `InputError` for formulas that have no meaning in it."""
    e, own, declared = elaborator(lexicon), Own(), lexicon.moving_data
    for name, row in declared.get("turned", {}).items():
        angle = e.expression(_value(e, str(row.get("angle", "")), SCALAR))
        axis = row.get("axis", 3)
        if axis not in (1, 2, 3):
            raise InputError("a frame turns about an axis 1, 2 or 3", where=name, got=axis)
        own.frames[name] = OwnFrame(str(row.get("from", "I")), axis, angle)
    for name, latex in declared.get("placed", {}).items():
        own.points[name] = _value(e, latex, VECTOR)
    for name, row in declared.get("bodies", {}).items():
        moments = tuple(_value(e, str(J), SCALAR) for J in row.get("moments", []))
        mass, frame = _value(e, str(row.get("mass", "0")), SCALAR), str(row.get("frame", ""))
        own.bodies[name] = OwnBody(name, mass, frame, moments)
    for row in declared.get("determined", []):
        own.laws.append(_law(e, own, str(row.get("law", "")), row.get("gives", [])))
    scalars = {s: _carried(own, e.scalars, t) for s, t in e.scalars.items()}
    return Moving(own, scalars, Furnished(own, scalars))


def _value(e: Elaborator, latex: str, kind: str) -> Term:
    try:
        found = e.value(read_formula(latex).tree).term
    except Refusal as refusal:
        raise InputError(refusal.finding.what, where=latex, got=refusal.finding.got) from None
    if found.kind != kind:
        raise InputError(f"this is no {kind}", where=latex, got=found.kind)
    return found


def _law(e: Elaborator, own: Own, latex: str, gives: Iterable[str]) -> Law:
    """Return a law with the symbols of the coordinates that it gives."""
    tree = read_formula(latex).tree
    if not isinstance(tree, Relation) or len(tree.members) != 2:
        raise InputError("a law is an equation", where=latex)
    try:
        left, right = (e.value(m).term for m in tree.members)
    except Refusal as refusal:
        raise InputError(refusal.finding.what, where=latex, got=refusal.finding.got) from None
    symbols = {t.data[1]: s for s, t in e.scalars.items() if t.data[:1] == ("coordinate",)}
    unknown = [name for name in gives if name not in symbols]
    if unknown:
        raise InputError("no coordinate in this law", where=latex, got=", ".join(unknown))
    left, right = (zero(b.kind) if a.is_zero else a for a, b in ((left, right), (right, left)))
    if left.kind != right.kind:
        raise InputError("the two sides are of different kinds", where=latex)
    carry = partial(_carried, own, e.scalars)
    return Law(Equation(carry(left), carry(right)), tuple(symbols[name] for name in gives))
