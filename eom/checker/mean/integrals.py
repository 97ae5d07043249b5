"""Integrals of notes: definite ones by rules, over elements of a body, over time; sums over elements."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy as sp
from sympy.simplify.fu import TR8

from eom.checker.mean import instants
from eom.checker.mean.calculus import VOLUME
from eom.checker.mean.dimensions import LENGTH, MASS, product
from eom.checker.mean.elaborator import Elaborator, number
from eom.checker.mean.indices import indices_of
from eom.checker.mean.lexicon import Entry, Meaning
from eom.checker.mean.values import (
    ILL_FORMED,
    UNDECIDED,
    Value,
    negative,
    refuse,
    total,
)
from eom.checker.read.spans import Span
from eom.checker.read.symbol_shape import Look, labels, seen
from eom.checker.read.syntax import (
    BigOperator,
    Group,
    Integral,
    Number,
    Product,
    Scripts,
    Sequence,
    Symbol,
    walk,
)
from eom.terms import terms
from eom.terms.terms import INDICES, SCALAR, Term, dot, expr, nodes
from eom.terms.vocabulary import mass, position, unit

Expr = Any

MAX_POWER = 12
MAX_TERMS = 60
STEADY = frozenset({"scalar", "mass", "total_mass"})
"""Quantities that do not depend on a coordinate."""
_STEPS = {sp.sin: lambda a: -sp.cos(a), sp.cos: sp.sin, sp.exp: sp.exp}
"""Primitives of functions of x itself."""
_DENSITIES = ("rho", "varrho")


class Unknown(Exception):
    """No rule gives the integral."""


def definite(e: Elaborator, node: Integral) -> Value:
    """Return an integral of free scalars over a coordinate between two limits. Raises `Refusal`."""
    look = _variable(e, node)
    lower, upper = (e.value(n) for n in _limits(node))
    if {lower.shape, upper.shape} != {SCALAR}:
        raise refuse(ILL_FORMED, "limits of an integral are scalars", node.span)
    x = sp.Dummy(look.text, real=True)
    measure = lower.dimension if upper.is_zero else upper.dimension
    own = Value(expr(x), SCALAR, measure)
    shadow = (Entry(look, Meaning("defined"), look.text),)
    inner = replace(
        e,
        lexicon=replace(e.lexicon, layers=(shadow, *e.lexicon.layers)),
        definitions={**e.definitions, look: own},
    )
    inside = (
        number(sp.Integer(1), node.span) if node.integrand is None else inner.value(node.integrand)
    )
    if inside.shape != SCALAR or inside.density or not _steady(inner, inside.term):
        what = "an integrand that is no function of free scalars and its variable"
        raise refuse(UNDECIDED, what, node.span)
    a, b = e.expression(lower.term), e.expression(upper.term)
    try:
        found = between(e.expression(inside.term), x, a, b)
    except Unknown:
        raise refuse(UNDECIDED, "no rule for this integral", node.span) from None
    return Value(expr(found), SCALAR, product(inside.dimension, measure), span=node.span)


def _limits(node: Integral) -> tuple[Any, Any]:
    if node.lower is None or node.upper is None:
        raise refuse(UNDECIDED, "an integral without its limits", node.span)
    return node.lower, node.upper


def _variable(e: Elaborator, node: Integral) -> Look:
    """Return the variable, one letter; in limits, as outside of the integral, it is what it is there."""
    given = seen(node.variables[0]) if len(node.variables) == 1 else None
    if given is None or given.dots or given.raised or given.look.accents:
        raise refuse(UNDECIDED, "not an integral over a coordinate", node.span)
    entry = e.lexicon.find(given.look)
    if entry is not None and entry.meaning.quantity == "time":
        raise refuse(UNDECIDED, "the variable has a meaning outside of the integral", node.span)
    if node.integrand is not None and called(node.integrand):
        raise refuse(UNDECIDED, "a function under an integral", node.integrand.span)
    return given.look


def called(tree: Any) -> bool:
    """Return whether a symbol is followed by letters alone in brackets, as a function is: f(x), f(x, y)."""
    for node in walk(tree):
        if isinstance(node, Product) and not node.operator:
            for one, following in zip(node.factors, node.factors[1:], strict=False):
                inside = following.body if isinstance(following, Group) else None
                if isinstance(inside, Symbol | Sequence) and seen(one) is not None:
                    return True
    return False


def _steady(e: Elaborator, term: Term) -> bool:
    """Return whether a term is made of variables of integrals and of what does not depend on it."""
    free = {s for s in e.expression(term).free_symbols if not isinstance(s, sp.Dummy)}
    meanings = [e.scalars[s] for s in free if s in e.scalars]
    atoms = [n for t in (term, *meanings) for n in nodes(t) if n.head != "expr"]
    known = all(n.head in {"add", "mul"} or _constant(e, n) for n in atoms)
    return known and len(meanings) == len(free)


def _constant(e: Elaborator, atom: Term) -> bool:
    """Tell whether a quantity is no function of place or time: of a system, whether it is a parameter."""
    model = e.lexicon.system
    if atom.data[:1] == ("system",) and model is not None:
        return atom.data[1] in {q.name for q in model.system.parameters} or not model.system.states
    return atom.data[:1] in {(q,) for q in STEADY}


def between(integrand: Expr, x: Expr, lower: Expr, upper: Expr) -> Expr:
    """Return the integral of an expression from one limit to another. Raises `Unknown`."""
    parts = sp.Add.make_args(sp.expand(integrand))
    if len(parts) > MAX_TERMS:
        raise Unknown
    found = [c * _between(p, x, lower, upper) for c, p in (t.as_independent(x) for t in parts)]
    return sp.expand(sp.Add(*found))


def _between(part: Expr, x: Expr, lower: Expr, upper: Expr) -> Expr:
    if part == 1 / x and 0 not in (lower, upper):
        ratio = upper / lower
        if ratio.is_number and not ratio > 0:
            raise Unknown
        return sp.log(ratio)
    primitive = _primitive(part, x)
    if primitive.has(1 / x) or any(p.base == x and p.exp < 0 for p in primitive.atoms(sp.Pow)):
        if 0 in (lower, upper):
            raise Unknown
        if (upper / lower).is_number and upper / lower < 0:
            raise Unknown
    return primitive.xreplace({x: upper}) - primitive.xreplace({x: lower})


def _primitive(part: Expr, x: Expr) -> Expr:
    """Return a primitive of a product of powers of x and functions of what is linear in x."""
    power, rest = sp.Integer(0), []
    for factor in sp.Mul.make_args(part):
        base, exponent = factor.as_base_exp()
        if base == x and exponent.is_Rational and abs(exponent) <= MAX_POWER:
            power += exponent
        elif factor != 1:
            rest.append(factor)
    if not rest:
        if power == -1:
            raise Unknown
        return x ** (power + 1) / (power + 1)
    if not power.is_Integer or power < 0:
        raise Unknown
    return sp.Add(*(_by_parts(int(power), t, x) for t in _linear(sp.Mul(*rest))))


def _linear(product: Expr) -> tuple[Expr, ...]:
    """Return a product of sines and cosines as a sum of single ones; an exponential stays."""
    if isinstance(product, sp.exp):
        return (product,)
    count = sum(
        int(f.as_base_exp()[1]) if f.as_base_exp()[1].is_Integer else MAX_POWER + 1
        for f in sp.Mul.make_args(product)
    )
    functions = {f.as_base_exp()[0].func for f in sp.Mul.make_args(product)}
    if not functions <= {sp.sin, sp.cos} or not 0 < count <= MAX_POWER:
        raise Unknown
    return tuple(sp.Add.make_args(sp.expand(TR8(product))))


def _by_parts(power: int, term: Expr, x: Expr) -> Expr:
    """Return a primitive of x^n f(k x + c) by parts; of a power alone where f has no x."""
    scale, function = term.as_independent(x)
    if function == 1:
        return scale * x ** (power + 1) / (power + 1)
    argument = function.args[0] if type(function) in _STEPS else x**2
    slope = sp.diff(argument, x)
    if slope.has(x):
        raise Unknown
    found, factor, now = sp.Integer(0), scale * x**power, function
    for _ in range(power + 1):
        now = now.as_independent(x)[0] * _step(now, x) / slope
        found += factor * now
        factor = -sp.diff(factor, x)
    return found


def _step(now: Expr, x: Expr) -> Expr:
    function = now.as_independent(x)[1]
    return _STEPS[type(function)](function.args[0])


def element(e: Elaborator, by_volume: bool) -> Elaborator:
    r"""Return an elaborator that knows x, y, z, r of an element and its density \rho.

    They are coordinates along b1, b2, b3, and the distance, from the point that the lexicon measures
    elements from, else from O. What the lexicon or the note knows otherwise stays.
    """
    place = position("dm", _origin(e))
    axes = {n: dot(unit("B", k), place) for k, n in enumerate("xyz", 1)}
    own = {Look(n): Value(expr(e.name(n, t)), SCALAR, LENGTH) for n, t in axes.items()}
    size = sp.sqrt(e.name("r^2", dot(place, place)))
    own[Look("r")] = Value(expr(size), SCALAR, LENGTH)
    if by_volume:
        density = MASS.times(LENGTH.power(-3))
        own |= {Look(n): Value(mass("dm"), SCALAR, density, density=1) for n in _DENSITIES}
    return replace(e, definitions={**own, **e.definitions})


def _origin(e: Elaborator) -> str:
    entries = (entry.meaning for layer in e.lexicon.layers for entry in layer)
    found = {m.labels[1] for m in entries if m.quantity == "position" and m.labels[0] == "dm"}
    return found.pop() if len(found) == 1 else "O"


def big_operator(e: Elaborator, node: BigOperator) -> Value:
    """Return a sum over all particles, over all but one, or over numbers from 1 to 3."""
    if node.sign != "sum":
        raise refuse(UNDECIDED, "an operator without a meaning", node.span, node.sign)
    indices, excluded = indices_of(node)
    if isinstance(node.upper, Number):
        return _numbered(e, node, indices)
    names = _counted(e, node, indices)
    free = e.bound(**dict(zip(indices, names, strict=True)))
    inside = free.value(node.body)
    value = _summed(inside, names, node.span)
    if not excluded:
        return value
    left_out = e.bound(**{indices[0]: excluded}).value(node.body)
    return total(e.lexicon.notation, (value, negative(left_out, node.span)))


def _counted(e: Elaborator, node: BigOperator, indices: tuple[str, ...]) -> tuple[str, ...]:
    """Return the indices of terms for those of a sum: a letter that is none stands for one that is free."""
    below = {w for n in walk(node.body) if isinstance(n, Scripts) and n.sub for w in labels(n.sub)}
    free = [n for n in ("l", "n", "j", "i") if n not in {*below, *indices, *e.indices.values()}]
    names = []
    for index in indices:
        known = index in INDICES - {"dm"}
        if not known and (index not in below or not free):
            raise refuse(UNDECIDED, "not an index of particles", node.span, index, "i, j, k, l, n")
        names.append(index if known else free.pop(0))
    return tuple(names)


def _summed(value: Value, indices: tuple[str, ...], span: Span) -> Value:
    term = value.term
    for index in reversed(indices):
        over = "rotors" if index == "k" else "particles"
        term = terms.total(term, index, over)
    return replace(value, term=term, span=span)


def _numbered(e: Elaborator, node: BigOperator, indices: tuple[str, ...]) -> Value:
    upper = node.upper.text if isinstance(node.upper, Number) else ""
    if upper not in {"1", "2", "3"} or len(indices) != 1:
        raise refuse(UNDECIDED, "a sum up to more than 3", node.span, upper)
    count = range(1, int(upper) + 1)
    values = [e.bound(**{indices[0]: str(k)}).value(node.body) for k in count]
    return total(e.lexicon.notation, values)


def integral_value(e: Elaborator, node: Integral) -> Value:
    """Return an integral over the body, over its mass or its volume, or over a coordinate."""
    over = tuple(labels(v) for v in node.variables)
    if instants.over_time(e, node):
        return instants.integral(e, node)
    if node.upper is not None:
        return definite(e, node)
    if over not in {(("m",),), (("V",),)}:
        got = " ".join("d" + "".join(v) for v in over)
        raise refuse(UNDECIDED, "not an integral over a body", node.span, got, "dm or dV")
    one = number(sp.Integer(1), node.span)
    by_volume = over == (("V",),)
    inside = one if node.integrand is None else element(e, by_volume).value(node.integrand)
    if inside.density != int(by_volume):
        what = "a density is" + (
            " missing under this integral" if by_volume else " integrated over mass"
        )
        raise refuse(UNDECIDED, what, node.span)
    term = terms.total(inside.term, "dm", "elements") if by_volume else terms.integral(inside.term)
    weight = VOLUME if by_volume else MASS
    dimension = product(inside.dimension, weight)
    return replace(inside, term=term, dimension=dimension, density=0, span=node.span)
