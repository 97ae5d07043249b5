"""A scene as a live page needs it: numbers to change, parts to leave out, one system a choice.

How far sliders go: from the value of a quantity, its unit, and others of the same unit.

Of one body all torque, the difference of two moments of inertia and single parameters of the torque can be
left out. Each choice is a scene of its own that goes through the passes of `eom.scenes.assembly`; their
values play no part but for which moments are equal, so that every right-hand side holds for all values.

Of a tree gravity, springs and dampers can. Each choice is a tree of its own that is derived anew, so that
what a zero makes superfluous is gone from the equations. The bodies are drawn from four points of each;
their shapes follow from mass and inertia.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import singledispatch
from itertools import product
from typing import Any

import numpy as np
import sympy as sp

from eom.errors import InputError
from eom.kinematics.coordinates import SEQUENCES, attitude, elementary
from eom.kinematics.frames import vector
from eom.mechanics.rigidbody import OMEGA, full_inertia
from eom.mechanics.spinning import I1, I2, PHI, PSI, THETA
from eom.multibody.algebra.spatial import ZERO, ZEROS
from eom.multibody.files.scene import TreeScene
from eom.multibody.model.model import Tree
from eom.multibody.recursion.operation_count import savings
from eom.multibody.recursion.quantities import Point
from eom.multibody.system.derive import derive
from eom.opening import AnyScene
from eom.quantities import TIME, Definition, Quantity
from eom.rotations import angles_of_matrix, matrix_of
from eom.scenes import assembly, parse, start
from eom.scenes.conventions import attitude_at_start
from eom.scenes.description import inertia_values, principal_values
from eom.scenes.reduce import cost
from eom.scenes.scene import Scene
from eom.system import System, as_expression
from eom.terms.terms import VECTOR, Equation, Term, add, cross, der, dot, zero
from eom.terms.vocabulary import omega, quantity
from eom.views.animation.bodies import ManyBodies

Expr = Any

Choice = tuple[bool, ...]
"""What is left out: one truth value a switch, in order."""

MOST_SWITCHES = 3
"""Every choice has a right-hand side of its own: eight at most."""
VECTORS, FRAMES = ("omega", "H", "torque"), ("trails", "body frames", "space frame")
"""What can be hidden, by the names of the viewer: of one body, and of all."""
VIEW = "view_"
"""How the names of outputs begin that are there to be drawn."""


@dataclass(frozen=True)
class Knob:
    """A number that the reader can change, between ``low`` and ``high`` by the slider (SI units).

    ``group``: inertia, parameters, torque, start. ``positive``: whether it must be above zero.
    """

    name: str
    meaning: str
    unit: str
    value: float
    low: float
    high: float
    group: str
    positive: bool = False


@dataclass(frozen=True)
class Switch:
    """Something that can be left out: its words, and whether the scene leaves it out."""

    name: str
    words: str
    on: bool


@dataclass(frozen=True)
class Variant:
    """The equations of one choice.

    ``own``: the scene's equations; ``drawn``: those that the page integrates, with attitude and with the
    outputs that are drawn. ``left_out``: what the passes left out, a line each. ``general``: operations
    of the right-hand side before them, ``after`` behind them. ``equal``: parameters that have become one
    with another. ``free``: no torque, so that Poinsot's construction holds. ``law``: the law of motion,
    with words, of one body.
    """

    own: System
    drawn: System
    left_out: tuple[str, ...]
    general: int
    after: int
    equal: Mapping[str, str] = field(default_factory=dict)
    free: bool = False
    law: tuple[tuple[Equation, str], ...] = ()


@dataclass(frozen=True)
class Subject:
    """A scene as a live page needs it.

    ``kind``: body, spinner or tree. ``fixed``: numbers that cannot be changed, by name. ``sequence``: of
    the turns that the knobs attitude_1 to 3 are the angles of, or empty. ``inertia``: names of the
    entries of the inertia matrix, of one body. ``centre``: names of the components of the centre of mass
    from the fixed point, or empty. ``bodies``: by the order of what is drawn. ``joints``: by body the
    number of joints that lead on. ``follow``: the number of a body that floats, with which the camera goes,
    or -1. ``up``: against gravity. ``caption``: below the picture; ``shown``: what can be hidden, and
    whether it is seen at first.
    """

    kind: str
    name: str
    title: str
    description: str
    knobs: tuple[Knob, ...]
    switches: tuple[Switch, ...]
    variants: Mapping[Choice, Variant]
    fixed: Mapping[str, float] = field(default_factory=dict)
    sequence: tuple[int, ...] = ()
    inertia: tuple[tuple[str, ...], ...] = ()
    centre: tuple[str, ...] = ()
    bodies: tuple[str, ...] = ()
    joints: tuple[int, ...] = ()
    follow: int = -1
    up: Sequence[float] = (0.0, 0.0, 1.0)
    notes: tuple[str, ...] = ()
    caption: str = ""
    shown: Mapping[str, bool] = field(default_factory=dict)

    @property
    def choice(self) -> Choice:
        """What the scene itself leaves out."""
        return tuple(s.on for s in self.switches)


Data = dict[str, Any]
"""What a scene file says, as Python values."""


POSITIVE_UNITS = frozenset({"kg", "kg m^2"})
"""Masses and moments of inertia are above zero."""
AT_ZERO = {"rad": math.pi, "rad/s": 5.0, "m": 1.0, "m/s": 2.0, "N m": 1.0, "N": 5.0}
"""How far a slider goes whose value, and all others of its unit, are zero."""
TIMES = 2.5


def knob(quantity: Quantity, value: float, group: str, around: float = 0.0) -> Knob:
    """Return the knob of a quantity; ``around``: the largest of those it belongs with."""
    positive = quantity.unit in POSITIVE_UNITS or bool(quantity.symbol.is_positive)
    low, high = _range(quantity.unit, value, max(abs(value), around), positive)
    words = quantity.meaning or quantity.name
    return Knob(quantity.name, words, quantity.unit, value, low, high, group, positive)


def _range(unit: str, value: float, size: float, positive: bool) -> tuple[float, float]:
    if positive and value > 0:
        return _round(value / 10), _round(TIMES * value)
    if unit == "rad" and size <= math.pi:
        return -math.pi, math.pi
    high = _round(TIMES * size) or AT_ZERO.get(unit, 1.0)
    return -high, high


def _round(value: float) -> float:
    """Return two digits of a number."""
    return float(f"{value:.2g}")


def of_states(states: Iterable[Quantity], values: Mapping[str, float]) -> list[Knob]:
    """Return the knobs of initial values; those of one unit go equally far."""
    known = [q for q in states if q.name in values]
    size = {
        unit: max(abs(values[q.name]) for q in known if q.unit == unit)
        for unit in dict.fromkeys(q.unit for q in known)
    }
    return [knob(q, values[q.name], "start", size[q.unit]) for q in known]


Off = Sequence[str]
"""Names of the switches that are on: of what is left out."""


@singledispatch
def subject_of(scene: AnyScene) -> Subject:
    """Return what a page about a scene needs. Raises `InputError` for a tree under constraints."""
    raise NotImplementedError(scene)


def _variants(switches: Sequence[Switch], make: Callable[[Off], Variant]) -> dict[Choice, Variant]:
    """Return the equations of each choice."""
    choices = product((False, True), repeat=len(switches))
    return {c: make([s.name for s, on in zip(switches, c, strict=True) if on]) for c in choices}


# -- one body ------------------------------------------------------------------------------------------

TORQUE, SYMMETRIC, WITHOUT = "torque_free", "symmetric", "without_"
GENERAL, EQUAL = (3.0, 4.0, 5.0), 4.0
"""Moments that stand for different ones, and for two that are equal."""
NAMES = {"spinner": ("M1", "M2", "M3"), "rigid body": ("tau_1", "tau_2", "tau_3")}
DEFAULT_SEQUENCE = "3-2-1"


@subject_of.register
def _of_body(scene: Scene) -> Subject:
    attitude_used = _attitude(scene)
    pair, switches = _pair(scene), switches_of(scene)
    sequence, angles = _start_angles(scene, attitude_used)
    return Subject(
        kind="spinner" if scene.model == "spinner" else "body",
        name=scene.name,
        title=scene.title or scene.name,
        description=scene.description,
        knobs=(*_inertia_knobs(scene), *_torque_knobs(scene), *_start_knobs(scene, attitude_used),
               *angles),
        switches=switches,
        variants=_variants(switches, lambda off: _variant(scene, attitude_used, off, pair)),
        sequence=sequence,
        inertia=_inertia_names(scene),
        centre=_centre(scene),
        bodies=("body",),
        notes=tuple(_notes(scene, attitude_used)),
        caption=_caption(scene),
        shown=dict.fromkeys((*VECTORS, *FRAMES), True),
    )  # fmt: skip


def _attitude(scene: Scene) -> str:
    """Return the coordinates of attitude that the page integrates: angles where the scene has them."""
    if scene.model == "spinner":
        return "none"
    return scene.coordinates if scene.coordinates in SEQUENCES else "quaternion"


def _notes(scene: Scene, used: str) -> Iterator[str]:
    if scene.model == "spinner" or used == scene.attitude:
        return
    if scene.attitude == "none":
        yield "The scene has no attitude; for the drawing a unit quaternion is integrated as well."
    else:
        yield "The page integrates a unit quaternion in place of the scene's coordinates of attitude."


# -- what can be left out -----------------------------------------------------------------------------


def _pair(scene: Scene) -> tuple[int, int] | None:
    """Return the numbers of the two moments of inertia that can be made one."""
    if scene.model == "spinner" or inertia_values(scene) is not None:
        return None
    values = principal_values(scene)
    pairs = [(i, j) for i, j in ((0, 1), (1, 2), (0, 2)) if values[i] == values[j]]
    return pairs[0] if pairs else (0, 1)


def switches_of(scene: Scene) -> tuple[Switch, ...]:
    """Return what can be left out of a scene of one body, at most `MOST_SWITCHES`."""
    return tuple(_switches(scene, _pair(scene)))


def _switches(scene: Scene, pair: tuple[int, int] | None) -> Iterator[Switch]:
    free = _is_free(scene)
    yield Switch(TORQUE, "no torque", free)
    if pair is not None:
        i, j = pair
        values = principal_values(scene)
        yield Switch(SYMMETRIC, f"symmetric: I{i + 1} = I{j + 1}", values[i] == values[j])
    room = MOST_SWITCHES - 1 - (pair is not None)
    yield from [s for n in scene.parameters if (s := _parameter_switch(scene, n))][:room]


def _is_free(scene: Scene) -> bool:
    return all(d.expression == 0 for d in scene.full_system.outputs if _is_torque(d))


def _is_torque(output: Definition) -> bool:
    return output.name.startswith("torque_")


def _laws(scene: Scene) -> set[str]:
    return {n for n, law in scene.torque if law is not None}


def _parameter_switch(scene: Scene, name: str) -> Switch | None:
    """Return the switch that leaves out a parameter of the torque, if some torque is left then."""
    try:
        left = _without(scene, (name,))
    except InputError:  # the formula divides by it
        return None
    if _laws(scene) == {"components"} and all(c in {0, "0"} for c in left["torque"]["components"]):
        return None
    meaning = scene.parameters[name].meaning
    return Switch(f"{WITHOUT}{name}", f"{name} = 0{f': no {meaning}' if meaning else ''}", False)


def _without(scene: Scene, names: tuple[str, ...]) -> Data:
    """Return torque, parameters and inputs of a scene with some parameters zero.

    Sizes of a solid are put in as numbers: the page's body has its moments alone.
    """
    full = scene.full_system
    known = {q.name: q.symbol for q in (*full.states, *full.parameters, *full.inputs)}
    known |= {n: sp.Symbol(n, real=True) for a in full.angles for n in a.names} | {"t": TIME}
    put = {n: f"({v})" for n, v in start.sizes(scene).items()} | dict.fromkeys(names, "0")
    written, used = [], set()
    for component in scene.torque.components or ():
        text = str(component)
        for name, number in put.items():
            text = re.sub(rf"\b{re.escape(name)}\b", number, text)
        value = (
            parse.parse(text, known, "torque")
            if isinstance(component, str)
            else sp.sympify(component, strict=True)
        )
        written.append(0 if value == 0 else text if isinstance(component, str) else component)
        used |= {s.name for s in value.free_symbols}
    data = scene.model_dump(exclude_unset=True)
    return {
        "torque": {**data["torque"], "components": written},
        "parameters": {n: v for n, v in data.get("parameters", {}).items() if n in used},
        "inputs": {n: v for n, v in data.get("inputs", {}).items() if n in used},
    }


def _torque_data(scene: Scene, off: Off) -> Data:
    """Return torque, parameters and inputs of a choice."""
    if TORQUE in off:
        return {}
    if _is_free(scene):
        names = NAMES[scene.model]
        inputs = {
            n: {"value": 0.0, "unit": "N m", "meaning": f"torque about b{k}"}
            for k, n in enumerate(names, 1)
        }
        return {"torque": {"components": list(names)}, "inputs": inputs}
    if scene.torque.components is None:
        return {"torque": scene.model_dump(exclude_unset=True)["torque"]}
    return _without(scene, tuple(n for n in scene.parameters if f"{WITHOUT}{n}" in off))


def _body_data(scene: Scene, off: Off, pair: tuple[int, int] | None) -> Data:
    if pair is None:
        body: Data = scene.model_dump(exclude_unset=True)["body"]
        return body
    moments = list(GENERAL)
    if SYMMETRIC in off:
        moments = [EQUAL if k in pair else GENERAL[2] for k in range(3)]
    return {"moments": moments}


def _caption(scene: Scene) -> str:
    shape, axis = "A solid with the moments of inertia of the body.", 3
    if scene.torque.weight is not None:
        shape = "A picture of a top, its point fixed."
    if scene.model == "spinner":
        held = ", held by the end of its axle" if scene.torque.weight is not None else ""
        shape, axis = f"A wheel about b2{held}; its proportions are those of a picture.", 2
    return (
        f"{shape} Arrows: ω, H and the torque τ, each against its largest value so far; the line is the "
        f"path of b{axis}."
    )


def _law(scene: Scene, free: bool) -> Iterator[tuple[Equation, str]]:
    """Yield the law, the momentum and the equation that follows, with words."""
    about = "C" if scene.torque.weight is None else "O"
    J = quantity("inertia", about)
    h, torque = (quantity(n, "body", about) for n in ("angular_momentum", "torque"))
    if scene.torque.weight is not None:  # words for the angular momentum about a point, of all mass
        h = quantity("absolute_angular_momentum", "body", about)
    right = zero(VECTOR) if free else torque
    law = "Angular momentum does not change" if free else "Torque changes angular momentum"
    yield Equation(der(h), right), law
    if scene.model == "spinner":
        yield Equation(h, dot(J, omega("C"))), "Momentum of the body C, which spins in B"
        yield Equation(_seen_from_b(h), right), "The same as seen from B, which does not spin"
        return
    yield Equation(h, dot(J, omega())), "Momentum of a rigid body"
    euler = add(dot(J, der(omega(), "B")), cross(omega(), dot(J, omega())))
    yield Equation(euler, right), "Euler's equation: the same as seen from the body"


def _seen_from_b(h: Term) -> Term:
    return add(der(h, "B"), cross(omega("B"), h))


# -- one choice ---------------------------------------------------------------------------------------


def _variant(scene: Scene, used: str, off: Off, pair: tuple[int, int] | None) -> Variant:
    data = {
        "name": scene.name,
        "title": scene.title,
        "model": scene.model,
        "body": _body_data(scene, off, pair),
        **_torque_data(scene, off),
    }
    needs = (
        used if scene.attitude == "none" and data.get("torque", {}).keys() - {"components"} else ""
    )
    shown = {"angles": scene.angles, "integrate": scene.integrate}
    own = Scene(**data, **shown, attitude=needs or scene.attitude)
    drawn = (
        own if own.coordinates == used or scene.model == "spinner" else Scene(**data, attitude=used)
    )
    known = {*own.full_system.state_names, *own.full_system.output_names}
    asked = [n for n in scene.requested if n in known] or list(own.full_system.state_names)
    system, explanation = assembly.derive(own, own.full_system, asked)
    return Variant(
        own=system,
        drawn=_drawn(drawn, used),
        left_out=tuple(
            f"{r.what}: {r.why} ({r.saved} operation{'s' * (r.saved != 1)} saved)"
            for r in explanation.reductions
        ),
        general=explanation.before,
        after=explanation.after,
        equal={f"I{pair[1] + 1}": f"I{pair[0] + 1}"} if pair and SYMMETRIC in off else {},
        free=TORQUE in off,
        law=tuple(_law(scene, TORQUE in off)),
    )


def _drawn(scene: Scene, used: str) -> System:
    """Return the system that the page integrates: all states, and as outputs what is drawn."""
    full = scene.full_system
    system, _ = assembly.derive(scene, full, full.state_names)
    general = assembly.equal_moments(scene, full)
    known = {d.name: general.expand(d.expression) for d in general.outputs}
    h = [known[f"h_{k}"] for k in (1, 2, 3)]
    torque = [known[f"torque_{k}"] for k in (1, 2, 3)]
    if scene.model == "spinner":
        to_frame = elementary(1, THETA) * elementary(3, PSI)
        to_body = elementary(2, PHI) * to_frame
        omega = [h[0] / I1, h[1] / I2, h[2] / I1]
    else:
        to_frame = to_body = attitude(used).matrix
        omega = list(OMEGA.components)
    back = to_frame.T
    rows = {
        "C": list(to_body),
        "omega": list(back * vector("B", omega).column),
        "H": list(back * vector("B", h).column),
        "torque": list(back * vector("B", torque).column),
    }
    outputs = tuple(
        Definition(Quantity(sp.Symbol(f"{VIEW}{name}_{k}", real=True)), expression)
        for name, values in rows.items()
        for k, expression in enumerate(values, 1)
    )
    return replace(system, outputs=outputs)


# -- numbers ------------------------------------------------------------------------------------------


def _inertia_names(scene: Scene) -> tuple[tuple[str, ...], ...]:
    if scene.model == "spinner":
        diagonal: tuple[str, ...] = ("I1", "I2", "I1")
    elif inertia_values(scene) is not None:
        J, _ = full_inertia()
        return tuple(tuple(str(J[i, k]) for k in range(3)) for i in range(3))
    else:
        diagonal = ("I1", "I2", "I3")
    return tuple(tuple(n if i == k else "" for k in range(3)) for i, n in enumerate(diagonal))


def _inertia_knobs(scene: Scene) -> Iterator[Knob]:
    values = start.constants(scene)
    names = [n for n in dict.fromkeys(n for row in _inertia_names(scene) for n in row) if n]
    known = {q.name: q for q in scene.full_system.parameters}
    largest = max(values[n] for n in names)
    for name in names:
        made = knob(known[name], values[name], "inertia", largest)
        if name.startswith("J") and name[1] != name[2]:
            yield replace(made, low=-largest, high=largest, positive=False)
        else:
            yield replace(made, low=float(f"{largest / 20:.2g}"))


def _torque_knobs(scene: Scene) -> Iterator[Knob]:
    """Yield the knobs of the torque: those of the scene, or three components of a free body."""
    if _is_free(scene):
        values = start.constants(scene)
        speed = max(
            [abs(v) for n, v in start.initial(scene).items() if n.startswith("omega") or n == "C"]
            or [1.0]
        )
        size = float(
            f"{0.02 * max(values[n] for n in ('I1', 'I2', 'J11') if n in values) * (speed or 1.0) ** 2:.1g}"
        )
        for k, name in enumerate(NAMES[scene.model], 1):
            yield Knob(name, f"torque about b{k}", "N m", 0.0, -size, size, "torque")
        return
    numbers = start.constants(scene) | {n: v.value for n, v in scene.inputs.items()}
    inertia = {n for row in _inertia_names(scene) for n in row}
    for q in (*scene.full_system.parameters, *scene.full_system.inputs):
        if q.name not in inertia:
            yield knob(q, numbers[q.name], "torque")


def _states_at_start(scene: Scene) -> dict[str, float]:
    values = start.states(scene, scene.full_system)
    return {n: values.get(n, 0.0) for n in scene.full_system.state_names}


def _start_knobs(scene: Scene, used: str) -> list[Knob]:
    values = _states_at_start(scene)
    turned = used if used in SEQUENCES or scene.model == "spinner" else ""
    kept = [q for q in scene.full_system.states if turned or q.symbol in OMEGA.components]
    return of_states(kept, values)


def _start_angles(scene: Scene, used: str) -> tuple[tuple[int, ...], list[Knob]]:
    """Return the sequence and the angles at the start of an attitude that is a quaternion."""
    if used != "quaternion":
        return (), []
    given = scene.initial_attitude
    if given is not None and given.quaternion is None:
        name = given.sequence
        angles = given.degrees or tuple(sp.deg(a).evalf() for a in given.radians or ())
    else:
        name, angles = DEFAULT_SEQUENCE, _angles_of(scene, DEFAULT_SEQUENCE)
    axes = tuple(int(a) for a in name.split("-"))
    order = ("first", "second", "third")
    knobs = [
        Knob(f"attitude_{k + 1}", f"{order[k]} turn at the start, about axis {axis}", "deg",
             float(angle), -180.0, 180.0, "start")
        for k, (axis, angle) in enumerate(zip(axes, angles, strict=True))
    ]  # fmt: skip
    return axes, knobs


def _angles_of(scene: Scene, sequence: str) -> tuple[float, ...]:
    """Return the angles in degrees of a scene's attitude at the start; zero where it has none."""
    if scene.attitude == "none":
        data = scene.model_dump(exclude_unset=True) | {"attitude": "quaternion", "outputs": ()}
        if scene.initial_attitude is None:
            return (0.0, 0.0, 0.0)
        scene = Scene(**data)
    C = matrix_of([list(row) for row in attitude_at_start(scene)])
    return tuple(float(sp.deg(a).evalf()) for a in angles_of_matrix(C, sequence))


def _centre(scene: Scene) -> tuple[str, ...]:
    if scene.torque.weight is None:
        return ()
    return tuple(f"r{k}" if c else "" for k, c in enumerate(scene.torque.weight.centre_of_mass, 1))


# -- trees --------------------------------------------------------------------------------------------

GRAVITY, SPRINGS, DAMPING = "gravity", "springs", "damping"
WORDS = {GRAVITY: "no gravity", SPRINGS: "no springs", DAMPING: "no damping"}
TIPS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
"""The points of each body that say where it is and how it is turned: its origin, ends of its axes."""


@subject_of.register
def _of_tree(scene: TreeScene) -> Subject:
    tree = scene.tree
    if tree.constraints:
        raise InputError(
            "a live page holds no constraints: a change of a number needs consistent values anew",
            where=scene.name,
            got=", ".join(c.name for c in tree.constraints),
            hint="eom animate shows its motion with the scene's numbers",
        )
    switches = tuple(
        Switch(name, WORDS[name], False) for name, edit in EDITS.items() if edit(tree) != tree
    )
    afloat = [k for k, b in enumerate(tree.bodies) if tree.joint_of[b.name].kind == "free"]
    return Subject(
        kind="tree",
        name=scene.name,
        title=scene.title or scene.name,
        description=scene.description,
        knobs=tuple(_tree_knobs(scene)),
        switches=switches,
        variants=_variants(switches, lambda off: _tree_variant(scene, off)),
        fixed=_fixed(scene),
        bodies=tuple(b.name for b in tree.bodies),
        joints=tuple(len(_joints_on(tree, b.name)) for b in tree.bodies),
        follow=next(iter(afloat), -1),
        up=_up(scene),
        caption=TREE_CAPTION,
        shown={name: name != "body frames" for name in (*FRAMES, *(["camera"] if afloat else []))},
    )


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


TREE_CAPTION = (
    "Boxes and cylinders have the mass and the moments of inertia of the bodies; the line is the path of "
    "the last one."
)
EDITS = {GRAVITY: _without_gravity, SPRINGS: _without_springs, DAMPING: _without_damping}


def _tree_variant(scene: TreeScene, off: Off) -> Variant:
    tree = scene.tree
    for name in off:
        tree = EDITS[name](tree)
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


def _tree_knobs(scene: TreeScene) -> Iterator[Knob]:
    system = scene.full_system
    yield from (knob(q, scene.numbers[q.name], "parameters") for q in system.parameters)
    given = {n: v.value for n, v in scene.inputs.items()}
    yield from (knob(q, given.get(q.name, 0.0), "torque") for q in system.inputs)
    fixed = _fixed(scene)
    yield from of_states([q for q in system.states if q.name not in fixed], scene.start)


def _fixed(scene: TreeScene) -> dict[str, float]:
    bound = {n for names in scene.attitudes for n in names}
    return {n: v for n, v in scene.start.items() if n in bound}


def _up(scene: TreeScene) -> tuple[float, ...]:
    """Return the direction against gravity; axis 3 of the ground where there is none."""
    g = ManyBodies(scene).gravity
    return (0.0, 0.0, 1.0) if g is None else tuple((-g / np.linalg.norm(g) + 0.0).tolist())
