"""One motion in two sets of coordinates: Euler angles, and the unit quaternion near their singularity.

With i-j-k the axes of a sequence, e_i of the reference frame A and e_k of the body B, and s = cos theta
for i != k, s = sin theta for i = k (Hughes, Spacecraft Attitude Dynamics (1986), sect. 2.3):

    v = C e_i  depends on theta, phi alone,  w = C^T e_k  on theta, psi alone,
    |s| = the part of w across e_i,  theta, psi, phi = atan2 of components of v and w.

The angles (psi, theta, phi) and (psi + pi, pi - theta or -theta, phi + pi) are the same attitude, with
opposite s: the sign of s, the branch, tells which is meant. All of it is smooth but psi and phi at s = 0,
where psi +- phi alone has a meaning: the third angle is then found from the attitude and the first.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.kinematics.coordinates import (
    SEQUENCES,
    RotationSequence,
    elementary,
    quaternion,
    rotation_sequence,
)
from eom.kinematics.frames import unit_vector
from eom.mechanics import torques
from eom.mechanics.rigidbody import OMEGA, full_inertia, principal_inertia, rigid_body
from eom.mechanics.spinning import OMEGA as SPIN_RATE
from eom.mechanics.spinning import PHI, PSI, PSI_DOT, SPIN, THETA, THETA_DOT
from eom.quantities import Definition, Quantity, Singularity
from eom.rotations import quaternion_product
from eom.scenes import assembly, reduce, start
from eom.scenes.description import Description, inertia_values
from eom.scenes.scene import Scene
from eom.system import Charts, Expr, System, as_expression

BRANCH = sp.Symbol("branch", real=True)
FIRST = sp.Symbol("first_angle", real=True)
LEAVE = sp.Rational(1, 5)
"""|s| at which the motion goes back to angles; it leaves them at `Charts.enter`."""
ENTER = 0.1
SPINNER = rotation_sequence("3-1-2", (PSI, THETA, PHI))


def charts(scene: Scene) -> Charts:
    """Return a scene's motion in its angles, and in the quaternion with the transfers both ways.

    All angles are kept, as the attitude is needed. Raises `InputError` where the coordinates of the
    scene are not a rotation sequence.
    """
    spinner = scene.model == "spinner"
    if not spinner and scene.attitude not in SEQUENCES:
        raise InputError(
            "only Euler angles are handed over",
            where="[integration] handover",
            got=f"attitude = {scene.attitude!r}",
            expected="one of the 12 rotation sequences, or the model spinner",
        )
    angles = SPINNER if spinner else rotation_sequence(scene.attitude)
    rates = ("theta_dot", "psi_dot", "C") if spinner else ("omega_1", "omega_2", "omega_3")
    requested = (*scene.requested, *(q.name for q in angles.coordinates), *rates)
    first, _ = assembly.derive(scene, scene.full_system, tuple(dict.fromkeys(requested)))
    places = [first.state_names.index(a.name) for a in angles.angles]
    returned = _returned(angles) | (_spinner_rates(angles) if spinner else {})
    second = _second(scene, first, angles, returned)
    forth = (
        [*_body_rates(angles), *_quaternion(angles)] if spinner else _quaternion_and_rates(angles)
    )
    return Charts(
        first,
        second,
        _transfer(first, "forth", {q.symbol: e for q, e in zip(second.states, forth, strict=True)}),
        _transfer(
            second,
            "back",
            {q.symbol: returned.get(q.symbol, q.symbol) for q in first.states}
            | {
                sp.Symbol("third_angle", real=True): _third(angles, returned),
                sp.Symbol("distance", real=True): _distance(angles),
            },
            (Quantity(BRANCH), Quantity(FIRST)),
        ),
        (places[0], places[1], places[2]),
        angles.axes[0] == angles.axes[2],
        ENTER,
    )


def numbers(scene: Scene, found: Charts) -> tuple[dict[str, float], dict[str, float]]:
    """Return the initial values of the first of a scene's charts, and the parameters of both.

    Raises `InputError` that lists what is missing.
    """
    values = start.states(scene, scene.full_system) | start.constants(scene)
    systems = found.first, found.second
    names = [n for s in systems for n in s.parameter_names if n != BRANCH.name]
    where = "[parameters] or [initial]"
    return (
        start.pick(values, found.first.state_names, "initial value", "[initial]"),
        start.pick(values, dict.fromkeys(names), "parameter", where),
    )


def _transfer(
    system: System, name: str, results: Mapping[Expr, Expr], further: tuple[Quantity, ...] = ()
) -> System:
    """Return the states of a system at rest, with states of another as outputs."""
    named = [
        Definition(Quantity(sp.Symbol(f"to_{s.name}", real=True)), e) for s, e in results.items()
    ]
    own = {q.symbol for q in system.parameters}
    return System(
        f"{system.name}_{name}",
        system.states,
        tuple(sp.Integer(0) for _ in system.states),
        (*system.parameters, *(q for q in further if q.symbol not in own)),
        outputs=tuple(named),
    )


def _axes(angles: RotationSequence) -> tuple[Expr, Expr, Expr]:
    i, j, k = (unit_vector("A", axis).column for axis in angles.axes)
    return i, j, k


def _across(angles: RotationSequence) -> tuple[Expr, Expr]:
    """Return s cos(psi) and s sin(psi), s the singular function, from the quaternion."""
    i, j, k = _axes(angles)
    w = quaternion().matrix.T * k
    one = j.cross(i) if angles.axes[0] == angles.axes[2] else k
    other = i.cross(one)
    return sp.expand(w.dot(one)), sp.expand(w.dot(other))


def _distance(angles: RotationSequence) -> Expr:
    """Return |s| over the quaternion."""
    return sp.sqrt(sp.Add(*(a**2 for a in _across(angles))))


def _returned(angles: RotationSequence) -> dict[Expr, Expr]:
    """Return the three angles, psi in (-pi, pi] and so on, over the quaternion and the branch."""
    i, j, k = _axes(angles)
    v = quaternion().matrix * i
    x, y = _across(angles)
    size = BRANCH * _distance(angles)
    if angles.axes[0] == angles.axes[2]:
        theta = sp.atan2(size, v.dot(i))
        phi = sp.atan2(BRANCH * v.dot(j), -BRANCH * v.dot(j.cross(i)))
    else:
        theta = sp.atan2(-k.dot(j.cross(i)) * v.dot(k), size)
        phi = sp.atan2(-BRANCH * v.dot(k.cross(i)), BRANCH * v.dot(i))
    return dict(zip(angles.angles, (sp.atan2(BRANCH * y, BRANCH * x), theta, phi), strict=True))


def _third(angles: RotationSequence, returned: Mapping[Expr, Expr]) -> Expr:
    """Return the third angle of the attitude whose first angle is `FIRST`, defined for s = 0 as well."""
    _, _, k = _axes(angles)
    p = unit_vector("A", angles.axes[2] % 3 + 1).column
    middle = elementary(angles.axes[1], returned[angles.angles[1]])
    turned = quaternion().matrix * (middle * elementary(angles.axes[0], FIRST)).T * p
    return sp.atan2(-k.cross(p).dot(turned), p.dot(turned))


def _quaternion(angles: RotationSequence) -> list[Expr]:
    """Return the quaternion over the angles: the product of three turns."""
    q: tuple[Expr, ...] = (sp.Integer(1), sp.Integer(0), sp.Integer(0), sp.Integer(0))
    for axis, angle in zip(angles.axes, angles.angles, strict=True):
        turn = [sp.cos(angle / 2), *(sp.Integer(0),) * 3]
        turn[axis] = sp.sin(angle / 2)
        q = quaternion_product(q, turn)
    return list(q)


def _quaternion_and_rates(angles: RotationSequence) -> list[Expr]:
    return [*OMEGA.components, *_quaternion(angles)]


def _body_rates(angles: RotationSequence) -> list[Expr]:
    """Return the spinner's angular velocity in the body, over theta', psi', C and the angles."""
    omega = sp.Matrix([THETA_DOT, SPIN, PSI_DOT * sp.cos(THETA)])
    return list(elementary(angles.axes[2], PHI) * omega)


def _spinner_rates(angles: RotationSequence) -> dict[Expr, Expr]:
    """Return theta', psi', C and the spin rate from omega; b1 is across the axle b2 and a3."""
    b1, b3 = _tilt_axes()
    x, y, z = (sp.Matrix(OMEGA.components).dot(b) for b in (b1, sp.Matrix([0, 1, 0]), b3))
    psi_dot = z / (BRANCH * _distance(angles))
    along = quaternion().matrix[1, 2]
    return {THETA_DOT: x, PSI_DOT: psi_dot, SPIN: y, SPIN_RATE: y - psi_dot * along}


def _tilt_axes() -> tuple[Expr, Expr]:
    """Return the axes b1 and b3 that do not spin, components in the body: b1 cos(theta) = b2 x a3."""
    a3, b2 = quaternion().matrix * sp.Matrix([0, 0, 1]), sp.Matrix([0, 1, 0])
    b1 = b2.cross(a3) / (BRANCH * _distance(SPINNER))
    return b1, b1.cross(b2)


def _second(
    scene: Description, first: System, angles: RotationSequence, returned: Mapping[Expr, Expr]
) -> System:
    """Return the motion over angular velocity and quaternion, with the outputs of ``first``."""
    full = _spinning(scene, returned) if scene.model == "spinner" else _rigid(scene, returned)
    if BRANCH not in {q.symbol for q in full.parameters}:
        full = replace(full, parameters=(*full.parameters, Quantity(BRANCH)))
    outputs = _same_outputs(scene, first, full, returned)
    states = {*full.state_names}
    kept = reduce.prune(replace(full, outputs=outputs), [*states, *(d.name for d in outputs)])
    back = sp.Add(*(a**2 for a in _across(angles))) - LEAVE**2
    singular = [Singularity(back, kept.states[-1].symbol, "the angles are regular again")]
    if BRANCH in set().union(*(kept.expand(r).free_symbols for r in kept.rates)):
        singular.append(
            Singularity(_distance(angles), kept.states[-1].symbol, "the torque has no direction")
        )
    used = set().union(*(kept.expand(d.expression).free_symbols for d in kept.outputs))
    used = used.union(*(kept.expand(r).free_symbols for r in kept.rates))
    further = (Quantity(BRANCH, "1", "sign of the singular function"),) if BRANCH in used else ()
    return replace(
        kept,
        name=f"{first.name}_quaternion",
        parameters=(*(q for q in kept.parameters if q.symbol != BRANCH), *further),
        invariants=(),
        singularities=tuple(singular),
    )


def _rigid(scene: Description, returned: Mapping[Expr, Expr]) -> System:
    if scene.torque.weight is not None or scene.torque.gravity_gradient is not None:
        full = assembly.full_system(scene.model_copy(update={"attitude": "quaternion"}))
        return assembly.equal_moments(scene, full)
    symbols = (*OMEGA.components, *rotation_sequence(scene.attitude).angles)
    states = {s.name: s for s in symbols}
    parts, own, inputs = assembly.components(scene, states, ("tau_1", "tau_2", "tau_3"), False)
    inertia = principal_inertia() if inertia_values(scene) is None else full_inertia()
    turned = tuple(c.xreplace(dict(returned)) for c in parts)
    full = _with_torque(scene, turned, own, inputs, inertia)
    return assembly.equal_moments(scene, full)


def _spinning(scene: Description, returned: Mapping[Expr, Expr]) -> System:
    states = {s.name: s for s in (PSI, THETA, PHI, PSI_DOT, THETA_DOT, SPIN, SPIN_RATE)}
    parts, own, inputs = assembly.components(scene, states, ("M1", "M2", "M3"), False)
    m1, m2, m3 = (c.xreplace(dict(returned)) for c in parts)
    b1, b3 = _tilt_axes()
    torque = [sp.expand(m1 * b1[k] + m3 * b3[k]) for k in range(3)]
    turned = torque[0], torque[1] + m2, torque[2]
    full = _with_torque(scene, turned, own, inputs, principal_inertia())
    return reduce.substitute(full, {sp.Symbol("I3", positive=True): sp.Symbol("I1", positive=True)})


def _with_torque(scene: Description, parts: Any, own: Any, inputs: Any, inertia: Any) -> System:
    branch = () if BRANCH in {q.symbol for q in own} else (Quantity(BRANCH),)
    needs = any(BRANCH in as_expression(c).free_symbols for c in parts)
    law = torques.applied(parts, (*own, *(branch if needs else ())), inputs)
    return rigid_body(inertia, lambda C, J: law, quaternion(), name=scene.name, title=scene.title)


_COMMON = frozenset({"T", "H", "H_1", "H_2", "H_3"})
"""Outputs that both models have and mean alike."""


def _same_outputs(
    scene: Description, first: System, full: System, returned: Mapping[Expr, Expr]
) -> tuple[Definition, ...]:
    """Return the outputs and constants of the motion of ``first`` over the states of ``full``."""
    wanted = {d.name: d for d in (*first.outputs, *first.invariants)}
    known = {d.name: d for d in full.outputs}
    spinner = scene.model == "spinner"
    common = _COMMON if spinner else frozenset(known)
    axle = {f"axle_{k + 1}": quaternion().matrix[1, k] for k in range(3)} if spinner else {}
    parameters = {q.symbol for q in first.parameters}
    frozen = {s: e for s, e in returned.items() if s in parameters}
    found = []
    for name, d in wanted.items():
        if name in known and name in common:
            found.append(known[name])
        elif name in axle or _is_periodic(first.expand(d.expression), returned):
            over = axle.get(name, first.expand(d.expression).xreplace({**returned, **frozen}))
            found.append(replace(d, expression=over))
    return tuple(found)


def _is_periodic(expression: Expr, returned: Mapping[Expr, Expr]) -> bool:
    """Tell whether angles stand in sines and cosines alone, so that whole turns do not matter."""
    angles = {s for s in returned if s not in {THETA_DOT, PSI_DOT, SPIN, SPIN_RATE}}
    inside = expression.atoms(sp.sin, sp.cos, sp.tan)
    hidden = {f: sp.Dummy() for f in inside if all(c.is_Integer for c in _factors(f, angles))}
    return not (expression.xreplace(hidden).free_symbols & angles)


def _factors(function: Expr, angles: set[Expr]) -> list[Expr]:
    """Return by what angles are multiplied inside a function."""
    return [function.args[0].diff(a) for a in angles]
