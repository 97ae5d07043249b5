"""Laws of the writer's own: lines that say what a free scalar means for the motion.

The torque of a controller, M = -k w, or the velocity of a disc that rolls, v = w x R b3, are true of one
motion and of no other; no mechanics says what k and R are before that line does. So the first line that
has such a scalar on some of its sides alone, and quantities of the motion on the others, is an assumption,
and what comes behind it with the same scalar is judged by what follows from it.

Slips that are put in: whether a wrong line is what becomes of a true one where another wrong line stands.

A wrong line says of one quantity that it is something else. Where that stands in a later line it is put in
place of the quantity, or the quantity in place of it; what the slip leaves over is looked for in what the
later line leaves over, whole, as a rate or multiplied by one quantity, when what stands between the lines
was not written down.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice, product
from typing import Any

import sympy as sp

from eom.checker.judge.consequences import follows
from eom.checker.judge.coordinates import addends
from eom.checker.judge.judge import HOLDS, Judgement, judge
from eom.checker.judge.models import ENOUGH, equations, terms_of
from eom.checker.judge.worlds import CHANCE, InWorld, Worlds
from eom.checker.mean.claims import EQUALITIES, STATEMENT, Claim
from eom.checker.mean.values import atoms_in
from eom.fields import RESIDUES
from eom.terms.terms import (
    COLUMN,
    DYADIC,
    INERTIAL,
    SCALAR,
    VECTOR,
    Equation,
    Term,
    add,
    cross,
    der,
    dot,
    entries,
    expr,
    inner,
    mul,
    nodes,
    number,
    zero,
)
from eom.terms.terms import replace as rewritten
from eom.terms.vocabulary import unit

FREE = "scalar"
"""Quantity of the vocabulary that is free for the writer."""
STILL = frozenset({FREE, "angle", "turn_angle", "free_angle", "principal_angle"})
"""Quantities whose functions are known: a line between them alone says nothing of a motion."""
FACTORS = (sp.Integer(-1), sp.Integer(2), sp.Rational(1, 2))
"""What a term may have to be multiplied by where a line does not follow from a law."""


def own(claim: Claim) -> frozenset[str]:
    """Return the free scalars that stand on some sides of a claim alone, beside quantities of motion."""
    plain = claim.kind == STATEMENT and EQUALITIES.issuperset(claim.relations)
    if not plain or claim.parameters is not None or claim.findings or len(claim.members) < 2:
        return frozenset()
    sides = [atoms_in(m.term, claim.scalars) for m in claim.members]
    free = [_free(s) for s in sides]
    others = [a for s, f in zip(sides, free, strict=True) if not f for a in s]
    moving = any(a.data[0] not in STILL for a in others)
    return frozenset.union(*free) - frozenset.intersection(*free) if moving else frozenset()


def free_alone(claim: Claim) -> str:
    """Return the free scalar that is one side of an equation, and is not on the other, which moves."""
    if claim.kind != STATEMENT or len(claim.members) != 2 or claim.parameters is not None:
        return ""
    if claim.moving is not None:
        return ""
    left, right = (m.term for m in claim.members)
    for one, other in ((left, right), (right, left)):
        meaning = claim.scalars.get(one.data[0]) if one.head == "expr" else None
        known = meaning is not None and meaning.data[:1] == (FREE,)
        atoms = atoms_in(other, claim.scalars)
        moves = any(a.data[0] not in STILL for a in atoms) or _has_rate(other, claim)
        if known and moves and meaning not in atoms:
            return str(one.data[0])
    return ""


def _has_rate(term: Term, claim: Claim) -> bool:
    """Return whether a term, or what one of its symbols stands for, is differentiated."""
    symbols = {s for n in nodes(term) if n.head == "expr" for s in n.data[0].free_symbols}
    inside = (term, *(claim.scalars[s] for s in symbols if s in claim.scalars))
    return any(n.head == "der" for t in inside for n in nodes(t))


def firsts(found: Iterable[Sequence[Claim]]) -> Iterator[bool]:
    """Yield for the claims of each formula whether it is the first to tie a free scalar to the motion.

    A scalar that stands in a line before, but for lines between free scalars alone, is known already.
    """
    known: frozenset[str] = frozenset()
    for claims in found:
        said = [c for c in claims if c.parameters is None]
        yield any(own(c) - known for c in said if not c.role)
        known |= {n for c in said for m in c.members for n in _free(atoms_in(m.term, c.scalars))}


def refuted(claim: Claim, laws: Sequence[Claim], assumed: frozenset[str]) -> bool:
    """Return whether a claim is false where laws hold: with another factor of one term it follows.

    If both were true, the term would be zero; so it is made sure that this does not follow as well.
    """
    return any(
        follows(other, laws, assumed) and not follows(term, laws, assumed)
        for other, term in _varied(claim)
    )


def settled(claim: Claim, laws: Sequence[Claim], given: Iterable[str] = ()) -> Judgement | None:
    """Return the judgement on a claim in which what laws give is put in place of what they give it for.

    None where that is not everywhere possible: then nothing is known.
    """
    made = claim
    for law in laws:
        made = _put(made, law)
    if made is claim:
        return None
    given_for = frozenset().union(
        *(atoms_in(side, law.scalars) for law in laws for side in _solved(law)[:1])
    )
    left = frozenset().union(*(atoms_in(m.term, made.scalars) for m in made.members))
    return judge(made, given) if given_for and not given_for & left else None


def _solved(law: Claim) -> tuple[Term, ...]:
    """Return what a law is solved for, and what it gives for that; nothing where it is not solved."""
    if len(law.members) != 2:
        return ()
    left, right = (m.term for m in law.members)
    plain = left.head == "atom" or (left.head == "der" and left.args[0].head == "atom")
    return (
        (left, right)
        if plain and not atoms_in(left, law.scalars) & atoms_in(right, law.scalars)
        else ()
    )


def _put(claim: Claim, law: Claim) -> Claim:
    """Return a claim with what a law gives in place of what it is solved for."""
    solved = _solved(law)
    clash = any(claim.scalars.get(s, t) != t for s, t in law.scalars.items())
    if not solved or clash:
        return claim
    made = exchanged(claim, *solved)
    if made.members == claim.members and made.scalars == dict(claim.scalars):
        return claim
    return replace(made, scalars={**law.scalars, **made.scalars}, previous=None)


def exchanged(claim: Claim, old: Term, new: Term) -> Claim:
    """Return a claim with another term in place of one, wherever that stands."""

    def rule(node: Term) -> Term:
        return new if node == old else node

    members = tuple(replace(m, term=rewritten(m.term, rule)) for m in claim.members)
    scalars = {s: rewritten(t, rule) for s, t in claim.scalars.items()}
    return replace(claim, members=members, scalars=scalars)


def slipped(claim: Claim, given: Iterable[str] = ()) -> bool:
    """Return whether a claim is exactly true with another factor of one term: no approximation of it."""
    return any(_exact(judge(other, given)) for other in variants(claim))


def _exact(found: Judgement) -> bool:
    return found.verdict == HOLDS or any(not CHANCE.intersection(s) for s in found.sets)


def variants(claim: Claim) -> Iterator[Claim]:
    """Yield a claim of two sides with another factor of one term."""
    return (one for one, _ in _varied(claim))


def _varied(claim: Claim) -> Iterator[tuple[Claim, Claim]]:
    """Yield the same, and with each that the term is zero."""
    if len(claim.members) != 2:
        return
    left, right = (m.term for m in claim.members)
    terms = [*addends(left), *(-t for t in addends(right))]
    for k, term in enumerate(terms):
        others = [t for n, t in enumerate(terms) if n != k]
        for factor in FACTORS:
            yield _zero([*others, mul(number(factor), term)], claim), _zero([term], claim)


def _zero(terms: Sequence[Term], claim: Claim) -> Claim:
    """Return the claim that a sum is zero."""
    first = claim.members[0]
    both = (replace(first, term=add(*terms)), replace(first, term=zero(first.term.kind)))
    return replace(claim, members=both, relations=("=",), previous=None)


def _free(atoms: frozenset[Term]) -> frozenset[str]:
    """Return the names of the free scalars among quantities."""
    return frozenset(str(a.data[1]) for a in atoms if a.data[0] == FREE)


# -- slips that are put in ----------------------------------------------------------------------

Scalars = Mapping[Any, Term]
AXES = (1, 2, 3)
_QUANTITY = frozenset({"atom", "der", "column"})
"""Heads of what is a quantity or the rate of one."""
_SIGNS = frozenset(int(RESIDUES.of(s)) for s in (1, -1))
_HALVES = _SIGNS | {int(RESIDUES.of(s, 2)) for s in (1, -1)}
"""Constants of steps by hand: signs; of scalars that are products also the half of energies."""
MAX_PUT = 24
"""Ways to put something into a claim that are looked at at most."""
FITS, NEARLY, APART = 2, 1, 0
"""Whether a claim holds with what is put in: all of it, all but one term, or not."""


def put_in(claim: Claim, slip: Claim, others: Sequence[Claim], assumed: frozenset[str]) -> int:
    """Return whether an equation that is wrong in worlds holds with what a slip says put in.

    ``others``: slips one of which may have been put in as well; ``assumed``: a closed set.
    """
    once = list(islice(_exchanges(claim, slip), MAX_PUT))
    found = max(_fit(claim, assumed, slip), *(_fit(c, assumed) for c in once), APART)
    if found == FITS:
        return found
    both = ((c, o) for c in once for o in others)
    twice = (f for c, o in both for f in ((c, o), *((d, None) for d in _exchanges(c, o))))
    fits = any(_fit(c, assumed, o) == FITS for c, o in islice(twice, MAX_PUT))
    return FITS if fits else found


def _fit(claim: Claim, assumed: frozenset[str], slip: Claim | None = None) -> int:
    """Return whether a claim leaves nothing over; with a slip: what becomes of what that leaves over."""
    equation, *more = equations(claim)
    own = slip.scalars if slip is not None else {}
    if more or any(claim.scalars.get(s, t) != t for s, t in own.items()):
        return APART
    models = Worlds(claim, {**own, **claim.scalars})
    frame = _frame(models.terms, terms_of(slip) if slip is not None else ())
    left = _difference(equation, frame)
    images = [_NOTHING] if slip is None else list(_images_of(slip, claim, left.kind, frame))
    terms = (*addends(equation.left), *(-t for t in addends(equation.right)))
    added = [_geometric(t, frame) for t in terms]
    fitting: dict[tuple[int, _Image], int] = {}
    for n, drawn in enumerate(islice(models.draw(assumed), ENOUGH)):
        drawn.labels = frozenset().union(*map(drawn.evaluator.labels, (left, *added)))
        tries = list(_tries(drawn, left, added))
        pairs = list(fitting) if n else list(product(range(len(tries)), images))
        ratios = {p: _ratio(tries[p[0]], drawn, p[1]) for p in pairs}
        same = {p: r for p, r in ratios.items() if r in p[1].constants}
        fitting = {p: r for p, r in same.items() if not n or fitting[p] == r}
    return APART if not fitting else FITS if min(fitting, key=_place)[0] == 0 else NEARLY


def _place(pair: tuple[int, _Image]) -> int:
    return pair[0]


def _tries(drawn: InWorld, whole: Term, terms: Iterable[Term]) -> Iterator[int | None]:
    """Yield what is left over; then with another factor of each term."""
    value = drawn.number(whole)
    yield value
    for number_of in map(drawn.number, terms):
        for factor in FACTORS:
            times = RESIDUES.of(Fraction(factor.p, factor.q) - 1)
            known = value is not None and number_of is not None
            yield int(RESIDUES.reduce(value + times * number_of)) if known else None


def _ratio(value: int | None, drawn: InWorld, image: _Image) -> int | None:
    """Return by what an image is multiplied to be a value, None where there is no such number."""
    if value is None or image is _NOTHING:
        return value
    below = drawn.number(image.term)
    return int(RESIDUES.reduce(value * RESIDUES.inverse(below))) if below else None


# -- put in ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Given:
    """What a line says of a term: that it is another one; ``scalars``: what symbols in that stand for."""

    old: Term
    new: Term
    scalars: Scalars


def _exchanges(claim: Claim, slip: Claim) -> Iterator[Claim]:
    """Yield a claim with what another one says of a quantity put in its place, wherever it stands."""
    if any(claim.scalars.get(s, t) != t for s, t in slip.scalars.items()):
        return
    for given in (g for q in equations(slip) for g in _given_by(q, slip.scalars)):
        made = exchanged(claim, given.old, given.new)
        if made.members != claim.members or made.scalars != dict(claim.scalars):
            yield replace(made, scalars={**given.scalars, **made.scalars}, previous=None)


def _given_by(equation: Equation, scalars: Scalars) -> Iterator[_Given]:
    """Yield what an equation says of its quantities, and of a whole side."""
    left, right = equation.left, equation.right
    if left.kind == SCALAR:
        yield from _of_scalars(equation, scalars)
    else:
        terms = [*addends(left), *(-t for t in addends(right))]
        for k, term in enumerate(terms):
            factor, bare = _parted(term)
            alone = len(terms) == 2
            if bare.head in _QUANTITY or alone:
                others = [t for n, t in enumerate(terms) if n != k]
                yield _Given(bare, mul(number(-1) * expr(1 / factor), add(*others)), scalars)


def _parted(term: Term) -> tuple[Any, Term]:
    """Return the number that a term begins with, and the rest."""
    first = term.args[0] if term.head == "mul" else None
    if first is None or first.head != "expr" or not first.data[0].is_number:
        return sp.Integer(1), term
    return first.data[0], mul(*term.args[1:])


def _of_scalars(equation: Equation, scalars: Scalars) -> Iterator[_Given]:
    """Yield what an equation between scalars says of what it is linear in: of rates, else of any."""
    named: dict[Term, Any] = {}
    value = _expression(equation.left, named) - _expression(equation.right, named)
    places = {s: t for t, s in named.items()}
    letters = {s: scalars[s] for s in value.free_symbols if s in scalars}
    found = [s for s, t in places.items() if t.head == "der"] or [*places, *letters]
    for symbol in sorted(found, key=str):
        slope = sp.diff(value, symbol)
        if slope != 0 and symbol not in slope.free_symbols:
            solved = sp.cancel(symbol - value / slope)
            old = places.get(symbol) or scalars[symbol]
            if not slope.is_number or symbol in places or _alone(equation, symbol):
                yield _Given(old, expr(solved), {**scalars, **places})


def _alone(equation: Equation, symbol: Any) -> bool:
    """Return whether a letter is a side of an equation, up to a number."""
    sides = [t.data[0] for t in (equation.left, equation.right) if t.head == "expr"]
    return any(s.as_coeff_Mul()[1] == symbol for s in sides)


def _expression(term: Term, named: dict[Term, Any]) -> Any:
    """Return a scalar as an expression, with a letter for all that is none."""
    if term.head in {"add", "mul"}:
        parts = [_expression(a, named) for a in term.args]
        return (sp.Add if term.head == "add" else sp.Mul)(*parts)
    if term.head == "expr":
        return term.data[0]
    return named.setdefault(term, sp.Dummy(f"t{len(named)}"))


# -- what is left over ----------------------------------------------------------------------


def _images_of(slip: Claim, claim: Claim, kind: str, frame: str) -> Iterator[_Image]:
    """Yield what may become of what a slip leaves over, beside quantities of it and of a claim."""
    found = {a for c in (claim, slip) for t in terms_of(c) for a in atoms_in(t, c.scalars)}
    letters = {t for c in (claim, slip) for t in c.scalars.values()}
    factors = sorted(found | letters, key=str)
    for equation in equations(slip):
        yield from _images(_difference(equation, frame), kind, factors, frame)


@dataclass(frozen=True)
class _Image:
    term: Term
    constants: frozenset[int]


_NOTHING = _Image(number(0), frozenset({0}))


def _images(left: Term, kind: str, factors: Iterable[Term], frame: str) -> Iterator[_Image]:
    """Yield what may become of a difference of a kind; a vector is multiplied as a whole."""
    own = [f for f in factors if left.kind == SCALAR or f.head == "atom"]
    for now in (left, der(left)):
        made = [now, *(p for f in own for p in _products(f, now))]
        for k, image in enumerate(made):
            if image.kind == kind:
                yield _Image(image, _HALVES if k and kind == SCALAR else _SIGNS)
            elif image.kind == VECTOR and kind == SCALAR:
                yield from (_Image(dot(unit(frame, a), image), _SIGNS) for a in AXES)


def _products(factor: Term, term: Term) -> Iterator[Term]:
    if SCALAR in {factor.kind, term.kind}:
        yield mul(factor, term)
    elif factor.kind == term.kind == VECTOR:
        yield cross(factor, term)
        yield dot(factor, term)
    elif factor.kind == DYADIC and term.kind == VECTOR:
        yield dot(factor, term)


def _frame(*terms: Iterable[Term]) -> str:
    """Return the frame in which components stand."""
    found = (n for row in terms for t in row for n in nodes(t))
    framed = (n.data[-1] if n.head == "column" else n.data[1] for n in found if _is_framed(n))
    return next(framed, INERTIAL)


def _is_framed(node: Term) -> bool:
    return node.head == "column" or node.data[:1] == ("unit",)


def _difference(equation: Equation, frame: str) -> Term:
    """Return the left side less the right one; columns as vectors."""
    return _geometric(add(equation.left, -equation.right), frame)


def _geometric(term: Term, frame: str) -> Term:
    """Return the vector that a column has the components of; anything else as it is."""
    if term.kind != COLUMN:
        return term
    axes = (entries([[number(int(k == n))] for k in AXES]) for n in AXES)
    return add(*(mul(inner(a, term), unit(frame, n)) for a, n in zip(axes, AXES, strict=True)))
