"""Displays of the lectures as statements, and whether steps of derivations are them.

A display is read from LaTeX, corrected where the lecture is wrong, with the lexicon of its lecture; what
the words around it say of its symbols stands in `MEANT` and `GIVEN`. Nothing is compared by labels or
letters: two sides are the same where they have the same values in worlds in which no more is assumed
than that all of it exists.
"""

from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import sympy as sp

from eom.checker.judge.notes import understand
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document
from eom.errors import InputError
from eom.fields import Singular
from eom.terms import terms
from eom.terms.terms import Term, column, dot, expr, relabel
from eom.terms.vocabulary import quantity, unit
from eom.worlds.evaluate import Evaluator, flat
from eom.worlds.generators import world
from eom.worlds.worlds import closure
from tests.eom.carried import carried

HERE = Path(__file__).parent
LEXICA = HERE.parent / "checker" / "lexica"
EXISTING = ((), ("spin_312",), ("principal_axes",))
"""Assumptions under which quantities exist, the fewest first."""
SEEDS = (11, 12)
POINTS = {"000": {"O": "C"}, "002:E35": {"OA": "C"}}
"""Which point is the centre of mass, as the words of a lecture, or before a display, say."""
GIVEN = {"000:E39": ("C_at_rest",), "002:E36": ("unit_eigenvectors",)}
"""What else they say: the translation left out; (corrected) unit vectors, right-handed."""


@dataclass(frozen=True)
class Side:
    """A side of a statement, with what its symbols stand for."""

    term: Term
    scalars: dict

    def __hash__(self):
        return hash(self.term)


@dataclass(frozen=True)
class Link:
    """Two neighbouring members of a display."""

    display: str
    left: Side
    right: Side


def principal(k):
    """The moment of inertia about an axis of B through the centre of mass."""
    axis = unit("B", k)
    return dot(axis, dot(quantity("inertia", "C"), axis))


def _eigenvectors(side):
    """The vectors v_k are eigenvectors: unit vectors along the principal axes, by components in A."""
    vectors = {quantity("vector", f"v{k}"): unit("B", k) for k in (1, 2, 3)}

    def rule(node):
        inside = vectors.get(node.args[0]) if node.head == "column" else None
        return node if inside is None else column(inside, "A")

    return replace(side, term=terms.replace(side.term, rule))


def _eigenvalues(side):
    """The numbers lambda_k are eigenvalues: principal moments of inertia."""
    known = {s: principal(int(s.name[-1])) for s in side.scalars if s.name.startswith("lambda")}
    return replace(side, scalars={**side.scalars, **known})


def _momentum_ellipsoid(side):
    """The ellipsoid in the space of rates of which the lecture speaks, of semi-axes H/I_k."""
    rates = {
        q: dot(unit("B", k), quantity("angular_velocity", "B", "I")) for k, q in enumerate("xyz", 1)
    }
    h = quantity("angular_momentum", "body", "C")
    size, moments = sp.Symbol("any H"), sp.symbols("I_1:4")
    axes = {q: size / moment for q, moment in zip("abc", moments, strict=True)}
    e = side.term.data[0].xreplace({s: axes.get(s.name, s) for s in side.term.data[0].free_symbols})
    square = sp.Symbol("any square")
    scalars = {s: rates[s.name] for s in e.free_symbols if s.name in rates}
    scalars |= {m: principal(k) for k, m in enumerate(moments, 1)}
    scalars |= {size: expr(sp.sqrt(square)), square: dot(h, h)}
    return Side(expr(e), scalars)


MEANT = {"000:E17": _eigenvectors, "000:E18": _eigenvalues, "000:E38": _momentum_ellipsoid}
"""What words say of letters that a lexicon has as any vectors or numbers."""


@cache
def links(lecture):
    """How many displays a lecture has, and the statements in them, in order."""
    text = (HERE / "lectures" / f"{lecture}.md").read_text(encoding="utf-8")
    lexicon = parse_lexicon((LEXICA / f"{lecture}.toml").read_text(encoding="utf-8"), lecture)
    understood = understand(read_document(text), lexicon)
    displays = [u for u in understood if u.formula.piece.kind == "display"]
    found = []
    for k, one in enumerate(displays, 1):
        name = f"{lecture}:E{k}"
        for claim in one.claims:
            assert not claim.findings, (name, claim.findings)
            sides = [_meant(Side(m.term, dict(claim.scalars)), name) for m in claim.members]
            found += [Link(name, a, b) for a, b in pairwise(sides)]
    return len(displays), tuple(found)


def _meant(side, display):
    named = POINTS.get(display, POINTS.get(display[:3], {}))
    scalars = {s: relabel(m, named) for s, m in side.scalars.items()}
    return MEANT.get(display, lambda s: s)(Side(relabel(side.term, named), scalars))


# -- whether they are the same ----------------------------------------------------------------


def sides_of(d, step):
    """The sides of a step."""
    scalars = {s: carried(d, terms.Equation(t, t)).left for s, t in d.scalars.items()}
    line = carried(d, step.statement)
    return Side(line.left, scalars), Side(line.right, scalars)


@cache
def values(side, assumed, seed):
    """The components of a side in a world, for all indices; None where it has no value there."""
    try:
        found = Evaluator(world(closure(assumed), seed), side.scalars)
        numberings = list(found.numberings(found.labels(side.term)))
        return [s.coefficients for env in numberings for s in flat(found.value(side.term, env))]
    except Singular:
        return None


def worlds_of(sides, given):
    """The fewest assumptions under which all sides exist. Raises `InputError` where there are none."""
    for assumed in EXISTING:
        try:
            both = tuple(sorted({*assumed, *given}))
            for side in sides:
                values(side, both, SEEDS[0])
        except InputError:
            continue
        return both
    raise InputError("exists under none of these assumptions", got=sides[0].term.head)


def same(a, b, given=()):
    """Whether two sides have the same values."""
    if a.term.kind != b.term.kind:
        return False
    try:
        assumed = worlds_of((a, b), given)
    except InputError:
        return False
    return all(values(a, assumed, seed) == values(b, assumed, seed) for seed in SEEDS)


def same_rest(link, sides, given=()):
    """Whether left less right of two statements are multiples, and not zero."""
    if link.left.term.kind != sides[0].term.kind:
        return False
    try:
        assumed = worlds_of((link.left, link.right, *sides), given)
    except InputError:
        return False
    return all(_proportional(link, sides, assumed, seed) for seed in SEEDS)


def _proportional(link, sides, assumed, seed):
    parts = [values(s, assumed, seed) for s in (link.left, link.right, *sides)]
    if None in parts:
        return False
    reduce = world(closure(assumed), seed).field.reduce
    a, b = (
        [
            reduce(x - y)
            for p, q in zip(one, other, strict=False)
            for x, y in zip(p, q, strict=False)
        ]
        for one, other in (parts[:2], parts[2:])
    )
    if len(a) != len(b) or not any(a) or not any(b):
        return False
    k = next(i for i, x in enumerate(b) if x)
    return bool(a[k]) and all(reduce(x * b[k] - a[k] * y) == 0 for x, y in zip(a, b, strict=True))


def is_stated(link, steps):
    """Whether steps, each by its sides, state a link: one of them, or a chain of equal sides of them."""
    given = GIVEN.get(link.display, ())
    if any(same_rest(link, sides, given) for sides in steps):
        return True
    reached, waiting = [], [s for sides in steps for s in sides if same(link.left, s, given)]
    while waiting:
        one = waiting.pop()
        if same(link.right, one, given):
            return True
        reached.append(one)
        for sides in steps:
            for here, there in (sides, sides[::-1]):
                if same(one, here, given) and there not in reached and there not in waiting:
                    waiting.append(there)
    return False
