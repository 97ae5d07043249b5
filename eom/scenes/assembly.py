"""From the description of a scene to its systems: the general one, and the smallest one."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import reduce as reduce_by
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.kinematics.coordinates import (
    Attitude,
    RotationSequence,
    attitude,
    quaternion,
    rotation_sequence,
)
from eom.mechanics import sequence_angles, torques
from eom.mechanics.rigidbody import OMEGA, full_inertia, principal_inertia, rigid_body
from eom.mechanics.spinning import (
    I1,
    I2,
    PHI,
    PSI,
    PSI_DOT,
    SPIN,
    THETA,
    THETA_DOT,
    SpinningSymmetricBody,
)
from eom.mechanics.spinning import OMEGA as SPIN_RATE
from eom.quantities import TIME, Assumption, Quantity
from eom.scenes import parse, reduce
from eom.scenes.description import Description, inertia_values, principal_values
from eom.scenes.naming import check_used
from eom.scenes.reduce import Explanation, Pass
from eom.scenes.start import initial_names, sizes
from eom.scenes.stated import Stated
from eom.system import System

Expr = Any
Triple = tuple[Expr, Expr, Expr]

MODEL_NAMES = frozenset(
    [
        *(f"{n}_{k}" for n in "h H torque up radial normal axle".split() for k in (1, 2, 3)),
        *(f"J{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)),
        *("I1", "I2", "I3", "T", "E", "H", "tilt", "q_norm", "Omega"),
    ]
)
"""Names that the models give to moments of inertia, definitions and outputs."""
_SPINNER_STATES = (PSI, THETA, PHI, PSI_DOT, THETA_DOT, SPIN, SPIN_RATE)
_SPINNER_UNITS = {
    **dict.fromkeys(map(str, (PSI, THETA, PHI)), "rad"),
    **dict.fromkeys(map(str, (PSI_DOT, THETA_DOT, SPIN, SPIN_RATE)), "rad/s"),
    **dict.fromkeys(map(str, (I1, I2)), "kg m^2"),
}


def full_system(scene: Description, *, general_torque: bool = False) -> System:
    """Return the system with every state and output; with a torque of three inputs if asked."""
    return (
        _spinner(scene, general_torque)
        if scene.model == "spinner"
        else _rigid_body(scene, general_torque)
    )


def _spinner(scene: Description, general_torque: bool) -> System:
    whole = reduce_by(operator.add, _torques(scene, general_torque)[0].values())
    body = SpinningSymmetricBody(
        whole.components.components, whole.parameters, whole.inputs, whole.potential,
        whole.reference_point or "centre of mass", whole.numbers,
    )  # fmt: skip
    return _through_singular(body.system(scene.name, scene.title), UNSPUN)


def _rigid_body(scene: Description, general_torque: bool) -> System:
    named, formulas = _torques(scene, general_torque)
    whole = reduce_by(operator.add, named.values())
    chosen = _attitude(scene)
    system = rigid_body(
        _inertia(scene), lambda C, J: whole, chosen, name=scene.name, title=scene.title
    )
    if not scene.sequence:
        return _through_singular(system, WAY_OUT)
    return _with_angles(system, rotation_sequence(scene.sequence), formulas)


def _attitude(scene: Description) -> Attitude | None:
    return None if scene.coordinates == "none" else attitude(scene.coordinates)


def _inertia(scene: Description) -> tuple[Expr, tuple[Quantity, ...]]:
    return principal_inertia() if inertia_values(scene) is None else full_inertia()


def torques_of(scene: Description) -> dict[str, torques.Torque]:
    """Return the torques that act, by their fields of `eom.scenes.description.Torque`; they add up."""
    return _torques(scene, general_torque=False)[0]


def _torques(scene: Description, general_torque: bool) -> tuple[dict[str, torques.Torque], Triple]:
    """Return the torques, components always among them, and the formulas of components as read."""
    if scene.model == "spinner":
        return _of_spinner(scene, general_torque)
    chosen, (J, moments) = _attitude(scene), _inertia(scene)
    said = {n: getattr(scene.torque, n) for n in LAWS if getattr(scene.torque, n) is not None}
    found = {n: LAWS[n](of, chosen.matrix, J) for n, of in said.items()} if chosen else {}
    angles = rotation_sequence(scene.sequence) if scene.sequence else None
    known = (
        *(chosen.coordinates if chosen else ()),
        *(angles.coordinates if angles else ()),
        *moments,
        *(q for torque in found.values() for q in torque.parameters),
    )
    names = _names((*OMEGA.components, *(q.symbol for q in known)))
    units = {
        **dict.fromkeys(map(str, OMEGA.components), "rad/s"),
        **{q.name: q.unit for q in known},
    }
    general = ("tau_1", "tau_2", "tau_3")
    given = components(scene, names, general, general_torque and not found, units)
    found["components"] = torques.applied(_over_states(given[0], angles), *given[1:])
    found["components"] = replace(found["components"], numbers=_numbers(scene))
    return found, given[0]


def _of_spinner(
    scene: Description, general_torque: bool
) -> tuple[dict[str, torques.Torque], Triple]:
    """Return the torques on a spinner, that of its weight over psi and theta, as `_torques` does."""
    found = {}
    if scene.torque.weight is not None:
        C = SpinningSymmetricBody((0, 0, 0)).C_BI.matrix
        found["weight"] = LAWS["weight"](scene.torque.weight, C, None).inlined()
    known = [q for torque in found.values() for q in torque.parameters]
    names = _names((*_SPINNER_STATES, I1, I2, *(q.symbol for q in known)))
    units = {**_SPINNER_UNITS, **{q.name: q.unit for q in known}}
    given = components(scene, names, ("M1", "M2", "M3"), general_torque and not found, units)
    whole = replace(torques.applied(*given), numbers=_numbers(scene))
    return {**found, "components": whole}, given[0]


def _names(symbols: Iterable[Expr]) -> dict[str, Expr]:
    return {s.name: s for s in symbols}


LAWS: dict[str, Callable[[Any, Expr, Expr], torques.Torque]] = {
    "weight": lambda said, C, _: torques.weight(C, [c != 0 for c in said.centre_of_mass]),
    "gravity_gradient": lambda _, C, J: torques.gravity_gradient(C, J),
}
"""Torques that are derived from forces, by their fields of `eom.scenes.description.Torque`, of these."""


WAY_OUT = 'integrate = "quaternion" in the scene goes through it, and shows the same angles'
UNSPUN = (
    'model = "rigid body" with attitude = "3-1-2" and integrate = "quaternion" goes through it, '
    "its torque along axes that turn with the body"
)
"""What the message of a run that stops at a singular configuration advises."""


def _through_singular(system: System, hint: str) -> System:
    """Return a system whose singular configurations name the way through them."""
    return replace(system, singularities=tuple(replace(s, hint=hint) for s in system.singularities))


def _with_angles(system: System, angles: RotationSequence, parts: Triple) -> System:
    """Return a system with angles as outputs, and singular where formulas need an undefined one."""
    q = quaternion().symbols
    read = {s for e in parts for s in e.free_symbols} & {angles.angles[0], angles.angles[2]}
    undirected = (sequence_angles.undirected(angles, q),) if read else ()
    return replace(sequence_angles.with_angles(system, angles, q), singularities=undirected)


def _over_states(parts: Triple, angles: RotationSequence | None) -> Triple:
    """Return the torque over the quaternion where its formulas may name angles that are outputs."""
    if angles is None:
        return parts
    q, where = quaternion().symbols, "[torque] components"
    a, b, c = (sequence_angles.over_quaternion(e, angles, q, where) for e in parts)
    return a, b, c


def components(
    scene: Description,
    known: dict[str, Expr],
    general: tuple[str, str, str],
    general_torque: bool,
    units: Mapping[str, str],
) -> tuple[tuple[Expr, Expr, Expr], tuple[Quantity, ...], tuple[Quantity, ...]]:
    """Parse the torque components; return them with the scene's own parameters and inputs in them.

    ``known``: symbols of states and of what the body and the other torques define, by name, and their
    ``units``. With ``general_torque`` each component that is zero is an input instead, of a name in
    ``general``.
    """
    groups = [
        tuple(
            Quantity(sp.Symbol(n, real=True), v.unit, v.meaning or "of the torque")
            for n, v in group.items()
        )
        for group in (scene.parameters, scene.inputs)
    ]
    own = {q.name: q.symbol for group in groups for q in group}
    _check_clash(scene, own, {**known, **sizes(scene)})
    names = {**known, **sizes(scene), **own, "t": TIME}
    spoken = {**units, **dict.fromkeys(scene.body.size, "m"), "mass": "kg", "t": "s"}
    stated = Stated(spoken, {q.name: q.unit for group in groups for q in group})
    parsed = _parsed(scene, names, stated)
    acting = set().union(*(c.free_symbols for c in parsed))
    groups = [tuple(q for q in group if q.symbol in acting) for group in groups]
    used = {str(s.name) for s in acting} | initial_names(scene) | scene.control.words
    check_used(own, used, "use it in [torque] components, [control] or [initial], or remove it")
    inputs = groups[1]
    if general_torque:
        free = [k for k, c in enumerate(parsed) if c == 0 and general[k] not in own]
        zero = {k: sp.Symbol(general[k], real=True) for k in free}
        parsed = [zero.get(k, c) for k, c in enumerate(parsed)]
        inputs = (*inputs, *(Quantity(s, "N m") for s in zero.values()))
    a, b, c = parsed
    return (a, b, c), groups[0], inputs


def _numbers(scene: Description) -> str:
    """Return what numbers in the equations are: a row of `eom.system.NUMBERS`."""
    return "decimals" if parse.has_decimals(scene.torque.components) else "values"


def _parsed(scene: Description, names: dict[str, Expr], stated: Stated) -> list[Expr]:
    """Return the torque components as expressions. Raises `InputError` for other dimensions."""
    found = []
    for k, c in enumerate(scene.torque.components or (0, 0, 0), 1):
        where = f"[torque] components, number {k}"
        stated.check(c, where, "N m")
        if isinstance(c, str):
            found.append(parse.parse(c, names, where, unit="N m"))
        else:
            found.append(sp.Rational(str(c)))
    return found


def _check_clash(scene: Description, own: dict[str, Expr], known: dict[str, Expr]) -> None:
    both = [n for n in scene.parameters if n in scene.inputs]
    taken = [n for n in own if n in known or n in MODEL_NAMES] + both
    if taken:
        raise InputError(
            f"name {taken[0]!r} is used twice",
            where="[parameters] or [inputs]",
            expected="names that are not states, outputs, moments of inertia, each other's, or those that "
            "the scene's body and torque define",
        )


def passes(scene: Description, full: System, requested: Sequence[str]) -> dict[str, Pass]:
    """Return what makes the system of a general torque the smallest one for ``requested`` names.

    ``full``: the system of `full_system`.
    """
    general = equal_moments(scene, full)
    turning = {n for a in general.angles for n in a.names}
    candidates = [
        replace(d, expression=general.expand(d.expression))
        for d in general.outputs
        if d.name not in turning
    ]
    smaller = reduce.only(requested, reduce.expanded)
    return {
        "torque": lambda _: _given_torque(scene, full),
        "moments": lambda system: _equal_moments(scene, system),
        "outputs": lambda system: smaller(replace(system, invariants=())),
        "integrals": _first_integrals,
        "definitions": lambda system: (
            reduce.find_invariants(reduce.fold_definitions(system), candidates), (), "",
        ),
    }  # fmt: skip


def derive(
    scene: Description, full: System, requested: Sequence[str]
) -> tuple[System, Explanation]:
    """Return the smallest system for the ``requested`` names, and what each pass left out.

    ``full``: the system of `full_system`.
    """
    general = full_system(scene, general_torque=True)
    system, steps = reduce.reduced(general, passes(scene, full, requested))
    return system, Explanation(reduce.reductions(steps), reduce.cost(general), reduce.cost(system))


Smaller = tuple[System, Sequence[str], str]


def _given_torque(scene: Description, system: System) -> Smaller:
    components = {d.name[-1]: d.expression for d in system.outputs if d.name.startswith("torque_")}
    letter = "M" if scene.model == "spinner" else "tau_"
    zero = [f"{letter}{k}" for k, component in components.items() if component == 0]
    if not zero:
        return system, (), ""
    free = len(zero) == 3
    meaning = "no external torque" if free else f"no torque component {', '.join(zero)}"
    own = {*system.parameter_names, *system.input_names}
    symbols = tuple(sp.Symbol(n, real=True) for n in zero if n not in own)
    assumption = Assumption("torque_free" if free else "torque_components", meaning, vanish=symbols)
    system = replace(system, assumptions=(*system.assumptions, assumption))
    return system, [f"{n} = 0" for n in zero], "the scene has no such torque"


def _equal_moments(scene: Description, system: System) -> Smaller:
    if scene.model == "spinner" or inertia_values(scene) is not None:
        return system, (), ""
    values = principal_values(scene)
    symbols = [sp.Symbol(f"I{k}", positive=True) for k in (1, 2, 3)]
    first = {k: values.index(v) for k, v in enumerate(values)}
    equal = {symbols[k]: symbols[j] for k, j in first.items() if j != k}
    if not equal:
        return system, (), ""
    names = [f"{b} == {a}" for a, b in equal.items()]
    system = reduce.substitute(system, equal)
    found = tuple(
        Assumption(n, "equal moments of inertia", vanish=(a - b,))
        for n, (a, b) in zip(names, equal.items(), strict=True)
    )
    return (
        replace(system, assumptions=(*system.assumptions, *found)),
        names,
        "the scene's moments of inertia are equal",
    )


def equal_moments(scene: Description, system: System) -> System:
    """Return a system with those moments of inertia made one that the scene has equal."""
    return _equal_moments(scene, system)[0]


def _first_integrals(system: System) -> Smaller:
    constant = reduce.constant_states(system)
    why = "first integrals: the rate is zero, so that the initial value serves as a parameter"
    return reduce.freeze(system, constant), [q.name for q in constant], why
