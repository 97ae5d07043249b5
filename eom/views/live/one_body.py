"""A scene of one body as a live page needs it.

All torque, the difference of two moments of inertia and single parameters of the torque can be left out.
Each choice is a scene of its own that goes through the passes of `eom.scenes.assembly`; their values play
no part but for which moments are equal, so that every right-hand side holds for all values.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.kinematics.coordinates import SEQUENCES, attitude, elementary
from eom.kinematics.frames import vector
from eom.mechanics.rigidbody import OMEGA, full_inertia
from eom.mechanics.spinning import I1, I2, PHI, PSI, THETA
from eom.quantities import TIME, Definition, Quantity
from eom.rotations import angles_of_matrix, matrix_of
from eom.scenes import assembly, parse, start
from eom.scenes.conventions import attitude_at_start
from eom.scenes.description import Control, inertia_values, principal_values
from eom.scenes.scene import Scene
from eom.system import System
from eom.terms.terms import VECTOR, Equation, Term, add, cross, der, dot, zero
from eom.terms.vocabulary import omega, quantity
from eom.views.live.subject import (
    FRAMES,
    MOST_SWITCHES,
    SEQUENCE,
    VECTORS,
    VIEW,
    Attitude,
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

Data = dict[str, Any]
"""What a scene file says, as Python values."""

TORQUE, SYMMETRIC, WITHOUT = "torque_free", "symmetric", "without_"
GENERAL, EQUAL = (3.0, 4.0, 5.0), 4.0
"""Moments that stand for different ones, and for two that are equal."""
NAMES = {"spinner": ("M1", "M2", "M3"), "rigid body": ("tau_1", "tau_2", "tau_3")}


def of_body(scene: Scene) -> Subject:
    """Return what a page about a scene of one body needs."""
    attitude_used = _attitude(scene)
    pair, switches, alike = _pair(scene), switches_of(scene), []
    if scene.control != Control():  # its laws may need anything that could be left out
        alike = [s.name for s in switches if s.on and s.name == SYMMETRIC]
        switches = ()
    attitudes, angles = _start_angles(scene, attitude_used)
    return Subject(
        kind="spinner" if scene.model == "spinner" else "body",
        name=scene.name,
        title=scene.title or scene.name,
        description=scene.description,
        knobs=(*_inertia_knobs(scene), *_torque_knobs(scene), *_start_knobs(scene, attitude_used),
               *angles),
        switches=switches,
        variants=variants_of(
            switches, lambda off: _variant(scene, attitude_used, [*off, *alike], pair)
        ),
        attitudes=attitudes,
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
    named = (*(n for a in full.angles for n in a.names), *scene.inputs)
    known |= {n: sp.Symbol(n, real=True) for n in named} | {"t": TIME}
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
    """Return torque, parameters and inputs of a choice, and its control."""
    if scene.control != Control():
        return _controlled(scene)
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


def _controlled(scene: Scene) -> Data:
    """Return torque, control, and what these use of parameters and inputs."""
    data, words = scene.model_dump(exclude_unset=True), scene.control.words
    found = {"torque": data["torque"]} if scene.torque.components is None else _without(scene, ())
    used = {
        n: {**found.get(n, {}), **{k: v for k, v in data.get(n, {}).items() if k in words}}
        for n in ("parameters", "inputs")
    }
    return {**found, **used, "control": data["control"]}


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
    for q in (q for q in scene.full_system.parameters if q.name not in inertia):
        yield knob(q, numbers[q.name], "torque")
    yield from of_inputs(scene.full_system, {**start.states(scene, scene.full_system), **numbers})


def _states_at_start(scene: Scene) -> dict[str, float]:
    values = start.states(scene, scene.full_system)
    return {n: values.get(n, 0.0) for n in scene.full_system.state_names}


def _start_knobs(scene: Scene, used: str) -> list[Knob]:
    values = _states_at_start(scene)
    turned = used if used in SEQUENCES or scene.model == "spinner" else ""
    free = {
        *OMEGA.components,
        *(q.symbol for q in scene.full_system.states if q.name in scene.control.states),
    }
    kept = [q for q in scene.full_system.states if turned or q.symbol in free]
    return of_states(kept, values)


def _start_angles(scene: Scene, used: str) -> tuple[tuple[Attitude, ...], list[Knob]]:
    """Return the angles at the start of an attitude that is a quaternion."""
    if used != "quaternion":
        return (), []
    given = scene.initial_attitude
    if given is not None and given.quaternion is None:
        name = given.sequence
        angles = given.degrees or tuple(sp.deg(a).evalf() for a in given.radians or ())
    else:
        name, angles = SEQUENCE, _angles_of(scene, SEQUENCE)
    found, knobs = attitude_knobs([f"q{k}" for k in range(4)], name, angles)
    return (found,), knobs


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
