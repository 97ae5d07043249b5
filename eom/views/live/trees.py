"""A tree of bodies as a live page needs it.

Gravity, springs and dampers can be left out. Each choice is a tree of its own that is derived anew, so that
what a zero makes superfluous is gone from the equations. The bodies are drawn from four points of each;
their shapes follow from mass and inertia, or from how they touch (`eom.views.live.fittings`).

Constraints: the page integrates the states that remain, as the scene's own system does; of speeds that
follow from others those stay whose start the scene keeps, if they are enough. Start values are made
consistent on the page, whatever numbers are changed.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import sympy as sp

from eom.errors import InputError
from eom.multibody.algebra.spatial import ZERO, ZEROS
from eom.multibody.constrained.constraint_plan import plan
from eom.multibody.files.scene import TreeScene
from eom.multibody.model.constraints import Loop
from eom.multibody.model.model import Tree
from eom.multibody.recursion.operation_count import savings
from eom.multibody.recursion.quantities import Point
from eom.multibody.system.vectors import MOMENTUM, OMEGA, Drawn
from eom.quantities import Definition, Quantity
from eom.rotations import angles_of_matrix, matrix_of_quaternion
from eom.scenes.reduce import cost
from eom.system import System, as_expression
from eom.views.animation.acting import STYLES, group, is_seen
from eom.views.animation.bodies import ManyBodies
from eom.views.draw import formulas
from eom.views.live.fittings import fittings_of, sizes_of
from eom.views.live.subject import (
    ALL,
    FRAMES,
    SEQUENCE,
    VIEW,
    Attitude,
    Fitting,
    Knob,
    Off,
    Subject,
    Switch,
    Variant,
    attitude_knobs,
    knob,
    of_inputs,
    of_states,
    variants_of,
)

Expr = Any
GRAVITY, SPRINGS, DAMPING = "gravity", "springs", "damping"
WORDS = {GRAVITY: "no gravity", SPRINGS: "no springs", DAMPING: "no damping"}
TIPS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
"""The points of each body that say where it is and how it is turned: its origin, ends of its axes."""

VECTORS = Drawn(f"{VIEW}vector")
"""All vectors of the tree, as outputs."""

ROUNDING = 1e-12
"""Start values below this come from the rounding of a consistent start, which the page makes anew."""


def of_tree(scene: TreeScene) -> Subject:
    """Return what a page about a tree of bodies needs. Raises `InputError` as its derivation does."""
    tree = scene.tree
    switches = tuple(
        Switch(name, WORDS[name], False) for name, edit in EDITS.items() if edit(tree) != tree
    )
    afloat = [k for k, b in enumerate(tree.bodies) if tree.joint_of[b.name].kind == "free"]
    fittings = fittings_of(tree)
    stay = _staying(scene)
    attitudes, angles = _attitudes(scene)
    variants = variants_of(switches, lambda off: _variant(scene, off, fittings, stay))
    first = next(iter(variants.values())).drawn
    return Subject(
        kind="tree",
        name=scene.name,
        title=scene.title or scene.name,
        description=scene.description,
        knobs=(*_knobs(scene, first), *angles),
        switches=switches,
        variants=variants,
        attitudes=attitudes,
        bodies=tuple(b.name for b in tree.bodies),
        joints=tuple(len(_joints_on(tree, b.name)) for b in tree.bodies),
        fittings=fittings,
        follow=next(iter(afloat), -1),
        speeds=tuple(s.name for j in tree.ordered for s in j.speeds),
        keep=scene.keep,
        up=_up(scene),
        notes=tuple(_notes(tree, first)),
        caption=_caption(fittings),
        shown={
            **_seen(variants.values(), bool(np.any(_field(scene)))),
            **{name: name != "body frames" for name in (*FRAMES, *(["camera"] if afloat else []))},
        },
    )


def _field(scene: TreeScene) -> Any:
    g = ManyBodies(scene).gravity
    return np.zeros(3) if g is None else g


def _seen(variants: Iterable[Variant], heavy: bool) -> dict[str, bool]:
    """Return the groups of vectors, and whether they are seen at first: forces, if they are few.

    Where nothing weighs anything, momentum and angular velocity are seen, too.
    """
    most: dict[str, int] = {}
    for variant in variants:
        for name, count in Counter(map(group, variant.vectors)).items():
            most[name] = max(count, most.get(name, 0))
    return {
        f"{ALL}{name}": is_seen(name, most[name]) and (name not in {OMEGA, MOMENTUM} or not heavy)
        for name in STYLES
        if name in most
    }


def _caption(fittings: Sequence[Fitting]) -> str:
    rolls = any(f.kind == "roll" for f in fittings)
    path = (
        "the lines are the paths of the points of contact"
        if rolls
        else "the line is the path of the last one"
    )
    but = ", those that roll the shape that touches" if rolls else ""
    return (
        f"Boxes and cylinders have the mass and the moments of inertia of the bodies{but}; {path}. "
        "Arrows of one unit have one scale, by the largest so far."
    )


def _notes(tree: Tree, drawn: System) -> Iterator[str]:
    """Yield which speeds have no slider, as the constraints give them."""
    free = [j for j in tree.ordered if j.motion is None]
    follow = [s for j in free for s in j.speeds if s.name not in drawn.state_names]
    if follow:
        names = ", ".join(formulas.name(s.name) for s in follow)
        yield f"By the constraints these speeds follow from the others, and have no sliders: {names}."


def _near(scene: TreeScene) -> dict[str, float]:
    """Return the numbers at which constraints are tested for dependence: those of the scene."""
    return {**scene.numbers, **scene.start} if scene.tree.constraints else {}


def _staying(scene: TreeScene) -> tuple[str, ...] | None:
    """Return the speeds that remain states where others are eliminated: those that the scene keeps.

    None where no speed is eliminated, or where these are not as many as needed, or do not give the others.
    """
    tree = scene.tree
    kept = tuple(s.name for j in tree.ordered for s in j.speeds if s.name in scene.keep)
    near = _near(scene)
    if not (kept and tree.constraints) or plan(tree, near).dependent is None:
        return None
    try:
        plan(tree, near, kept)
    except InputError:
        return None
    return kept


# -- what can be left out -----------------------------------------------------------------------------


def _without_gravity(tree: Tree) -> Tree:
    return replace(tree, gravity=ZERO, gravity_gradient=ZEROS)


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


def _variant(
    scene: TreeScene, off: Off, fittings: Sequence[Fitting], stay: tuple[str, ...] | None
) -> Variant:
    tree = scene.tree
    for name in off:
        tree = EDITS[name](tree)
    points = [
        Point(f"{VIEW}{k}_{n}", b.name, tip, ("position",))
        for k, b in enumerate(tree.bodies)
        for n, tip in enumerate(TIPS)
    ]
    own, moving = scene.of_tree(tree, (), stay), scene.of_tree(tree, (*points, VECTORS), stay)
    drawn, vectors = _with_shapes(moving, scene, tree, fittings), VECTORS.of(moving, tree)
    saved = savings(tree)
    return Variant(own, drawn, tuple(saved.reasons), saved.without, cost(own), vectors=vectors)


def _with_shapes(
    system: System, scene: TreeScene, tree: Tree, fittings: Sequence[Fitting]
) -> System:
    """Return a system whose outputs give points, then mass, centre, inertia, joints of each body.

    Behind them come the values of the fittings, and vectors with their places, in order.
    """
    known = set(system.parameter_names)
    values = [*_shape_values(tree), *(as_expression(x) for f in fittings for x in f.values)]
    numbers = {
        s: sp.Float(scene.numbers[s.name])
        for value in values
        for s in value.free_symbols
        if s.name not in known and s.name in scene.numbers
    }
    shapes = tuple(
        Definition(Quantity(sp.Symbol(f"{VIEW}shape_{k}", real=True)), value.xreplace(numbers))
        for k, value in enumerate(values)
    )
    points = tuple(d for d in system.outputs if f"_{VIEW}" in d.name)
    vectors = tuple(d for d in system.outputs if d.name.startswith(VECTORS.prefix))
    return replace(system, outputs=(*points, *shapes, *vectors))


def _shape_values(tree: Tree) -> list[Expr]:
    values: list[Any] = []
    for b in tree.bodies:
        J = b.central_inertia
        values += [b.mass, *b.centre, *(J[i][k] for i in range(3) for k in range(i, 3))]
        values += [x for position in _joints_on(tree, b.name) for x in position]
    return [as_expression(v) for v in values]


def _joints_on(tree: Tree, body: str) -> list[Any]:
    """Return where other bodies hang on a body: in joints, and where loops are closed."""
    found = [j.on_parent.position for j in tree.ordered if j.parent == body]
    loops = [c for c in tree.constraints if isinstance(c, Loop)]
    found += [c.on_first.position for c in loops if c.first == body]
    return found + [c.on_second.position for c in loops if c.second == body]


# -- numbers ------------------------------------------------------------------------------------------


def _knobs(scene: TreeScene, drawn: System) -> Iterator[Knob]:
    system, positive = scene.full_system, sizes_of(scene.tree)
    for q in system.parameters:
        yield knob(q, scene.numbers[q.name], "parameters", positive=q.name in positive)
    given = {n: v.value for n, v in scene.inputs.items()}
    yield from of_inputs(system, {**scene.start, **given})
    bound = {n for names in scene.attitudes for n in names}
    start = {n: x if abs(x) > ROUNDING else 0.0 for n, x in scene.start.items()}
    yield from of_states([q for q in drawn.states if q.name not in bound], start)


def _attitudes(scene: TreeScene) -> tuple[tuple[Attitude, ...], list[Knob]]:
    """Return the quaternions among the states, and knobs of their angles, in the sequences of the scene."""
    found, knobs = [], []
    turning = {j.coordinates[-1].name: j.name for j in scene.tree.joints if j.coordinates}
    for names in scene.attitudes:
        joint = turning[names[-1]]
        given = scene.initial_attitude.get(joint)
        sequence = SEQUENCE if given is None or given.quaternion else given.sequence
        C = matrix_of_quaternion([scene.start[n] for n in names])
        degrees = [math.degrees(a) for a in angles_of_matrix(C, sequence)]
        of = f" of joint {joint}" if len(scene.attitudes) > 1 else ""
        one, own = attitude_knobs(names, sequence, degrees, f"{joint}_", of)
        found.append(one)
        knobs += own
    return tuple(found), knobs


def _up(scene: TreeScene) -> tuple[float, ...]:
    """Return the direction against gravity; axis 3 of the ground where there is none."""
    g = _field(scene)
    return tuple((-g / np.linalg.norm(g) + 0.0).tolist()) if np.any(g) else (0.0, 0.0, 1.0)
