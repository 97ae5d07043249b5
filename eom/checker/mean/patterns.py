"""Patterns of a lexicon: LaTeX of one symbol with its labels, slots in angle brackets."""

from __future__ import annotations

from dataclasses import replace

from eom.checker.mean.meanings import SLOT
from eom.checker.read.grammar import read_formula
from eom.checker.read.looks import Labels, Look, labels, seen
from eom.checker.read.syntax import Group, Node, Product, Scripts
from eom.errors import InputError

_SLOTS = frozenset("FGPQijkl")


def slotted(latex: str, where: str) -> str:
    """Write slots as letters that no formula has."""
    unknown = [s for s in SLOT.findall(latex) if s not in _SLOTS]
    if unknown:
        raise InputError(
            "unknown slot",
            where=where,
            got=f"<{unknown[0]}>",
            expected="<F> <G> <P> <Q> <i> <j> <k> <l>",
        )
    return SLOT.sub(lambda m: rf"\mathtt{{{m[1]}}}", latex)


def look_of(latex: str, where: str = "") -> Look:
    """Return the look of a pattern. Raises `InputError` for what is not one symbol."""
    tree = read_formula(slotted(latex, where)).tree
    called = _is_call(tree)
    found = seen(tree.factors[0] if isinstance(tree, Product) and called else tree)
    if found is None or found.dots or len(found.raised) > 1:
        raise InputError(
            "a pattern is one symbol with its labels, without dots",
            where=where,
            got=latex,
            hint="the body of a formula that stands for something else goes into equals",
        )
    return replace(found.with_label() or found.look, called=called)


def _is_call(tree: Node) -> bool:
    """Whether this is a function with its argument: f(r)."""
    if not isinstance(tree, Product) or tree.operator or len(tree.factors) != 2:
        return False
    last = tree.factors[1]
    return isinstance(last, Group) and last.open == "("


def label_of(latex: str, where: str = "") -> Labels:
    """Return the words of a label. Raises `InputError` for what cannot be one."""
    tree = read_formula(f"x_{{{latex}}}").tree
    found = labels(tree.sub) if isinstance(tree, Scripts) else ()
    if not found:
        raise InputError("not a label", where=where, got=latex)
    return found
