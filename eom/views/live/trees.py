"""A scene of many bodies as a live page needs it: gravity, springs and dampers can be left out.

Each choice is a tree of its own that is derived anew, so that what a zero makes superfluous is gone
from the equations. The bodies are drawn from four points of each; their shapes follow from mass and
inertia.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import product
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.multibody.algebra.values import is_number
from eom.multibody.files.scene import TreeScene
from eom.multibody.model.model import Tree
from eom.multibody.recursion.operation_count import savings
from eom.multibody.recursion.quantities import Point
from eom.multibody.system.derive import derive
from eom.quantities import Definition, Quantity
from eom.scenes.reduce import cost
from eom.system import System, as_expression
from eom.views.live.subject import VIEW, Knob, Subject, Switch, Variant, knob, of_states

Expr = Any

GRAVITY, SPRINGS, DAMPING = "gravity", "springs", "damping"
WORDS = {GRAVITY: "no gravity", SPRINGS: "no springs", DAMPING: "no damping"}
TIPS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
"""The points of each body that say where it is and how it is turned: its origin, ends of its axes."""


def subject(scene: TreeScene) -> Subject:
    """Return what a page about a tree needs. Raises `InputError` for a tree under constraints."""
    tree = scene.tree
    if tree.constraints:
        raise InputError(
            "a live page holds no constraints: a change of a number needs consistent values anew",
            where=scene.name,
            got=", ".join(c.name for c in tree.constraints),
            hint="eom animate shows its motion with the scene's numbers",
        )
    switches = tuple(_switches(tree))
    variants = {
        choice: _variant(scene, dict(zip((s.name for s in switches), choice, strict=True)))
        for choice in product((False, True), repeat=len(switches))
    }
    return Subject(
        kind="tree",
        name=scene.name,
        title=scene.title or scene.name,
        description=scene.description,
        knobs=tuple(_knobs(scene)),
        switches=switches,
        variants=variants,
        fixed=_fixed(scene),
        bodies=tuple(b.name for b in tree.bodies),
        joints=tuple(len(_joints_on(tree, b.name)) for b in tree.bodies),
        up=_up(scene),
    )


# -- what can be left out -----------------------------------------------------------------------------

Edit = dict[str, Any]


def _without_gravity(tree: Tree) -> Tree:
    return replace(tree, gravity=(0, 0, 0))


def _without_springs(tree: Tree) -> Tree:
    joints = tuple(replace(j, stiffness=0) for j in tree.joints)
    springs = tuple(replace(s, stiffness=0) for s in tree.springs)
    return replace(tree, joints=joints, springs=springs)


def _without_damping(tree: Tree) -> Tree:
    return replace(
        tree,
        joints=tuple(replace(j, damping=0) for j in tree.joints),
        springs=tuple(replace(s, damping=0) for s in tree.springs),
        rotors=tuple(replace(r, damping=0) for r in tree.rotors),
    )


EDITS = {GRAVITY: _without_gravity, SPRINGS: _without_springs, DAMPING: _without_damping}


def _switches(tree: Tree) -> Iterator[Switch]:
    """Yield a switch for everything whose absence changes the tree."""
    for name, edit in EDITS.items():
        if edit(tree) != tree:
            yield Switch(name, WORDS[name], False)


def _variant(scene: TreeScene, off: Mapping[str, bool]) -> Variant:
    tree = scene.tree
    for name, is_off in off.items():
        tree = EDITS[name](tree) if is_off else tree
    points = [
        Point(f"{VIEW}{k}_{n}", b.name, tip, ("position",))
        for k, b in enumerate(tree.bodies)
        for n, tip in enumerate(TIPS)
    ]
    own, moving = (
        replace(derive(tree, asked), name=scene.name, title=scene.title) for asked in ((), points)
    )
    drawn = _with_shapes(moving, scene, tree)
    saved = savings(tree)
    return Variant(own, drawn, tuple(saved.reasons), saved.without, cost(own))


def _with_shapes(system: System, scene: TreeScene, tree: Tree) -> System:
    """Return a system whose outputs give, after the points, mass, centre, inertia, joints of each body."""
    known = set(system.parameter_names)
    numbers = {
        s: sp.Float(scene.numbers[s.name])
        for value in _shape_values(tree)
        for s in value.free_symbols
        if s.name not in known and s.name in scene.numbers
    }
    shapes = tuple(
        Definition(Quantity(sp.Symbol(f"{VIEW}shape_{k}", real=True)), value.xreplace(numbers))
        for k, value in enumerate(_shape_values(tree))
    )
    return replace(system, outputs=(*system.outputs, *shapes))


def _shape_values(tree: Tree) -> list[Expr]:
    values: list[Any] = []
    for b in tree.bodies:
        J = b.central_inertia
        values += [b.mass, *b.centre, *(J[i][k] for i in range(3) for k in range(i, 3))]
        values += [x for position in _joints_on(tree, b.name) for x in position]
    return [as_expression(v) for v in values]


def _joints_on(tree: Tree, body: str) -> list[Any]:
    return [j.on_parent.position for j in tree.ordered if j.parent == body]


# -- numbers ------------------------------------------------------------------------------------------


def _knobs(scene: TreeScene) -> Iterator[Knob]:
    system = scene.full_system
    numbers = scene.numbers
    yield from (knob(q, numbers[q.name], "parameters") for q in system.parameters)
    given = {n: v.value for n, v in scene.inputs.items()}
    yield from (knob(q, given.get(q.name, 0.0), "torque") for q in system.inputs)
    values = scene._start
    bound = {n for names in scene.attitudes for n in names}
    yield from of_states([q for q in system.states if q.name not in bound], values)


def _fixed(scene: TreeScene) -> dict[str, float]:
    bound = {n for names in scene.attitudes for n in names}
    return {n: v for n, v in scene._start.items() if n in bound}


def _up(scene: TreeScene) -> tuple[float, ...]:
    """Return the direction against gravity; axis 3 of the ground where there is none."""
    g = [_number(x, scene.numbers) for x in scene.tree.gravity]
    size = sum(x * x for x in g) ** 0.5
    return tuple(-x / size + 0.0 for x in g) if size else (0.0, 0.0, 1.0)


def _number(value: Any, numbers: Mapping[str, float]) -> float:
    if is_number(value):
        return float(value)
    return float(value.xreplace({s: sp.Float(numbers[s.name]) for s in value.free_symbols}))
