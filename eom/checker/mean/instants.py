r"""Two instants of a motion: values at them, integrals over the time between, changes.

What an equation says of two instants it says of any two. So the earlier one is where integrals start, the
later one is now: ``T(t_2)`` is T, ``T(t_1)`` its value at the start, and an integral from ``t_1`` to
``t_2`` is what `eom.terms.terms.since` says; along a path, ``\vec F\cdot d\vec r``, it is that of
``\vec F\cdot\dot{\vec r}``. A symbol with an instant below it is what the symbol alone is, then.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace

import sympy as sp

from eom.checker.mean.dimensions import TIME, product
from eom.checker.mean.elaborator import Elaborator, number
from eom.checker.mean.values import (
    ILL_FORMED,
    UNDECIDED,
    Refusal,
    Value,
    dotted,
    negative,
    overdot,
    refuse,
    scalar,
    total,
)
from eom.checker.read.spans import Span
from eom.checker.read.symbol_shape import Look, Seen, labels, seen
from eom.checker.read.syntax import (
    Addition,
    Derivative,
    Group,
    Integral,
    Marks,
    Node,
    Number,
    Product,
    Scripts,
    Section,
    children,
)
from eom.terms.terms import VECTOR, expr, since, start
from eom.terms.terms import at as when
from eom.terms.vocabulary import quantity

START, NOW = "start", "now"
EARLY = frozenset({"0", "1", "i", "a", "A", "s"})
"""Labels of the first of two instants; all others are of the second."""
MOTION = "t@"
"""How the label of the time of an instant of a particular motion begins."""
TIMES = frozenset({"t", "tau"})
"""Letters of variables over which an integral is one over time."""


def key(e: Elaborator, node: Node) -> str:
    """Return by what an instant is known: the label below t, else "t"; "" for what is none."""
    if isinstance(node, Group) and node.open in {"", "("}:
        return key(e, node.body)
    if isinstance(node, Number):
        return "0" if node.text == "0" else ""
    if isinstance(node, Addition):
        return "".join(labels(node)) if key(e, node.terms[0]) and not node.signs[0] else ""
    found = seen(node)
    if found is None or found.dots or found.look.accents or not _unraised(found):
        return ""
    bare = _letter(found)
    if bare == e.running and not found.look.sub:
        return bare
    entry = e.lexicon.find(found.look, e.indices) if found.look.name == "t" else None
    timely = entry is None or entry.meaning.quantity == "time" or entry.meaning.unit == "s"
    if found.look.name != "t" or found.look.style or not timely:
        return ""
    return "".join(found.look.sub) or bare


def _unraised(found: Seen) -> bool:
    """Return whether nothing but primes is raised: the square of a time is no instant."""
    return all(isinstance(n, Marks) for n in found.raised)


def _letter(found: Seen) -> str:
    """Return a letter with its primes."""
    return found.look.name + "'" * sum(len(n.names) for n in found.raised if isinstance(n, Marks))


def role(e: Elaborator, name: str, span: Span) -> str:
    """Return which of the two an instant is, under an integral the variable of that or the first.

    Raises `Refusal` where there are more than two.
    """
    if name == e.running:
        return NOW
    wanted = START if name in EARLY else NOW
    for one in (wanted, START if wanted == NOW else NOW):
        if e.times.setdefault(one, name) == name:
            if one == NOW and e.running:
                break
            return one
    raise refuse(UNDECIDED, "more than two instants", span, name)


def at(e: Elaborator, value: Value, node: Node) -> Value | None:
    """Return the value of what depends on time at an instant; None for an argument that is none."""
    name = key(e, node)
    if not name:
        return None
    if isinstance(node, Number) and _is_coordinate(e):
        raise refuse(UNDECIDED, "t is a coordinate: it need not be zero at the start", node.span)
    given = seen(node)
    entry = e.lexicon.find(given.look, e.indices) if given is not None else None
    label = "".join(entry.meaning.labels) if entry is not None else ""
    if label.startswith(MOTION):
        return replace(value, term=when(value.term, label))
    if name == "t" and "t" not in e.times.values():
        return value
    return _at(value, role(e, name, node.span))


def _at(value: Value, one: str) -> Value:
    return replace(value, term=start(value.term)) if one == START else value


def note(e: Elaborator, nodes: Iterable[Node]) -> None:
    """Take down the instants that limits of integrals and symbols name, those of limits first."""
    parts = [n for tree in nodes for n in _parts(tree)]
    with suppress(Refusal):
        for one in (n for n in parts if isinstance(n, Integral) and over_time(e, n)):
            _limits(e, one)
        for node in (n for n in parts if seen(n) is not None):
            name = key(e, node)
            if name not in {"", "t"}:
                role(e, name, node.span)


def _parts(tree: Node) -> Iterator[Node]:
    """Yield the nodes of a tree, symbols whole, without what derivatives and integrals are made of."""
    stack = [tree]
    while stack:
        node = stack.pop()
        yield node
        if seen(node) is None and not isinstance(node, Integral | Derivative):
            stack += children(node)


# -- integrals -----------------------------------------------------------------------------------------


def over_time(e: Elaborator, node: Integral) -> bool:
    """Return whether an integral with limits is over time, or along a path between two instants."""
    if node.lower is None or not timely(node):
        return False
    found = seen(node.variables[0])
    entry = e.lexicon.find(found.look, e.indices) if found is not None else None
    return along(node) or entry is None or entry.meaning.quantity in {"time", "scalar"}


def timely(node: Integral) -> bool:
    """Return whether an integral with limits is written as one over time or along a path."""
    found = seen(node.variables[0]) if len(node.variables) == 1 else None
    letter = found is not None and found.look.name in TIMES and not found.look.style
    return node.upper is not None and found is not None and (letter or along(node))


def along(node: Integral) -> bool:
    """Return whether an integral is along a path: of a force times the step of a place."""
    return isinstance(node.integrand, Section) and node.integrand.operator == "dot"


def _limits(e: Elaborator, node: Integral) -> tuple[str, str]:
    assert node.lower is not None
    assert node.upper is not None
    lower, upper = (_limit(e, n, node) for n in (node.lower, node.upper))
    return lower, upper


def _limit(e: Elaborator, node: Node, whole: Integral) -> str:
    """Return which instant a limit is; along a path it may be a place, known by its label."""
    found = seen(node)
    name = key(e, node)
    if not name and along(whole):
        below = found.look.sub if found is not None else ()
        name = "".join(below or labels(node))
    if not name:
        raise refuse(UNDECIDED, "a limit of an integral that is no instant", whole.span)
    return role(e, name, node.span)


def integral(e: Elaborator, node: Integral) -> Value:
    """Return an integral over time, of anything."""
    lower, upper = _limits(e, node)
    if lower == upper:
        raise refuse(ILL_FORMED, "an integral without an interval", node.span)
    inside = _along(e, node) if along(node) else _integrand(e, node)
    if inside.density:
        raise refuse(UNDECIDED, "a density under an integral over time", node.span)
    dimension = product(inside.dimension, TIME)
    value = replace(inside, term=since(inside.term), dimension=dimension, span=node.span)
    return negative(value, node.span) if lower == NOW else value


def _integrand(e: Elaborator, node: Integral) -> Value:
    found = seen(node.variables[0])
    if node.integrand is None or found is None:
        return number(sp.Integer(1), node.span)
    return replace(e, running=_letter(found)).value(node.integrand)


def _along(e: Elaborator, node: Integral) -> Value:
    force, place = e.value(node.integrand.operand), e.value(node.variables[0])  # type: ignore[union-attr]
    if {force.shape, place.shape} != {VECTOR}:
        raise refuse(ILL_FORMED, "an integral along a path is of vectors", node.span)
    notation = e.lexicon.notation
    return dotted(notation, force, overdot(notation, place, 1, node.span))


# -- changes -------------------------------------------------------------------------------------------


def change(e: Elaborator, node: Node, span: Span) -> Value:
    r"""Return by how much something grows between the two instants: ``\Delta T``."""
    value = e.value(node)
    first = replace(value, term=start(value.term))
    return replace(total(e.lexicon.notation, (value, negative(first, span))), span=span)


def between(e: Elaborator, value: Value, lower: Node, upper: Node, span: Span) -> Value | None:
    """Return what stands before a bar with two instants: the value at the upper less that at the lower."""
    if not key(e, lower) or not key(e, upper):
        return None
    first, last = (_at(value, role(e, key(e, n), n.span)) for n in (lower, upper))
    return replace(total(e.lexicon.notation, (last, negative(first, span))), span=span)


def time(e: Elaborator, node: Node) -> Value | None:
    """Return an instant itself as a number of seconds; None for what is none.

    None, too, where t is a coordinate of the note: then t_0 is its value at the start, as of any other.
    """
    name = key(e, node)
    if not name or isinstance(node, Number) or _is_coordinate(e):
        return None
    one = role(e, name, node.span)
    begin = e.times.setdefault(START, "0")
    first = number(sp.Integer(0), node.span)
    if begin != "0":
        first = scalar(start(quantity("coordinate", f"t_{begin}")), TIME, node.span)
    if one == START:
        return replace(first, dimension=TIME)
    passed = scalar(since(expr(sp.Integer(1))), TIME, node.span)
    return replace(total(e.lexicon.notation, (first, passed)), dimension=TIME)


def _is_coordinate(e: Elaborator) -> bool:
    """Return whether t is a coordinate of the note, which need not be zero at the start."""
    entry = e.lexicon.find(Look("t"))
    return entry is not None and entry.meaning.quantity == "coordinate"


def below(e: Elaborator, node: Node) -> Value | None:
    """Return the value at an instant of what has it as its last label, where the statement names it."""
    if not isinstance(node, Scripts) or node.sub is None:
        return None
    *before, last = node.sub.factors if isinstance(node.sub, Product) else (node.sub,)
    name = "".join(labels(last))
    if name not in e.times.values():
        return None
    left = Product(tuple(before), span=node.sub.span) if len(before) > 1 else None
    sub = left or (before[0] if before else None)
    bare = replace(node, sub=sub) if sub or node.sup or node.presup else node.base
    return replace(_at(e.value(bare), role(e, name, node.span)), span=node.span)
