"""What closed forms and SymPy's mechanics take from a description; whatever else it says is refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import MISSING, fields
from typing import Any

from eom.errors import InputError
from eom.multibody.model.model import Body, Joint, Load, Placement, Tree

KNOWN: dict[type, frozenset[str]] = {
    Tree: frozenset({"name", "bodies", "joints", "gravity", "loads", "inputs", "parameters"}),
    Body: frozenset({"name", "mass", "centre", "inertia", "about", "axes"}),
    Joint: frozenset(
        {
            *("name", "kind", "parent", "child", "axis", "second_axis", "pitch", "attitude"),
            *("on_parent", "on_child", "stiffness", "rest", "damping", "armature", "force"),
            *("motor", "motion"),
        }
    ),
    Load: frozenset({"body", "force", "torque", "point", "axes"}),
    Placement: frozenset({"position", "rotation"}),
}
"""The fields that are used, by type."""


def refuse_unknown(tree: Tree, what: str) -> None:
    """Raise `InputError` if a tree says something that ``what`` would leave out in silence."""
    for part in _parts(tree):
        known = next(names for kind, names in KNOWN.items() if isinstance(part, kind))
        for f in fields(part):
            if f.name not in known and getattr(part, f.name) != _default(f):
                name = getattr(part, "name", "")
                raise InputError(
                    f"{what} cannot take {f.name.replace('_', ' ')} into account",
                    where=f"{type(part).__name__.lower()} {name!r}" if name else "",
                    hint="derive(tree) can",
                )


def _parts(tree: Tree) -> Iterator[Any]:
    yield tree
    yield from (*tree.bodies, *tree.joints, *tree.loads)
    for j in tree.joints:
        yield from (j.on_parent, j.on_child)


def _default(f: Any) -> Any:
    return f.default_factory() if f.default_factory is not MISSING else f.default
