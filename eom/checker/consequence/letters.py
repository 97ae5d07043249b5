r"""Formulas as equations between letters that may be anything: constants, and functions of time.

A letter that words name as a mass, a length or the like is a constant, all others are functions of time.
A function and its derivatives are symbols of their own, `jet`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import sympy as sp

from eom.checker.consequence.arrays import (
    UNIT,
    Array,
    Components,
    added,
    cells,
    column,
    each,
    size,
    skew,
    times,
)
from eom.checker.consequence.dress import AXES, Arrays, Dress, dress_of, kept
from eom.checker.consequence.jets import (
    AXIS,
    CHANGES,
    MAY,
    STAYS,
    TIME,
    Equal,
    Expr,
    Letter,
    jet,
    letter,
    partial,
    rate,
)
from eom.checker.consequence.whole import FACTOR, Whole
from eom.checker.infer.sayings import Prose, said
from eom.checker.mean.claims import CONSTANT, EQUALITIES, Claim, claims
from eom.checker.mean.lexicon import Entry, Lexicon, Meaning
from eom.checker.mean.model import model_of
from eom.checker.read.statements import Formula, Statement
from eom.checker.read.symbol_shape import Look, Seen, seen
from eom.checker.read.syntax import Derivative, Group, Marks, Node, Number, Product, children, walk
from eom.checker.read.writing import latex_of
from eom.errors import InputError
from eom.system import System
from eom.terms.terms import Term
from eom.terms.vocabulary import described

NEAR = "approx"
MOVING, STILL = "coordinate", "scalar"
PLAIN = frozenset({"", "cal", "calligraphic", "roman", "script"})
"""Styles of letters for scalars."""
IMAGINARY = Look("i")


@dataclass(frozen=True)
class Read:
    """Equations of a formula, and whether they are all that it says."""

    equations: tuple[Equal, ...]
    whole: bool


@dataclass(frozen=True)
class Letters:
    """The letters of a note, which of them are constants, a lexicon in which they are anything, LaTeX."""

    lexicon: Lexicon
    still: frozenset[str]
    quiet: frozenset[str]
    spellings: Mapping[str, str]
    arrays: Arrays = field(default_factory=Arrays)

    def latex(self, e: Expr) -> str:
        """Return an expression as LaTeX in the letters of the note."""
        known = {s: letter(s) for s in e.free_symbols}
        names = {s: self._spelt(k) for s, k in known.items() if k is not None}
        return str(sp.latex(e, symbol_names=names))

    def _spelt(self, one: Letter) -> str:
        plain = self.spellings.get(one.name, one.name)
        return rf"\{'d' * one.order}ot{{{plain}}}" if one.order else plain

    def is_entry(self, name: str) -> bool:
        """Return whether a letter is an entry of a column or matrix of any size."""
        return self.arrays.has_entry(name)

    def _kind(self, name: str) -> str:
        return STAYS if name in self.still else MAY if name in self.quiet else CHANGES

    def read(self, formula: Formula) -> Read:
        """Return what a formula says is equal, and whether that is all it says."""
        if formula.reading is None:
            return Read((), whole=False)
        parts = [self._said(s) for s in formula.statements if s.relational]
        return Read(tuple(q for p in parts for q in p.equations), whole=all(p.whole for p in parts))

    def _said(self, statement: Statement) -> Read:
        if any(when != Look("t") for m in statement.members for _, when in _calls(m)):
            return Read((), whole=False)
        parts = [self._pairs(c, Whole(self, statement, k)) for k, c in self._claims(statement)]
        whole = all(p.whole for p in parts) and len(parts) > 0 and not statement.conditions
        return Read(tuple(q for p in parts for q in p.equations), whole=whole)

    def _claims(self, statement: Statement) -> list[tuple[int, Claim]]:
        """Return what a statement claims, with its number; signs of definition are those of equality."""
        signs = tuple(replace(g, name="=") if g.name in EQUALITIES else g for g in statement.signs)
        if self.arrays.entries:
            statement = replace(statement, signs=signs)
        try:
            return list(enumerate(claims(statement, self.lexicon)))
        except InputError:
            return []

    def _pairs(self, claim: Claim, whole: Whole) -> Read:
        if claim.findings or claim.role:
            return Read((), whole=False)
        try:
            members = self.members(claim)
        except (InputError, RecursionError, ValueError):
            return Read((), whole=False)
        vectors = whole if self.arrays.entries and self.arrays.stand_in(whole.statement) else None
        if claim.kind == CONSTANT:
            zeros = tuple(Equal(c, sp.S.Zero, whole=vectors) for c in cells(members[0]))
            return Read(zeros, whole=True)
        links = list(zip(claim.relations, pairwise(members), strict=False))
        found = tuple(
            Equal(x, y, relation == NEAR, vectors and replace(vectors, link=k, cell=c))
            for k, (relation, (a, b)) in enumerate(links)
            if relation in EQUALITIES or relation == NEAR
            for c, (x, y) in enumerate(zip(cells(a), cells(b), strict=True))
            if x != 0 or y != 0
        )
        equal = [r for r in claim.relations if r in EQUALITIES or r == NEAR]
        return Read(found, whole=len(equal) == len(members) - 1 > 0 and not claim.numbers)

    def expression(self, term: Term, scalars: Mapping[Any, Term]) -> Expr:
        """Return a term in letters. Raises `InputError` for what is no scalar."""
        if term.head == "expr":
            free = term.data[0].free_symbols
            own = {s: self.expression(scalars[s], scalars) for s in free if s in scalars}
            if any(p.exp.free_symbols & free for p in term.data[0].atoms(sp.Pow)):
                raise InputError("a letter as an exponent, such as that of a transpose")
            return term.data[0].xreplace(
                own | {s: TIME for s in free - own.keys() if s.name == "t"}
            )
        if term.head == "atom" and term.data[0] in {MOVING, STILL}:
            name = str(term.data[1])
            return sp.I if name == IMAGINARY.text else jet(name, 0, self._kind(name))
        if term.head == "since" and term.args[0].data == (sp.S.One,):
            return TIME
        found = self._components(scalars).of(term)
        if size(found) != (1, 1):
            raise InputError("this is no scalar", got=described(term))
        return found[0][0]

    def reads(self, statement: Statement) -> bool:
        """Return whether all that a statement says can be read."""
        return self._said(statement).whole

    def members(self, claim: Claim) -> list[Array]:
        """Return the members of a claim by components. Raises `InputError` for what is none in letters."""
        found = [self._components(claim.scalars).of(m.term) for m in claim.members]
        if len({size(a) for a in found}) > 1:
            raise InputError("members of different sizes", got=[size(a) for a in found])
        return found

    def linked(self, statement: Statement, number: int, link: int) -> tuple[Equal, ...]:
        """Return the equations of a link of what a statement claims; none where it cannot be read."""
        found = dict(self._claims(statement)).get(number)
        whole = Whole(self, statement, number)
        equations = () if found is None else self._pairs(found, whole).equations
        return tuple(q for q in equations if q.whole is not None and q.whole.link == link)

    def _components(self, scalars: Mapping[Any, Term]) -> Components:
        return Components(
            lambda t: self.expression(t, scalars),
            self._array,
            rate,
            partial,
            self.arrays.frame,
            self.lexicon.notation.dot,
            column(jet(f"{AXIS} {k}") for k in AXES) if self.arrays.turning else None,
        )

    def _array(self, term: Term, frame: str) -> Array | None:
        """Return the components of a letter; ``frame``: of a derivative that is a letter of its own."""
        quantity, *labels = term.data
        if quantity == "unit" and not frame:
            return column(sp.Integer(k == labels[-1]) for k in AXES)
        if quantity in {"identity", "identity_matrix"}:
            return UNIT
        if quantity not in {"vector", "dyadic"}:
            return None
        name = f"{labels[0]}^{frame}" if frame else str(labels[0])
        kind = STAYS if name in self.arrays.still else CHANGES

        def one(label: str) -> Expr:
            return jet(f"{name} {label}", 0, kind)

        if name in self.arrays.triads and not frame:
            triad, axis = self.arrays.triads[name]
            turn = _rotation(*(jet(f"{triad} {k}") for k in AXES))
            return column(row[AXES.index(axis)] for row in turn)
        if name in self.arrays.units:
            return _direction(one("polar"), one("azimuth"))
        if name in self.arrays.turns:
            return _rotation(*map(one, AXES))
        if quantity == "vector":
            return column(map(one, AXES))
        pairs = [[(r, c) for c in AXES] for r in AXES]
        if name in self.arrays.symmetric:
            pairs = [[(min(p), max(p)) for p in row] for row in pairs]
        return tuple(tuple(one("".join(p)) for p in row) for row in pairs)


def _direction(polar: Expr, azimuth: Expr) -> Array:
    """Return a vector of unit length by two angles."""
    flat = sp.sin(polar)
    return column((flat * sp.cos(azimuth), flat * sp.sin(azimuth), sp.cos(polar)))


def _rotation(a: Expr, b: Expr, c: Expr) -> Array:
    """Return a rotation matrix by Rodrigues' parameters; source: Cayley (1846)."""
    skewed = skew(column((a, b, c)))
    square = times(skewed, skewed)
    whole = 1 + a**2 + b**2 + c**2
    return added(UNIT, each(lambda s, q: 2 * (s + q) / whole, skewed, square))


_CONSTANT = re.compile(
    r"\b(?:mass(?:es)?|radi(?:us|i)|lengths?|moments? of inertia|(?:principal )?moments?|distances?"
    r"|heights?|widths?|stiffness(?:es)?|constants?|coefficients?|gravity|slope|inclination|latitude|density"
    r"|thickness|sides?|ratio)\b",
    re.IGNORECASE,
)
"""Words for what does not change with time."""
NUMBERS = frozenset({Look("t"), Look("pi"), Look("infty")})
"""Letters that no note uses for anything else: the time, numbers."""
_EULER = Look("e")
USUAL = frozenset("g m M l ell R I J Theta k mu rho varrho".split())
"""Letters of which everybody means constants, where they have no dots."""


def letters_of(formulas: Sequence[Formula], text: Prose, lexicon: Lexicon) -> Letters:
    """Return the letters of formulas; ``lexicon``: of the note, for its notation and its marks.

    Those of which the words say that they are a mass, a length or the like are constants, all others may
    change with time.
    """
    members = [m for f in formulas for s in f.statements if s.relational for m in s.members]
    shown = [one for m in members for one in _looks(m)]
    dotted = {s.look for s in shown if s.dots} | {k for m in members for k in _below(m)}
    looks = dict.fromkeys(k for s in shown for k in (s.look, _primed(s)) if k is not None)
    numbers = NUMBERS | {s.look for s in shown if s.look == _EULER and s.raised}
    named = {m.look for s in said(text) if _CONSTANT.search(s.words) for m in s.of}
    usual = {k for k in looks if k.name in USUAL and not k.style and not k.accents}
    still = frozenset(name_of(k) for k in (named | usual | _fixed(looks)) - dotted)
    plain = [k for k in looks if k.style in PLAIN and k not in numbers and not _decorated(k)]
    nothing = model_of(System.from_rates("nothing", {sp.Symbol("nothing_", real=True): sp.S.Zero}))
    quiet = frozenset(name_of(k) for k in plain if k not in dotted and not k.called)
    spelt = {name_of(k): latex_of(k) for k in plain}

    def dressed(dress: Dress) -> Letters:
        arrays = dress.arrays
        layer = tuple(
            Entry(k, Meaning(STILL if name_of(k) in still else MOVING, (name_of(k),)), k.text)
            for k in plain
            if k not in arrays.looks
        )
        layer += (Entry(Look("t"), Meaning("time", ()), "t"),)
        own = replace(lexicon, layers=(layer,), scopes=(), system=nothing)
        found = Letters(own, still, quiet, spelt, arrays)
        return _with_arrays(found, lexicon) if arrays.entries else found

    return dressed(dress_of(formulas, text, lexicon).settled(lambda d: dressed(d).reads))


def _with_arrays(letters: Letters, lexicon: Lexicon) -> Letters:
    """Return letters that are read by components, in a notation in which columns stand beside vectors."""
    arrays, own = letters.arrays, letters.lexicon
    factor = Entry(FACTOR, Meaning(STILL, (FACTOR.text,)), FACTOR.text)
    notation = replace(own.notation, mixed=arrays.frame, resolved=False, bracketed=False)
    notation = replace(notation, dyads=False, quaternions="", spatial="")
    layers = ((*arrays.entries, *own.layers[0], factor), kept(lexicon))
    spelt = {
        f"{name} {axes}": rf"\left({written}\right)_{{{axes}}}"
        for name, written in arrays.spellings.items()
        for axes in (*AXES, *(r + c for r in AXES for c in AXES))
    }
    own = replace(own, layers=layers, notation=notation)
    still = letters.still | {FACTOR.text}
    return replace(letters, lexicon=own, still=still, spellings={**letters.spellings, **spelt})


def name_of(look: Look) -> str:
    r"""Return the name of a letter; ``\mathcal{L}`` and L are two."""
    return f"{look.style} {look.text}" if look.style else look.text


def _primed(one: Seen) -> Look | None:
    """Return the look of a letter with primes, which is another letter."""
    return one.with_label() if one.raised and isinstance(one.raised[0], Marks) else None


def _fixed(looks: Iterable[Look]) -> set[Look]:
    """Return letters of what is as it begins, v_0."""
    return {k for k in looks if k.sub == ("0",)}


def _decorated(look: Look) -> bool:
    """Return whether a letter has marks or labels that scalars have not."""
    return bool(look.accents or look.presub or look.presup)


def _looks(node: Node) -> Iterator[Seen]:
    found = None if isinstance(node, Number) else seen(node)
    if found is not None:
        yield found
        for above in found.raised:
            yield from _looks(above)
        return
    for inside in children(node):
        yield from _looks(inside)


def _below(node: Node) -> Iterator[Look]:
    """Yield the letters of which a derivative is written as a fraction, and functions of the time."""
    for inside in walk(node):
        given: list[Node | None] = []
        if isinstance(inside, Derivative):
            given = [inside.operand]
        yield from (found.look for n in given if n is not None and (found := seen(n)))
    yield from (found.look for n, _ in _calls(node) if (found := seen(n)))


def _calls(node: Node) -> Iterator[tuple[Node, Look]]:
    """Yield functions of the time, or what they are at an instant, and this."""
    for inside in walk(node):
        for a, b in pairwise(inside.factors) if isinstance(inside, Product) else ():
            found = seen(b.body) if isinstance(b, Group) and b.open == "(" else None
            if found is not None and found.look.name == "t" and not found.dots:
                yield a, found.look
