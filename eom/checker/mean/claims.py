r"""From statements to claims: chains of typed values with their relations.

Every statement gives a claim; what of it cannot be elaborated, or does not fit together, is a finding
of the claim with its place, and the members that are left can be judged all the same.

Lines that only give a number: ``I_1 = 3``, ``\\theta = 30^\\circ``, ``M = 5\\,\\text{kg}``.

No motion shows whether they are right; a zero is no such number, as it says something of motions.

New symbols as the components of a known vector: ``\vec\omega = p \hat b_1 + q \hat b_2 + r \hat b_3``.

All three of them are new; a column or a list of three does as well.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from collections.abc import Sequence as Sequenced
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from eom import limits
from eom.checker.mean import examples, instants, numbers
from eom.checker.mean.calculus import leaves_sign, lone_logarithm
from eom.checker.mean.dimensions import NONE, power
from eom.checker.mean.elaborate import elaborator, in_brackets
from eom.checker.mean.elaborator import TRANSPOSED, Elaborator, own_look, turned_round
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.tables import same
from eom.checker.mean.values import (
    ANY,
    ROW,
    UNDECIDED,
    WRONG,
    Finding,
    Refusal,
    Value,
    basis,
    overdot,
)
from eom.checker.read.spans import NOWHERE, Span
from eom.checker.read.statements import Statement, says_constant, single_statements
from eom.checker.read.symbol_shape import Look, bracket_of, called_symbol, labels, seen
from eom.checker.read.syntax import (
    Addition,
    Group,
    Marks,
    Matrix,
    Node,
    Number,
    Product,
    Scripts,
    Sequence,
    Sign,
    Symbol,
    Words,
    walk,
)
from eom.terms.terms import COLUMN, SCALAR, VECTOR, Term, dot, expr, inner
from eom.terms.vocabulary import position, unit

if TYPE_CHECKING:
    from eom.checker.mean.model import Model
    from eom.checker.mean.moving import Moving

Expr = Any  # SymPy has no usable annotations


@dataclass(frozen=True)
class Relation:
    """What a note says that a scalar is: ``value`` in scalars without a relation; ``line`` of the note."""

    symbol: Expr
    value: Expr
    written: Expr


@dataclass(frozen=True)
class Parameters:
    """What a claim between free scalars may rest on, and what it is made of.

    ``variables``: letters over which it integrates; ``integrals``: places of the members that have one;
    ``fresh``: letters that a word as label brings in; ``constant``: whether an integrand shows none of
    the variables, so that it may depend on them unseen; ``defining``: whether the words around say so.
    """

    relations: tuple[Relation, ...] = ()
    variables: tuple[str, ...] = ()
    integrals: frozenset[Span] = frozenset()
    fresh: frozenset[Expr] = frozenset()
    constant: bool = False
    defining: bool = False


EQUALITIES = frozenset({"=", ":=", "=:", "equiv"})
COMPARISONS = frozenset({"<", ">", "<=", ">=", "!=", "<<", ">>", "approx", "simeq"})
PROPORTIONAL = "propto"
"""The sign of a constant quotient; such a claim has two members, of any dimensions."""
LIMITS = frozenset({"to"})
"""Signs of what is approached, which claim nothing: N to infinity."""
STATEMENT, DEFINITION, CONSTANT, SAME_POINT = "statement", "definition", "constant", "same point"


@dataclass(frozen=True)
class Claim:
    """A chain: ``members`` joined by ``relations``.

    ``kind``: "statement"; "definition": the first member is new, its look is ``defines``;
    "constant": the only member, a derivative, is zero; "same point": the only member, a position, is
    zero. ``role``: of a condition ("if", "for", "where", ...), "" for a claim of its own; ``joined``:
    the arrow that leads here. A continued chain begins with the first member of the chain before,
    and ``previous`` is the last one of that. ``findings``: why members are missing, or the claim is
    ill-formed or wrong by itself. ``scalars``: what the symbols of SymPy stand for.
    ``model``: the system that scalar lines of the note are about. ``parameters``: of a chain of free
    scalars, see `eom.checker.mean.parameters`; ``numbers``: that it gives, see `eom.checker.mean.examples`;
    ``order``: of what is said to be left out, and in what; ``indices``: what free ones stand for in it.
    ``otherwise``: the same with Poisson brackets of the other sign, where nothing says which they have.
    ``moving``: frames, places and laws of the note's own.
    """

    members: tuple[Value, ...]
    relations: tuple[str, ...] = ()
    kind: str = STATEMENT
    role: str = ""
    joined: str = ""
    defines: Look | None = None
    previous: Value | None = None
    findings: tuple[Finding, ...] = ()
    scalars: Mapping[Any, Term] = field(default_factory=dict)
    span: Span = NOWHERE
    model: Model | None = field(default=None, compare=False)
    parameters: Parameters | None = field(default=None, compare=False)
    order: tuple[Value, int] | None = field(default=None, compare=False)
    numbers: Mapping[Look, Value] = field(default_factory=dict, compare=False)
    indices: Mapping[str, str] = field(default_factory=dict, compare=False)
    otherwise: Claim | None = field(default=None, compare=False, repr=False)
    moving: Moving | None = field(default=None, compare=False, repr=False)

    @property
    def verdict(self) -> str:
        """The gravest finding: "wrong", "ill-formed", "ambiguous", "undecided", or "" for none."""
        verdicts = {f.verdict for f in self.findings}
        return next((v for v in GRAVITY if v in verdicts), "")


GRAVITY = ("wrong", "ill-formed", "ambiguous", "undecided")


def claims(
    statement: Statement,
    lexicon: Lexicon,
    definitions: Mapping[Look, Value] | None = None,
    before: Sequenced[Claim] = (),
    indices: Mapping[str, str] | None = None,
) -> tuple[Claim, ...]:
    """Return what a statement claims at a place of a note, its conditions first.

    ``lexicon``: what holds there; ``definitions``: what the note has defined above; ``before``: the
    claims that a leading sign of equality may continue; ``indices``: what bound ones stand for. Words
    alone claim nothing.
    """
    found = _found(statement, lexicon, definitions, before, indices)
    if not leaves_sign(elaborator(lexicon, definitions), statement.members):
        return found
    turned = replace(lexicon, notation=replace(lexicon.notation, brackets="p q"))
    others = _found(statement, turned, definitions, before, indices)
    pairs = zip(found, others, strict=True)
    return tuple(replace(a, otherwise=b if a.members != b.members else None) for a, b in pairs)


def _found(
    statement: Statement,
    lexicon: Lexicon,
    definitions: Mapping[Look, Value] | None,
    before: Sequenced[Claim],
    indices: Mapping[str, str] | None,
) -> tuple[Claim, ...]:
    known = dict(definitions or {})
    found: list[Claim] = []
    parts = [*statement.conditions, ("", statement)]
    for role, part in parts:
        for one in single_statements(part):
            e = elaborator(lexicon, known).bound(**(indices or {}))
            parts_of = resolved(one, e)
            if parts_of:
                found += [
                    replace(_component(c, one), role=role, joined=one.joined) for c in parts_of
                ]
                continue
            for new in _claimed(one, e, before):
                found.append(replace(new, role=role, joined=one.joined, indices=indices or {}))
    return tuple(found)


def _claimed(one: Statement, e: Elaborator, before: Sequenced[Claim]) -> Iterator[Claim]:
    """Yield what a single statement claims: by its symbols, and by the numbers in a worked example."""
    example = examples.worked(one, e)
    rest = one if example is None else example.rest
    for apart in _apart(rest, e) if rest is not None else ():
        yield from _chain(apart, e, before)
    if example is not None:
        agreed = (examples.agreed(),) * 2 if example.finding is None else ()
        findings = (example.finding,) if example.finding is not None else ()
        relations = ("=",) if agreed else ()
        yield Claim(agreed, relations, findings=findings, numbers=example.numbers, span=one.span)


def defined(found: Iterable[Claim]) -> dict[Look, Value]:
    """Return what claims define, and the numbers that they give."""
    found = tuple(found)
    new = [c for c in found if c.kind == DEFINITION and c.defines and c.otherwise is None]
    named = {
        c.defines: replace(c.members[0], scalars=c.scalars) for c in new if c.defines is not None
    }
    return named | {k: v for c in found for k, v in c.numbers.items()}


def _component(one: Component, s: Statement) -> Claim:
    """Return that a new symbol is a component of a vector."""
    return Claim((one.value, one.value), ("=",), DEFINITION, defines=one.look, span=s.span)


# -- chains --------------------------------------------------------------------------------------


def _chain(s: Statement, e: Elaborator, before: Sequenced[Claim]) -> list[Claim]:
    """Return what a chain says."""
    signs = (*_introducing(s), *(sign.name for sign in s.signs[1:]))
    known = EQUALITIES | COMPARISONS | {PROPORTIONAL}
    unknown = next((g for g in s.signs if g.name not in known), None)
    if unknown is not None and unknown.name in LIMITS:
        return []
    if unknown is not None:
        finding = Finding(UNDECIDED, "a relation without a meaning", unknown.span, unknown.name)
        return [Claim((), findings=(finding,), span=s.span)]
    whole = _datum(s, e) or _points(s, e)
    if whole is not None:
        return [whole]
    nodes, order = _left_out(s.members, e)
    constant = says_constant(nodes[-1])
    if constant:
        nodes.pop()
    instants.note(e, nodes)
    nodes = in_brackets(nodes, e)
    look = _new(nodes, signs, e, LEFT_OPEN if s.signs[0].name == ":=" else LEFT)
    skip = int(look is not None or s.continues)
    values, findings = _values(e, nodes[skip:])
    if not findings:
        values = _lying(nodes[skip:], values)
    findings = findings or ([] if constant else _units_in_logarithms(e, nodes))
    made = Claim((), signs, span=s.span, scalars=e.scalars, findings=tuple(findings))
    made = replace(made, model=e.lexicon.system, order=order)
    found = []
    if look is not None:
        found = [_definition(made, e, look, nodes[0].span, values)]
    elif s.continues:
        found = [_continued(made, e, values, before)]
    elif len(nodes) > 1:
        found = [_joined(made, e, values)]
    if constant or any(says_constant(Words(w)) for w in s.words):
        found.append(_constant(made, e, values))
    return found


def _units_in_logarithms(e: Elaborator, nodes: Iterable[Node]) -> list[Finding]:
    """Return that a logarithm has a unit left in it."""
    place = lone_logarithm(e, nodes)
    said = "the argument of a function has a dimension"
    return [] if place is None else [Finding(WRONG, said, place)]


def _left_out(
    members: Iterable[Node], e: Elaborator
) -> tuple[list[Node], tuple[Value, int] | None]:
    """Return members without what they say to be left out, ``O(x^2)``, and the first of that."""
    found: list[Node] = []
    order: tuple[Value, int] | None = None
    for node in members:
        terms = node.terms if isinstance(node, Addition) else ()
        left = _order_of(terms[-1], e) if len(terms) > 1 else None
        order = order or left
        found.append(node if left is None else _without_last(node))
    return found, order


def _without_last(node: Any) -> Node:
    kept = replace(node, terms=node.terms[:-1], signs=node.signs[:-1])
    first: Node = kept.terms[0]
    return first if len(kept.terms) == 1 and kept.signs[0] in {"", "+"} else kept


def _order_of(node: Node, e: Elaborator) -> tuple[Value, int] | None:
    """Return of what and of which order a remainder is: ``O(x^2)``."""
    factors = node.factors if isinstance(node, Product) and not node.operator else ()
    letter, inside = factors if len(factors) == 2 else (None, None)
    if not isinstance(letter, Symbol) or letter.name != "O" or not isinstance(inside, Group):
        return None
    body = inside.body
    base, power = (body.base, body.sup) if isinstance(body, Scripts) and body.sup else (body, None)
    if isinstance(body, Scripts) and body.sub is not None:
        base = replace(body, sup=None)
    text = "1" if power is None else "".join(labels(power))
    found = _values(e, [base])[0]
    return (found[0], int(text)) if found and text.isdigit() and found[0].shape == SCALAR else None


def _introducing(s: Statement) -> tuple[str, ...]:
    """Return the first sign; one of identity behind a symbol alone defines it, as words may say."""
    first = s.signs[0].name
    symbol, other = s.members[:2]
    found = seen(called_symbol(symbol)) if not s.continues else None
    said = first == "equiv" or (first == "=" and any("by definition" in w for w in s.words))
    alone = found is not None and not found.dots and not isinstance(other, Number | Words)
    return (":=",) if said and alone else (first,)


def _values(e: Elaborator, nodes: Iterable[Node]) -> tuple[list[Value], list[Finding]]:
    """Return the values of members, and why some have none."""
    values, findings = [], []
    for node in nodes:
        try:
            values.append(e.value(node))
        except Refusal as refusal:
            findings.append(refusal.finding)
    return values, findings


def _lying(nodes: list[Node], values: list[Value]) -> list[Value]:
    """Return members where a list in round brackets lies down beside a row."""
    if not any(v.shape == ROW for v in values):
        return values
    return [
        replace(v, shape=ROW) if v.shape == COLUMN and _is_list(n) else v
        for n, v in zip(nodes, values, strict=True)
    ]


def _is_list(node: Node) -> bool:
    return isinstance(node, Group) and node.open == "(" and isinstance(node.body, Sequence)


def _joined(claim: Claim, e: Elaborator, values: list[Value]) -> Claim:
    """Return the claim with members of one shape; every link is compared, and the ends."""
    notation = e.lexicon.notation
    if claim.relations == (PROPORTIONAL,):
        return replace(claim, members=tuple(values))
    shaped: list[Value] = values[:1]
    findings = list(claim.findings)
    for value in values[1:]:
        limits.check()
        try:
            first, last = same(notation, shaped[-1], value)
            shaped = [same(notation, last, v)[1] for v in shaped[:-1]]
            shaped += [first, last]
        except Refusal as refusal:
            findings.append(refusal.finding)
    relations = claim.relations
    if len(shaped) != len(relations) + 1:
        equal = all(r in EQUALITIES for r in relations)
        relations = ("=",) * (len(shaped) - 1) if equal else ()
        shaped = shaped if equal else []
    return replace(claim, members=tuple(shaped), relations=relations, findings=tuple(findings))


def _continued(claim: Claim, e: Elaborator, values: list[Value], before: Sequenced[Claim]) -> Claim:
    """Return a chain whose first member is that of a chain before, the last one that fits."""
    heads = [c for c in before if c.members and c.kind in {STATEMENT, DEFINITION} and not c.role]
    tried = []
    for head in reversed(heads):
        first = replace(head.members[0], span=claim.span)
        e.scalars.update({s: t for s, t in head.scalars.items() if s not in e.scalars})
        made = replace(_joined(claim, e, [first, *values]), previous=head.members[-1])
        if len(made.findings) == len(claim.findings):
            return made
        tried.append(made)
    if tried:
        return tried[0]
    finding = Finding(UNDECIDED, "a relation continues nothing that is known", claim.span)
    return replace(claim, findings=(*claim.findings, finding))


# -- new symbols behind the first place --------------------------------------------------------------


def _apart(s: Statement, e: Elaborator) -> Iterator[Statement]:
    """Yield a chain without a member that it brings in, and that member's definition, else the chain.

    In ``a = b := c = d`` with a new b the claim is a = c = d; b stands for its neighbour.
    """
    place = _brought(s, e)
    if place is None:
        yield s
        return
    sign = Sign("=", span=s.signs[place - 1].span)
    if len(s.members) > 2:
        signs = (*s.signs[: place - 1], sign, *s.signs[place + 1 :])
        kept = (*s.members[:place], *s.members[place + 1 :])
        yield replace(s, members=kept, signs=signs[: len(kept) - 1])
    other = s.members[place - 1]
    if not (s.continues and place == 1):
        sign = replace(sign, name=":=")
        yield Statement((s.members[place], other), (sign,), s.members[place].span.join(other.span))


def _brought(s: Statement, e: Elaborator) -> int | None:
    """Return the place of a member behind the first that is a symbol still to be defined."""
    signs = [g.name for g in s.signs]
    if not signs or not EQUALITIES.issuperset(signs) or _new(list(s.members), tuple(signs), e):
        return None
    for k in range(1, len(s.members)):
        pair = [s.members[k], s.members[k - 1]]
        near = {*signs[k - 1 : k + 1]}
        said = ":=" if near & {":=", "=:", "equiv"} else "="
        if says_constant(pair[0]) or e.lexicon.points.get(labels(pair[0])) is not None:
            continue
        if _new(pair, (said,), e) is not None:
            return k
    return None


# -- definitions, constants, points ----------------------------------------------------------------


LEFT = frozenset({"defined"})
LEFT_OPEN = LEFT | {"vector"}
"""Meanings that are left to the note; a sign of definition says also which vector any vector is."""


def _new(
    nodes: list[Node], signs: tuple[str, ...], e: Elaborator, open_: frozenset[str] = LEFT
) -> Look | None:
    """Return the look of the left side if the chain defines it: it is free, or left to the note."""
    if len(nodes) < 2 or signs[0] not in {"=", ":=", "equiv"}:
        return None
    node = called_symbol(nodes[0])
    brackets = bracket_of(node)
    if brackets is not None and _defines_brackets(brackets, signs[0], nodes[1:], e):
        return brackets
    inner = node.body if isinstance(node, Group) and node.open == "[" else node
    found = seen(inner)
    if found is None or found.dots:
        return None
    for look in (found.with_label(), found.look):
        entry = e.lexicon.find(look, e.indices) if look is not None else None
        if entry is not None and signs[0] == ":=" and _primed(inner, e):
            break
        if entry is not None:
            own = own_look(entry, e)
            free = entry.meaning.quantity in open_ and own not in e.definitions
            free = free and not turned_round(e, entry)
            return own if free and (look == found.with_label() or not found.raised) else None
    look = e.lexicon.notation.plain(found.with_label() or found.look).numbered(e.indices)
    new = signs[0] == ":=" and (_primed(inner, e) or not _values(e, [inner])[0])
    return look if new else None


def _primed(node: Node, e: Elaborator) -> bool:
    """Return whether the mark of a derivative in a frame stands on a scalar, which has none: a name."""
    if not isinstance(node, Scripts) or not isinstance(node.sup, Marks):
        return False
    bare, _ = _values(e, [replace(node, sup=None) if node.sub is not None else node.base])
    moving = e.lexicon.notation.marks.keys() >= set(node.sup.names)
    return moving and len(bare) == 1 and bare[0].shape == SCALAR


def _defines_brackets(look: Look, sign: str, others: Iterable[Node], e: Elaborator) -> bool:
    """Return whether brackets of two letters are defined: of any functions, for the first time.

    What they are is said with both of the letters, and with no such bracket.
    """
    inside = [n for other in others for n in walk(other)]
    shown = {f.look.text for n in inside if (f := seen(n)) is not None}
    if len({*look.sub} & shown) < 2 or any(bracket_of(n) for n in inside):
        return False
    if any(k.name == look.name and len(k.sub) == 2 for k in e.definitions):
        return False
    system = e.lexicon.system
    free = system is not None and set(look.sub) <= system.canonical - {"H"}
    return free or sign in {":=", "equiv"}


def _definition(claim: Claim, e: Elaborator, look: Look, span: Span, values: list[Value]) -> Claim:
    if not values:
        return claim
    head = replace(values[0], span=span)
    made = _joined(claim, e, [head, *values])
    return replace(made, kind=DEFINITION, defines=look) if made.members else made


def _constant(claim: Claim, e: Elaborator, values: list[Value]) -> Claim:
    if not values:
        return claim
    moving = [v for v in values if not _is_free(v, e)] or values
    steady = overdot(e.lexicon.notation, without_root(moving[-1]), 1, claim.span)
    return replace(claim, members=(steady,), relations=(), kind=CONSTANT)


def _is_free(value: Value, e: Elaborator) -> bool:
    """Return whether a member is a free scalar alone, of which it says nothing that it is constant."""
    expression = value.term.data[0] if value.term.head == "expr" else None
    meaning = e.scalars.get(expression)
    return meaning is not None and meaning.data[:1] == ("scalar",)


def without_root(value: Value) -> Value:
    """Return the square of a magnitude, which is constant when it is; anything else stays."""
    expression = value.term.data[0] if value.term.head == "expr" else None
    if expression is None or not (expression.is_Pow and expression.exp == sp.Rational(1, 2)):
        return value
    return replace(value, term=expr(expression.base), dimension=power(value.dimension, 2))


def _datum(s: Statement, e: Elaborator) -> Claim | None:
    """Return that a number is given, which nothing else gives."""
    if not given_number(s, e) and not _starts(s, e):
        return None
    finding = Finding(UNDECIDED, examples.GIVEN_NUMBER, s.span)
    return Claim((), findings=(finding,), numbers=examples.given(s, e), span=s.span)


def _starts(s: Statement, e: Elaborator) -> bool:
    """Tell whether a statement gives the value of something at an instant: ``x(0) = 3``."""
    if len(s.members) != 2 or s.continues or s.signs[0].name not in EQUALITIES:
        return False
    for whole, other in (s.members, s.members[::-1]):
        factors = whole.factors if isinstance(whole, Product) and not whole.operator else ()
        inside = factors[1] if len(factors) == 2 else None
        if not isinstance(inside, Group) or instants.key(e, inside.body) in {"", "t"}:
            continue
        found = seen(other)
        entry = e.lexicon.find(found.look, e.indices) if found is not None else None
        named = found is not None and (entry is None or entry.meaning.quantity == "scalar")
        if seen(factors[0]) is not None and (named or numbers.is_number(other)):
            return True
    return False


def _points(s: Statement, e: Elaborator) -> Claim | None:
    """Return the claim that two points are the same, if both sides are points and nothing else."""
    if len(s.members) != 2 or s.signs[0].name not in {"=", "equiv"}:
        return None
    names = [e.lexicon.points.get(labels(m)) for m in s.members]
    if None in names or any(_means(e, m) for m in s.members):
        return None
    term = position(str(names[0]), str(names[1]))
    return Claim((Value(term, term.kind, span=s.span),), kind=SAME_POINT, span=s.span)


def _means(e: Elaborator, node: Node) -> bool:
    found = seen(node)
    return found is not None and e.lexicon.find(found.look, e.indices) is not None


def given_number(s: Statement, e: Elaborator) -> bool:
    """Return whether a statement gives a quantity with a dimension, or in degrees, by a number."""
    if len(s.members) != 2 or s.continues or s.signs[0].name not in {"=", "equiv", "approx"}:
        return False
    symbol, number = s.members
    if numbers.is_number(symbol):
        symbol, number = number, symbol
    found = seen(symbol)
    if found is None or found.raised or not numbers.is_number(number) or numbers.is_zero(number):
        return False
    if numbers.in_degrees(number) or any(w.startswith("[") for w in s.words):
        return True
    try:
        value = e.value(symbol)
    except Refusal:
        return False
    return value.dimension not in {None, NONE, ANY}


@dataclass(frozen=True)
class Component:
    """A new symbol, what it stands for, and its place."""

    look: Look
    value: Value
    span: Span


def resolved(s: Statement, e: Elaborator) -> tuple[Component, ...]:
    """Return the three symbols that a statement brings in as components; none if it does not."""
    if len(s.members) != 2 or s.continues or s.signs[0].name not in {"=", ":=", "=:", "equiv"}:
        return ()
    left, right = s.members
    return _resolved(left, right, e) or _resolved(right, left, e)


def _resolved(known: Node, spelt: Node, e: Elaborator) -> tuple[Component, ...]:
    symbols, frame = _listed(spelt), ""
    if not symbols:
        symbols, frame = _summed(spelt, e)
    looks = [_unknown(n, e) for n in symbols]
    if len(looks) != 3 or None in looks or len(set(looks)) != 3:
        return ()
    try:
        value = e.value(known)
    except Refusal:
        return ()
    frame = frame or e.lexicon.notation.mixed
    terms = _terms(value, frame)
    return tuple(
        Component(look, Value(term, SCALAR, value.dimension, span=n.span), n.span)
        for look, term, n in zip(looks, terms, symbols, strict=False)
        if look is not None
    )


def _terms(value: Value, frame: str) -> tuple[Term, ...]:
    """Return the components of a vector in a frame, or of a column; none of anything else."""
    if value.shape == VECTOR and frame:
        return tuple(dot(unit(frame, k), value.term) for k in (1, 2, 3))
    return tuple(inner(value.term, basis(k)) for k in (1, 2, 3)) if value.shape == COLUMN else ()


def _unknown(node: Node, e: Elaborator) -> Look | None:
    """Return the look of a symbol without a meaning."""
    found = seen(node)
    if found is None or found.dots or found.raised:
        return None
    look = e.lexicon.notation.plain(found.look)
    known = e.lexicon.find(look, e.indices) is not None or look in e.definitions
    return None if known else look


def _listed(node: Node) -> tuple[Node, ...]:
    """Return the entries of a column or a list of three."""
    if isinstance(node, Scripts) and labels(node.sup) and set(labels(node.sup)) <= TRANSPOSED:
        node = node.base
    if isinstance(node, Group) and node.open in {"(", "[", "{"}:
        node = node.body
    if isinstance(node, Sequence):
        return node.items if len(node.items) == 3 else ()
    if isinstance(node, Matrix):
        cells = tuple(c for row in node.rows for c in row)
        return cells if len(cells) == 3 and 1 in {len(node.rows), len(node.rows[0])} else ()
    return ()


def _summed(node: Node, e: Elaborator) -> tuple[tuple[Node, ...], str]:
    """Return the symbols before the unit vectors of a frame, in their order, and the frame."""
    if not isinstance(node, Addition) or len(node.terms) != 3 or set(node.signs) - {"", "+"}:
        return (), ""
    found: dict[str, Node] = {}
    frames = set()
    for term in node.terms:
        pair = _term(term, e)
        if pair is None:
            return (), ""
        symbol, (frame, axis) = pair
        found[axis] = symbol
        frames.add(frame)
    whole = sorted(found) == ["1", "2", "3"] and len(frames) == 1
    return (tuple(found[k] for k in sorted(found)), frames.pop()) if whole else ((), "")


def _term(node: Node, e: Elaborator) -> tuple[Node, tuple[str, str]] | None:
    """Return the symbol of a term, and frame and axis of its unit vector."""
    if not isinstance(node, Product) or node.operator or len(node.factors) != 2:
        return None
    for symbol, vector in (node.factors, node.factors[::-1]):
        try:
            term = e.value(vector).term
        except Refusal:
            continue
        if term.head == "atom" and term.data[0] == "unit":
            return symbol, (term.data[1], term.data[2])
    return None
