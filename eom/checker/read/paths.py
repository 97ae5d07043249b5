"""Places within a syntax tree as paths, and trees with a node replaced, left out or added."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from typing import Any

from eom.checker.read.symbol_shape import seen
from eom.checker.read.syntax import Addition, Missing, Node, Number, Product

Step = tuple[str, tuple[int, ...]]
Path = tuple[Step, ...]
"""From the root: the name of a field and the places within its tuples."""

_VALUES: dict[str, tuple[str, ...]] = {
    "Addition": ("terms",),
    "Product": ("factors",),
    "Quotient": ("left", "right"),
    "Fraction": ("above", "below"),
    "Call": ("argument",),
    "Integral": ("integrand",),
    "Matrix": ("rows",),
    **dict.fromkeys(("Section", "Derivative"), ("operand",)),
    **dict.fromkeys(("Accent", "Scripts", "Over"), ("base",)),
    **dict.fromkeys(("Root", "BigOperator", "Group", "Boxed", "Braced", "Struck"), ("body",)),
}
"""Fields that hold what is added and multiplied, by kind of node; labels are none of them."""


def operands(node: Node) -> Iterator[tuple[Step, Node]]:
    """Yield the operands of a node with the steps to them; a symbol with its accents has none."""
    if seen(node) is not None:
        return
    for name in _VALUES.get(type(node).__name__, ()):
        yield from _each(name, (), getattr(node, name))


def _each(name: str, numbers: tuple[int, ...], value: Any) -> Iterator[tuple[Step, Node]]:
    if isinstance(value, Node):
        yield (name, numbers), value
    elif isinstance(value, tuple):
        for k, part in enumerate(value):
            yield from _each(name, (*numbers, k), part)


def places(node: Node) -> Iterator[tuple[Path, Node]]:
    """Yield every operand below a node, and the node itself first, with its path."""
    stack: list[tuple[Path, Node]] = [((), node)]
    while stack:
        path, here = stack.pop()
        yield path, here
        stack += [((*path, step), below) for step, below in reversed(list(operands(here)))]


def at(node: Node, path: Path) -> Node:
    """Return the node at the end of a path."""
    value: Any = node
    for name, numbers in path:
        value = getattr(value, name)
        for k in numbers:
            value = value[k]
    found: Node = value
    return found


def put(node: Node, path: Path, new: Node) -> Node:
    """Return a tree with another node at the end of a path, tidied on the way."""
    return _put(node, path, new, tidy)


def set_down(node: Node, path: Path, new: Node) -> Node:
    """Return a tree with another node at the end of a path; all other paths stay as they are."""
    return _put(node, path, new, lambda n: n)


def _put(node: Node, path: Path, new: Node, finish: Callable[[Node], Node]) -> Node:
    if not path:
        return finish(new)
    (name, numbers), rest = path[0], path[1:]
    field = _within(getattr(node, name), numbers, lambda n: _put(n, rest, new, finish))
    return finish(replace(node, **{name: field}))


def _within(value: Any, numbers: tuple[int, ...], change: Callable[[Any], Any]) -> Any:
    if not numbers:
        return change(value)
    k = numbers[0]
    return (*value[:k], _within(value[k], numbers[1:], change), *value[k + 1 :])


def find(root: Node, wanted: Node) -> Path | None:
    """Return the path to a node, the very object, through all fields; None where it is not."""
    stack: list[tuple[Path, Node]] = [((), root)]
    while stack:
        path, here = stack.pop()
        if here is wanted:
            return path
        for name in (f.name for f in fields(here) if f.name != "span"):
            stack += [((*path, step), n) for step, n in _each(name, (), getattr(here, name))]
    return None


def common(paths: list[Path]) -> Path:
    """Return the longest path that all begin with."""
    first, last = min(paths), max(paths)
    k = 0
    while k < min(len(first), len(last)) and first[k] == last[k]:
        k += 1
    return first[:k]


# -- tidying -------------------------------------------------------------------------------------

NOTHING = Missing()
"""Stands where a term or factor is left out; it goes when it is put into a tree."""


def tidy(node: Node) -> Node:
    """Leave out what stands for nothing, double signs and plain products within one another."""
    if isinstance(node, Addition):
        return _tidy_sum(node)
    if isinstance(node, Product):
        return _tidy_product(node)
    return node


def _tidy_sum(node: Addition) -> Node:
    pairs: list[tuple[str, Node]] = []
    for sign, term in zip(node.signs, node.terms, strict=True):
        single = isinstance(term, Addition) and sign in {"", "+"} and len(term.terms) == 1
        if single and isinstance(term, Addition):
            pairs.append((term.signs[0] or sign, term.terms[0]))
        elif not isinstance(term, Missing):
            pairs.append((sign, term))
    if not pairs:
        return Number("0", span=node.span)
    if pairs[0][0] == "+":
        pairs[0] = ("", pairs[0][1])
    if len(pairs) == 1 and not pairs[0][0]:
        return pairs[0][1]
    signs, terms = zip(*pairs, strict=True)
    return (
        node
        if terms == node.terms and signs == node.signs
        else replace(node, terms=terms, signs=signs)
    )


def _tidy_product(node: Product) -> Node:
    kept: list[Node] = []
    for factor in node.factors:
        nested = isinstance(factor, Product) and not factor.operator and not node.operator
        kept += factor.factors if nested and isinstance(factor, Product) else (factor,)
    kept = [f for f in kept if not isinstance(f, Missing)]
    if not kept:
        return NOTHING
    if len(kept) == 1:
        return kept[0]
    return node if tuple(kept) == node.factors else replace(node, factors=tuple(kept))


def disjoint(a: Path, b: Path) -> bool:
    """Return whether neither of two places lies within the other."""
    n = min(len(a), len(b))
    return a[:n] != b[:n]
