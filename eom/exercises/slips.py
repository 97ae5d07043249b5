"""Slips that people make, as edits of typed terms: what stands there, and what is written instead.

A row of `SLIPS` looks at one node and yields what a slip makes of it. Rules know kinds of terms and
nothing of truth: whether a line becomes false is decided by those who apply them. The kinds are those
that the literature on students' derivations, and every marker, meets first: signs, lost terms, exchanged
indices, lost dots, wrong frames and points, the order of products, numbers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from dataclasses import replace as changed
from typing import Any, cast

import sympy as sp

from eom.errors import InputError
from eom.terms.terms import (
    SCALAR,
    Equation,
    Term,
    cross,
    der,
    expr,
    mul,
    nodes,
    rebuild,
    replace,
)

Expr = Any
Path = tuple[int, ...]


@dataclass(frozen=True)
class Around:
    """What a slip may take instead: symbols, frames and quantities that the derivation uses."""

    symbols: tuple[Expr, ...] = ()
    frames: tuple[str, ...] = ()
    atoms: tuple[Term, ...] = ()


Rule = Callable[[Term, Around], Iterator[tuple[Term, Term, Term]]]
"""From a node: what stands there anew, then the part as it was, and as it is now."""
LineRule = Callable[[Equation, Around], Iterator[tuple[Equation, Term, Term]]]
"""The same from a line: the whole line anew, then the part as it was, and as it is now."""

DIFFICULTIES = ("easy", "medium", "hard")
"""How well a slip hides: seen in the line itself, beside the lines around it, by mechanics alone."""


@dataclass(frozen=True)
class Kind:
    """What a teacher knows of a kind of slips.

    ``difficulty``: a row of `DIFFICULTIES`; ``sentence``: what is said to the student.
    """

    difficulty: str
    sentence: str


@dataclass(frozen=True)
class Slip:
    """A row: name, what was done wrong in ``words``, and the ``rule`` that does it to a term or a line."""

    name: str
    words: str
    rule: Rule | LineRule

    @property
    def kind(self) -> Kind:
        """What a teacher knows of it."""
        return KINDS[self.name]


@dataclass(frozen=True)
class Planted:
    """A slip in an equation: its kind, the part as it was (``right``) and is now (``wrong``), the whole."""

    slip: Slip
    right: Term
    wrong: Term
    equation: Equation


def whole(rule: Callable[[Term, Around], Iterator[Term]]) -> Rule:
    """Return the rule whose part is the whole node."""

    def slipped(node: Term, around: Around) -> Iterator[tuple[Term, Term, Term]]:
        for new in rule(node, around):
            yield new, node, new

    return slipped


# -- sums -------------------------------------------------------------------------------------------


def _parts(node: Term) -> tuple[Term, ...]:
    """Return the terms of a sum, those of an expression apart; nothing for what is no sum."""
    if node.head == "expr" and node.data[0].is_Add:
        return tuple(map(expr, node.data[0].as_ordered_terms()))
    return node.args if node.head == "add" else ()


def _summed(node: Term, parts: tuple[Term, ...]) -> Term:
    if node.head == "expr":
        return expr(sp.Add(*(p.data[0] for p in parts)))
    return rebuild(node, parts)


def _signs(node: Term, _: Around) -> Iterator[tuple[Term, Term, Term]]:
    parts = _parts(node)
    for k, part in enumerate(parts):
        new = mul(expr(sp.Integer(-1)), part)
        yield _summed(node, (*parts[:k], new, *parts[k + 1 :])), part, new


def _dropped(node: Term, _: Around) -> Iterator[tuple[Term, Term, Term]]:
    parts = _parts(node)
    for k, part in enumerate(parts):
        yield _summed(node, (*parts[:k], *parts[k + 1 :])), part, mul(expr(sp.Integer(0)), part)


# -- vectors, frames, points ------------------------------------------------------------------------


def _order(node: Term, _: Around) -> Iterator[Term]:
    if node.head == "cross":
        yield cross(node.args[1], node.args[0])
    if _is_square_product(node) and not all(map(_turns, node.args)):
        yield rebuild(node, (node.args[1], node.args[0]))


def _is_square_product(node: Term) -> bool:
    return node.head == "matmul" and node.args[0].kind == node.args[1].kind


def _turns(node: Term) -> bool:
    """Return whether a matrix is a rotation, or one turned round."""
    inner = node.args[0] if node.head == "transpose" else node
    return inner.head == "atom" and inner.data[0] == "rotation"


def _order_of_turns(node: Term, _: Around) -> Iterator[Term]:
    """Exchange rotations: two that are multiplied, or those on both sides of a matrix."""
    if not _is_square_product(node):
        return
    first, second = node.args
    if _turns(first) and _turns(second):
        yield rebuild(node, (second, first))
    elif _turns(first) and second.head == "matmul" and _turns(second.args[1]):
        yield rebuild(node, (second.args[1], rebuild(second, (second.args[0], first))))


def _brackets(node: Term, _: Around) -> Iterator[Term]:
    if node.head == "cross" and node.args[1].head == "cross":
        first, (second, third) = node.args[0], node.args[1].args
        yield cross(cross(first, second), third)


def _frame_of_derivative(node: Term, around: Around) -> Iterator[Term]:
    if node.head == "der" and node.data != ("",):
        yield from (der(node.args[0], f) for f in around.frames if (f,) != node.data)


def _dot(node: Term, _: Around) -> Iterator[Term]:
    if node.head == "der":
        yield node.args[0]


_TURNED = frozenset({"rotation", "angular_velocity"})
_ABOUT = frozenset(
    {
        "position",
        "inertia",
        "torque",
        "angular_momentum",
        "absolute_angular_momentum",
        "first_moment",
    }
)


def _frames_exchanged(node: Term, _: Around) -> Iterator[Term]:
    if node.head == "atom" and node.data[0] in _TURNED:
        name, a, b, *more = node.data
        yield changed(node, data=(name, b, a, *more))


def _frame_of_omega(node: Term, around: Around) -> Iterator[Term]:
    if node.head == "atom" and node.data[0] == "angular_velocity":
        name, a, b, *more = node.data
        others = [f for f in around.frames if f not in {a, b}]
        yield from (changed(node, data=(name, f, b, *more)) for f in others)
        yield from (changed(node, data=(name, a, f, *more)) for f in others)


def _constant_vector(node: Term, _: Around) -> Iterator[Term]:
    """Take for constant, in a sum, what a derivative is of."""
    for k, part in enumerate(node.args if node.head == "add" else ()):
        if any(n.head == "der" for n in nodes(part)):
            yield rebuild(node, (*node.args[:k], *node.args[k + 1 :]))


def _point(node: Term, around: Around) -> Iterator[Term]:
    if node.head == "atom" and node.data[0] in _ABOUT:
        yield from (a for a in around.atoms if a.data[:-1] == node.data[:-1] and a != node)


def _transpose(node: Term, _: Around) -> Iterator[Term]:
    if node.head == "transpose":
        yield node.args[0]


# -- numbers and symbols -----------------------------------------------------------------------------

CONFUSED: dict[Expr, tuple[Expr, ...]] = {
    sp.Rational(a): tuple(sp.Rational(b) for b in row)
    for a, row in {
        "1/2": ("1", "1/4"), "1/4": ("1/2",), "1/3": ("1/2", "1/12"), "1/12": ("1/3",),
        "2/5": ("2/3", "1/2"), "2/3": ("2/5",), "2": ("1",), "3/2": ("1/2",),
    }.items()
}  # fmt: skip
"""Numbers that are taken for each other; any other fraction loses its denominator."""


def _factors(value: Expr) -> Iterator[Expr]:
    """Yield a number, or a product, in which another number stands."""
    number, rest = value.as_coeff_Mul()
    if number.is_Rational and abs(number) not in {0, 1}:
        for other in CONFUSED.get(abs(number), (sp.Integer(number.p),)):
            yield sp.sign(number) * other * rest


def _numbers(node: Term, _: Around) -> Iterator[Term]:
    if node.head == "mul" and node.args[0].head == "expr":
        for new in _factors(node.args[0].data[0]):
            yield rebuild(node, (expr(new), *node.args[1:]))


def _inside(rule: Callable[[Expr, Around], Iterator[Expr]]) -> Rule:
    """Return the rule that edits one place of a SymPy expression; its part is the summand around it."""

    def slipped(node: Term, around: Around) -> Iterator[tuple[Term, Term, Term]]:
        if node.head != "expr":
            return
        terms = node.data[0].as_ordered_terms()
        for k, term in enumerate(terms):
            for new in _everywhere(term, rule, around):
                value = sp.Add(*terms[:k], new, *terms[k + 1 :])
                yield expr(value), expr(term), expr(new)

    return slipped


def _everywhere(value: Expr, rule: Callable[[Expr, Around], Iterator[Expr]], around: Around) -> Any:
    """Yield an expression with one of its nodes changed."""
    yield from rule(value, around)
    for k, arg in enumerate(value.args):
        if not isinstance(arg, sp.Tuple):
            for new in _everywhere(arg, rule, around):
                yield value.func(*value.args[:k], new, *value.args[k + 1 :])


def _products(value: Expr, _: Around) -> Iterator[Expr]:
    if value.is_Mul:
        yield from _factors(value)


_INDEXED = re.compile(r"(.*?)(\d+)(\D*)\Z")


def _index(value: Expr, around: Around) -> Iterator[Expr]:
    if value.is_Symbol:
        yield from (s for s in around.symbols if s != value and _siblings(s.name, value.name))


def _siblings(a: str, b: str) -> bool:
    """Return whether two names differ in their number alone."""
    found = _INDEXED.match(a), _INDEXED.match(b)
    return all(found) and found[0].group(1, 3) == found[1].group(1, 3)  # type: ignore[union-attr]


def _lost_dot(value: Expr, around: Around) -> Iterator[Expr]:
    if value.is_Symbol and value.name.endswith("_dot"):
        plain = value.name.removesuffix("_dot")
        yield from (s for s in around.symbols if s.name == plain)


def _constant(value: Expr, around: Around) -> Iterator[Expr]:
    """Take for constant what has a rate: ``x_dot`` is zero where ``x`` stands, too."""
    if value.is_Symbol and value.name.endswith("_dot"):
        stem = value.name.removesuffix("_dot")
        if any(s.name == stem for s in around.symbols):
            yield sp.Integer(0)


def _functions_in_a_matrix(node: Term, _: Around) -> Iterator[Term]:
    """Exchange sine and cosine in all of a matrix that holds both."""
    if node.head != "entries" or any(a.head != "expr" for a in node.args):
        return
    values = [a.data[0] for a in node.args]
    found = {f.func for v in values for f in v.atoms(sp.sin, sp.cos)}
    if found == {sp.sin, sp.cos}:
        other = {sp.sin: sp.cos, sp.cos: sp.sin}
        new = (
            v.replace(lambda x: x.func in other, lambda x: other[x.func](*x.args)) for v in values
        )
        yield rebuild(node, map(expr, new))


def _functions(value: Expr, _: Around) -> Iterator[Expr]:
    other = {sp.sin: sp.cos, sp.cos: sp.sin}.get(value.func)
    if other is not None:
        yield other(*value.args)


def _square(value: Expr, _: Around) -> Iterator[Expr]:
    if value.is_Pow and value.exp == 2:
        yield value.base


# -- lines ------------------------------------------------------------------------------------------


def _conserved(line: Equation, around: Around) -> Iterator[tuple[Equation, Term, Term]]:
    """Claim that something else is constant: seen from another frame, another quantity, a part of it."""
    left = line.left
    if left.head != "der" or not line.right.is_zero:
        return
    (claimed,) = left.args
    frames = [f for f in around.frames if left.data not in {("",), (f,)}]
    new = [der(claimed, f) for f in frames]
    others = [a for a in around.atoms if a.kind == claimed.kind and a != claimed]
    new += [der(other, *left.data) for other in others if other.data[0] in CHANGES]
    new += [der(part, *left.data) for part in _parts(claimed)]
    new += [der(expr(s), *left.data) for s in _moving(claimed, around)]
    yield from ((Equation(n, line.right, line.relation), left, n) for n in new if n.head == "der")


def _moving(claimed: Term, around: Around) -> list[Expr]:
    """Return symbols with a rate and no second one, speeds, where a symbol is claimed to be constant."""
    if claimed.head != "expr" or not claimed.data[0].is_Symbol:
        return []
    names = {s.name for s in around.symbols}
    speeds = [
        s for s in around.symbols if f"{s.name}_dot" in names and f"{s.name}_ddot" not in names
    ]
    return [s for s in speeds if s != claimed.data[0]]


CHANGES = frozenset(
    {
        "angular_momentum",
        "angular_velocity",
        "linear_momentum",
        "rotational_energy",
        "kinetic_energy",
    }
)
"""What a line that claims a constant is about, by mistake or not."""


def _axes(line: Equation, around: Around) -> Iterator[tuple[Equation, Term, Term]]:
    """Apply the theorem of parallel axes from a point that is not the centre of mass."""
    yield from _axes_of_solids(line, around)
    if not any(n.head == "atom" and n.data[0] == "inertia" for n in nodes(line.left)):
        return
    for part in line.right.args if line.right.head == "add" else ():
        for n in nodes(part):
            if n.head != "atom" or n.data != ("inertia", "C"):
                continue
            for other in around.atoms:
                if other.data[0] == "inertia" and other != n and other not in nodes(line.left):
                    yield _with_part(line, n, other), n, other


def _with_part(line: Equation, old: Term, new: Term) -> Equation:
    return Equation(line.left, replace(line.right, lambda t: new if t == old else t), line.relation)


def _axes_of_solids(line: Equation, around: Around) -> Iterator[tuple[Equation, Term, Term]]:
    """The same where moments are symbols: ``I_1_apex`` is that about the apex, ``I_1`` the central one."""
    if line.left.head != "expr" or line.right.head != "expr":
        return
    about, total = line.left.data[0], line.right.data[0]
    if not (about.is_Symbol and total.is_Add):
        return
    for central in total.free_symbols & set(around.symbols):
        if not about.name.startswith(f"{central.name}_"):
            continue
        tails = [s for s in around.symbols if s.name.startswith(f"{central.name}_") and s != about]
        for other in tails:
            new = expr(total.xreplace({central: other}))
            yield Equation(line.left, new, line.relation), expr(central), expr(other)
        swapped = expr(total.xreplace({central: about}))
        yield Equation(expr(central), swapped, line.relation), line.left, expr(central)


LINE_SLIPS: tuple[Slip, ...] = (
    Slip("conserved", "what is claimed to be constant is not", _conserved),
    Slip("axes", "the theorem of parallel axes does not start at the centre of mass", _axes),
)
"""Kinds of slips that look at a whole line."""

SLIPS: tuple[Slip, ...] = (
    Slip("sign", "a sign is wrong", _signs),
    Slip("term", "a term was dropped", _dropped),
    Slip("order", "the factors of a product stand in the wrong order", whole(_order)),
    Slip("brackets", "the brackets of a double cross product stand wrong", whole(_brackets)),
    Slip("frame", "a derivative is taken in the wrong frame", whole(_frame_of_derivative)),
    Slip("omega", "the angular velocity is that of another frame", whole(_frame_of_omega)),
    Slip("rotations", "turns are multiplied in the wrong order", whole(_order_of_turns)),
    Slip("constant", "what changes is taken for constant", whole(_constant_vector)),
    Slip("constant", "what changes is taken for constant", _inside(_constant)),
    Slip("frames", "the two frames of a quantity are exchanged", whole(_frames_exchanged)),
    Slip("point", "a quantity is taken about the wrong point", whole(_point)),
    Slip("dot", "a dot or prime was lost", whole(_dot)),
    Slip("dot", "a dot or prime was lost", _inside(_lost_dot)),
    Slip("transpose", "a transpose was lost", whole(_transpose)),
    Slip("number", "a number as a factor is wrong", whole(_numbers)),
    Slip("number", "a number as a factor is wrong", _inside(_products)),
    Slip("index", "an index is wrong", _inside(_index)),
    Slip("function", "sine and cosine are exchanged", _inside(_functions)),
    Slip("function", "sine and cosine are exchanged", whole(_functions_in_a_matrix)),
    Slip("square", "a square was lost", _inside(_square)),
)  # fmt: skip
"""Every kind of slip; rows with one name are one kind."""


KINDS: dict[str, Kind] = {
    "sign": Kind(
        "easy",
        "Put in a simple case, one number other than zero, and look at which way it must go.",
    ),
    "term": Kind(
        "easy",
        "Count the terms of the line before, and find each of them again.",
    ),
    "number": Kind(
        "easy",
        "Follow the factor from where it comes in; a special case with known result tells it.",
    ),
    "square": Kind(
        "easy",
        "Units tell: every term of a line has the same.",
    ),
    "dot": Kind(
        "easy",
        "Units tell: a derivative has one 1/s more than what it is of.",
    ),
    "index": Kind(
        "easy",
        "Turn the indices around, 1, 2, 3, 1: the line must go over into the next of its kind.",
    ),
    "function": Kind(
        "easy",
        "Let the angle be zero: the matrix of no turn is the unit matrix, cosines stand on "
        "its diagonal.",
    ),
    "order": Kind(
        "medium",
        "Neither the cross product nor that of matrices may be turned round; the first "
        "changes its sign, the second its value.",
    ),
    "brackets": Kind(
        "medium",
        "a x (b x c) lies in the plane of b and c, (a x b) x c in that of a and b.",
    ),
    "transpose": Kind(
        "medium",
        "Write the frames at the matrix: neighbouring letters must be the same.",
    ),
    "frames": Kind(
        "medium",
        "Say it in words: of which frame, as seen from which. Turned round, the sign changes, "
        "or the matrix is transposed.",
    ),
    "point": Kind(
        "medium",
        "A moment is about a point; say which, and whether it is the same on both sides.",
    ),
    "constant": Kind(
        "medium",
        "Before a product is differentiated, say of each factor whether it changes; that the "
        "lecture forgot one is no excuse.",
    ),
    "frame": Kind(
        "hard",
        "A derivative belongs to an observer: what is fixed in B is constant for B, and turns "
        "for I. The transport theorem leads from one to the other.",
    ),
    "omega": Kind(
        "hard",
        "In the transport theorem omega is that of the frame in which the components stand, "
        "in momentum that of the body; the two may differ.",
    ),
    "rotations": Kind(
        "hard",
        "The first turn stands next to the vector, so on the right: C_CA = C_CB C_BA.",
    ),
    "axes": Kind(
        "hard",
        "The shift by m d^2 starts at the centre of mass; between two other points go by way "
        "of it.",
    ),
    "conserved": Kind(
        "hard",
        "Constant for whom? A vector that is constant in I turns in B; and a part of a "
        "constant need not be one.",
    ),
}
"""What a teacher knows of each kind of slips, by its name."""


def names() -> tuple[str, ...]:
    """Return the names of all kinds of slips, in the order of the table.

    >>> names()[:3]
    ('sign', 'term', 'order')
    """
    return tuple(dict.fromkeys(s.name for s in (*SLIPS, *LINE_SLIPS)))


def named(difficulty: str) -> frozenset[str]:
    """Return the names of the kinds of slips of a difficulty, of all where it is ""."""
    return frozenset(n for n in names() if difficulty in {"", KINDS[n].difficulty})


_PRODUCTS = frozenset({"matmul", "dot", "cross", "inner"})


def around(terms: Iterator[Term]) -> Around:
    """Return what slips in some terms may take from them, in the order of its first use."""
    found = list(dict.fromkeys(n for t in terms for n in nodes(t)))
    symbols = {s for n in found if n.head == "expr" for s in n.data[0].free_symbols}
    frames = [n.data[0] for n in found if n.head == "der" and n.data[0]]
    frames += [f for n in found if n.head == "atom" and n.data[0] in _TURNED for f in n.data[1:3]]
    atoms = (n for n in found if n.head == "atom")
    return Around(
        tuple(sorted(symbols, key=str)), tuple(dict.fromkeys(frames)), tuple(dict.fromkeys(atoms))
    )


def planted(equation: Equation, given: Around) -> Iterator[Planted]:
    """Yield an equation with one slip, in every way that gives another equation of its kind."""
    sides = (equation.left, equation.right)
    for k, side in enumerate(sides):
        if k == 0 and not (_parts(side) or side.head in _PRODUCTS):
            continue  # what a line is about stays what it is
        for path, node in _places(side):
            for slip in SLIPS:
                yield from _at(equation, k, path, node, slip, given)
    for slip in LINE_SLIPS:
        rule = cast("LineRule", slip.rule)
        for new, right, wrong in rule(equation, given):
            if {new.left, new.right} != set(sides):
                yield Planted(slip, right, wrong, new)


def _at(
    equation: Equation, side: int, path: Path, node: Term, slip: Slip, given: Around
) -> Iterator[Planted]:
    for new, right, wrong in cast("Rule", slip.rule)(node, given):
        sides = [equation.left, equation.right]
        try:
            made = _put(sides[side], path, new)
        except InputError:
            continue
        if made not in sides:
            sides[side] = made
            left, other = sides
            yield Planted(slip, right, wrong, Equation(left, other, equation.relation))


def _places(term: Term, path: Path = ()) -> Iterator[tuple[Path, Term]]:
    yield path, term
    for k, a in enumerate(term.args):
        yield from _places(a, (*path, k))


def _put(term: Term, path: Path, new: Term) -> Term:
    """Return a term with another node at a place. Raises `InputError` where it does not fit."""
    if not path:
        if new.kind != term.kind and not (new.is_zero and term.kind != SCALAR):
            raise InputError("another kind of term", got=new.kind, expected=term.kind)
        return new
    k, *rest = path
    args = (*term.args[:k], _put(term.args[k], tuple(rest), new), *term.args[k + 1 :])
    return rebuild(term, args)
