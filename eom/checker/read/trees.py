"""Walking over syntax trees, without recursion: children, all nodes, changes, depth."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from typing import Any

from eom.checker.read.places import Span
from eom.checker.read.syntax import Node

_NAMES: dict[str, tuple[str, ...]] = {}


def _names(node: Node) -> tuple[str, ...]:
    """Return the fields of a kind of node; they are asked for often."""
    kind = type(node).__name__
    if kind not in _NAMES:
        _NAMES[kind] = tuple(f.name for f in fields(node) if f.name != "span")
    return _NAMES[kind]


def children(node: Node) -> tuple[Node, ...]:
    """Return the nodes directly below, in the order of the fields."""
    found: list[Node] = []
    for name in _names(node):
        _gather(getattr(node, name), found)
    return tuple(found)


def _gather(value: Any, found: list[Node]) -> None:
    if isinstance(value, Node):
        found.append(value)
    elif isinstance(value, tuple) and not isinstance(value, Span):
        for v in value:
            _gather(v, found)


def walk(node: Node) -> Iterator[Node]:
    """Yield every node, parents first."""
    stack = [node]
    while stack:
        node = stack.pop()
        yield node
        stack += reversed(children(node))


def depth(node: Node) -> int:
    """Return the number of nodes on the longest way down."""
    deepest, level = 0, [node]
    while level:
        deepest += 1
        level = [c for n in level for c in children(n)]
    return deepest


def transform(node: Node, rule: Callable[[Node], Node]) -> Node:
    """Apply ``rule`` to every node, children first; spans stay, and so does what does not change."""
    order = list(walk(node))
    done: dict[int, Node] = {}
    for n in reversed(order):
        done[id(n)] = rule(_rebuilt(n, done))
    return done[id(node)]


def _rebuilt(node: Node, done: dict[int, Node]) -> Node:
    """Return a node over its changed children."""
    old = {name: getattr(node, name) for name in _names(node)}
    new = {name: _changed(value, done) for name, value in old.items()}
    changed = {name: value for name, value in new.items() if value is not old[name]}
    return replace(node, **changed) if changed else node


def _changed(value: Any, done: dict[int, Node]) -> Any:
    """Return the same object where nothing changes."""
    if isinstance(value, Node):
        return done[id(value)]
    if isinstance(value, tuple):
        new = tuple(_changed(v, done) for v in value)
        return value if all(a is b for a, b in zip(new, value, strict=True)) else new
    return value
