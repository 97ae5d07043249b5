"""From a scene to its systems and numbers: the general system, the smallest one, start values."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from eom import parse, reduce, solids, torques
from eom.errors import InputError, near_matches
from eom.kinematics import attitude, quaternion_of_sequence
from eom.kinematics import quaternion as quaternion_coordinates
from eom.reduce import Explanation, Reduction
from eom.rigidbody import OMEGA, full_inertia, principal_inertia, rigid_body
from eom.spinning import OMEGA as SPIN_RATE
from eom.spinning import PHI, PSI, PSI_DOT, SPIN, THETA, THETA_DOT, SpinningSymmetricBody
from eom.system import TIME, Assumption, Definition, Quantity, System

if TYPE_CHECKING:
    from eom.scene import Scene

Expr = Any

RESERVED_NAMES = frozenset({*parse.FUNCTIONS, *parse.CONSTANTS, "t"})
_SPINNER_STATES = (PSI, THETA, PHI, PSI_DOT, THETA_DOT, SPIN, SPIN_RATE)


def principal_values(scene: Scene) -> tuple[float, float, float]:
    """Return I1, I2, I3 (kg m^2) of a body that is given by moments or as a solid."""
    body, spinner = scene.body, scene.model == "spinner"
    if body.moments is not None:
        expected = {2} if spinner else {3}
        if len(body.moments) not in expected:
            raise InputError(
                "wrong number of moments",
                where="[body] moments",
                got=len(body.moments),
                expected="I1 (transverse) and I2 (about the axle)" if spinner else "I1, I2, I3",
            )
        first, second, *third = body.moments
        return (first, second, first) if spinner else (first, second, third[0])
    formulas = solids.principal_moments(str(body.solid))
    numbers = {
        sp.Symbol(n, positive=True): sp.Float(v)
        for n, v in (*body.size.items(), ("mass", body.mass))
    }
    a, b, c = (float(f.xreplace(numbers)) for f in formulas)
    if not spinner:
        return a, b, c
    if a != b:
        raise InputError(
            "a spinner is symmetric about its axle", where="[body] solid", got=body.solid
        )
    return a, c, a


def full_system(scene: Scene, *, general_torque: bool = False) -> System:
    """Return the system with every state and output; with a torque of three inputs if asked."""
    return (
        _spinner(scene, general_torque)
        if scene.model == "spinner"
        else _rigid_body(scene, general_torque)
    )


def _spinner(scene: Scene, general_torque: bool) -> System:
    states = {s.name: s for s in _SPINNER_STATES}
    components, parameters, inputs = _components(scene, states, ("M1", "M2", "M3"), general_torque)
    body = SpinningSymmetricBody(components, parameters, inputs)
    return body.system(scene.name, scene.title)


def _rigid_body(scene: Scene, general_torque: bool) -> System:
    chosen = None if scene.attitude == "none" else attitude(scene.attitude)
    coordinates = [q.symbol for q in chosen.coordinates] if chosen else []
    states = {s.name: s for s in (*OMEGA.components, *coordinates)}
    weight = scene.torque.weight

    def law(C: Expr, J: Expr) -> torques.Torque:
        if weight is not None:
            return torques.weight(C, [c != 0 for c in weight.centre_of_mass])
        if scene.torque.gravity_gradient is not None:
            return torques.gravity_gradient(C, J)
        return torques.applied(
            *_components(scene, states, ("tau_1", "tau_2", "tau_3"), general_torque)
        )

    inertia = principal_inertia() if scene.body.matrix is None else full_inertia()
    return rigid_body(inertia, law, chosen, name=scene.name, title=scene.title)


def _components(
    scene: Scene, states: dict[str, Expr], general: tuple[str, str, str], general_torque: bool
) -> tuple[tuple[Expr, Expr, Expr], tuple[Quantity, ...], tuple[Quantity, ...]]:
    """Parse the torque components; return them with the scene's own parameters and inputs.

    With ``general_torque`` each component that is zero is an input instead, of a name in ``general``.
    """
    groups = [
        tuple(
            Quantity(sp.Symbol(n, real=True), v.unit, v.meaning or "of the torque")
            for n, v in group.items()
        )
        for group in (scene.parameters, scene.inputs)
    ]
    own = {q.name: q.symbol for group in groups for q in group}
    _check_clash(scene, own, states)
    names = {**states, **own, "t": TIME}
    parsed = [
        parse.parse(c, names, f"[torque] components, number {k}")
        if isinstance(c, str)
        else sp.Rational(str(c))
        for k, c in enumerate(scene.torque.components or (0, 0, 0), 1)
    ]
    inputs = groups[1]
    if general_torque:
        free = [k for k, c in enumerate(parsed) if c == 0 and general[k] not in own]
        zero = {k: sp.Symbol(general[k], real=True) for k in free}
        parsed = [zero.get(k, c) for k, c in enumerate(parsed)]
        inputs = (*inputs, *(Quantity(s, "N m") for s in zero.values()))
    a, b, c = parsed
    return (a, b, c), groups[0], inputs


def _check_clash(scene: Scene, own: dict[str, Expr], states: dict[str, Expr]) -> None:
    fixed = (
        ("I1", "I2", "I3")
        if scene.model == "spinner"
        else ("I1", "I2", "I3", "J11", "J12", "J13", "J22", "J23", "J33")
    )
    both = [n for n in scene.parameters if n in scene.inputs]
    taken = [n for n in own if n in states or n in fixed] + both
    if taken:
        raise InputError(
            f"name {taken[0]!r} is used twice",
            where="[parameters] or [inputs]",
            expected="names that are not states, moments of inertia or each other's",
        )


Pass = tuple[System, Sequence[str], str]
"""A smaller system, the names of what it leaves out, and why."""


def derive(scene: Scene) -> tuple[System, Explanation]:
    """Apply the passes in order and record what each one left out and saved."""
    system = full_system(scene, general_torque=True)
    before = reduce.cost(system)
    notes: list[Reduction] = []
    for apply in (_given_torque, _equal_moments, _only_requested, _first_integrals):
        smaller, what, why = apply(scene, system)
        if what:
            notes.append(
                Reduction(", ".join(what), why, reduce.cost(system) - reduce.cost(smaller))
            )
        system = smaller
    full = _equal_moments(scene, scene.full_system)[0]
    candidates = [replace(d, expression=full.expand(d.expression)) for d in full.outputs]
    system = reduce.find_invariants(reduce.fold_definitions(system), candidates)
    return system, Explanation(tuple(notes), before, reduce.cost(system))


def _given_torque(scene: Scene, _: System) -> Pass:
    system = scene.full_system
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


def _equal_moments(scene: Scene, system: System) -> Pass:
    if scene.model == "spinner" or scene.body.matrix is not None:
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


def _only_requested(scene: Scene, system: System) -> Pass:
    smaller = reduce.prune(system, scene.requested)
    gone = [n for n in system.state_names if n not in smaller.state_names]
    gone += [
        n
        for n in (*system.parameter_names, *system.input_names)
        if n not in (*smaller.parameter_names, *smaller.input_names)
    ]
    return (
        smaller,
        gone,
        "neither the requested outputs nor the rates that they need depend on them",
    )


def _first_integrals(_: Scene, system: System) -> Pass:
    constant = reduce.constant_states(system)
    why = "first integrals: the rate is zero, so that the initial value serves as a parameter"
    return reduce.freeze(system, constant), [q.name for q in constant], why


def constants(scene: Scene) -> dict[str, float]:
    """Return the numbers of the scene that are no initial values, by parameter name."""
    values = {n: v.value for n, v in scene.parameters.items()}
    if scene.body.matrix is not None:
        values |= {
            f"J{i + 1}{j + 1}": scene.body.matrix[i][j] for i in range(3) for j in range(i, 3)
        }
    else:
        values |= {f"I{k}": v for k, v in enumerate(principal_values(scene), 1)}
    if scene.torque.weight is not None:
        weight = scene.torque.weight
        values |= {"m": weight.mass, "g": weight.gravity}
        values |= {f"r{k}": v for k, v in enumerate(weight.centre_of_mass, 1)}
    if scene.torque.gravity_gradient is not None:
        values["n"] = scene.torque.gravity_gradient.orbital_rate
    return values


def start(scene: Scene) -> dict[str, float]:
    """Return every state that the scene's initial values determine, by name.

    An output that is given must determine one missing state; it must be linear in it.
    """
    states = scene.full_system.state_names
    values = {n: v for n, v in scene.initial.items() if n in states}
    for name, value in _initial_attitude(scene).items():
        if name in values:
            raise InputError(
                f"{name} is given twice", where="[initial] and [initial_attitude]", got=name
            )
        values[name] = value
    for output in scene.full_system.outputs:
        if output.name in scene.initial:
            name, value = _state_of_output(scene, output, values)
            values[name] = value
    _check_constraints(scene, values)
    return values


def _state_of_output(
    scene: Scene, output: Definition, values: Mapping[str, float]
) -> tuple[str, float]:
    known = {
        **values,
        **constants(scene),
        **{n: v.value for n, v in scene.inputs.items()},
        "t": 0.0,
    }
    full = scene.full_system.expand(output.expression)
    rest = full.xreplace({s: sp.Float(known[s.name]) for s in full.free_symbols if s.name in known})
    missing = sorted(rest.free_symbols, key=str)
    slope = rest.diff(missing[0]) if len(missing) == 1 else sp.nan
    if not slope.is_number or slope in {0, sp.nan}:
        raise InputError(
            f"output {output.name!r} does not determine one missing state",
            where="[initial]",
            got=f"unknown: {', '.join(map(str, missing)) or 'nothing'}",
            hint="give the states themselves",
        )
    offset = rest.xreplace({missing[0]: sp.Integer(0)})
    return missing[0].name, float((scene.initial[output.name] - offset) / slope)


def _initial_attitude(scene: Scene) -> dict[str, float]:
    given = scene.initial_attitude
    if given is None:
        return {}
    wanted = "3-1-2" if scene.model == "spinner" else scene.attitude
    angles = given.radians or [math.radians(a) for a in given.degrees or ()]
    if angles and wanted == given.sequence:
        return {q.name: a for q, a in zip(attitude(wanted).coordinates, angles, strict=True)}
    if wanted not in {"quaternion", "dcm"}:
        raise InputError(
            f"initial attitude in other coordinates than attitude = {scene.attitude!r}",
            where="[initial_attitude]",
            got=f"sequence {given.sequence}" if angles else "quaternion",
            hint="give the angles of the chosen sequence, or choose quaternion or dcm",
        )
    q = given.quaternion or quaternion_of_sequence(given.sequence, angles)
    if wanted == "quaternion":
        return {f"q{k}": v for k, v in enumerate(q)}
    coordinates = quaternion_coordinates()
    matrix = coordinates.matrix.xreplace(
        {s: sp.Float(v) for s, v in zip(coordinates.symbols, q, strict=True)}
    )
    return {c.name: float(v) for c, v in zip(attitude("dcm").coordinates, matrix, strict=True)}


def _check_constraints(scene: Scene, values: Mapping[str, float]) -> None:
    """Refuse a quaternion without unit norm and direction cosines that are not orthonormal."""
    if scene.attitude == "none" or scene.model == "spinner":
        return
    for name, meaning, expression in attitude(scene.attitude).constraints:
        free = {s.name for s in expression.free_symbols}
        if free <= set(values):
            found = float(
                expression.xreplace({s: sp.Float(values[s.name]) for s in expression.free_symbols})
            )
            expected = 0 if name.startswith("C_column") and name[-1] != name[-2] else 1
            if abs(found - expected) > 1e-9:
                raise InputError(
                    f"{scene.attitude} at the start is no rotation",
                    where="[initial]",
                    got=f"{meaning} = {found!r}",
                    expected=f"{expected} to within 1e-9",
                    hint="[initial_attitude] takes angles and makes them exact",
                )


def pick(
    values: Mapping[str, float], names: Iterable[str], kind: str, where: str
) -> dict[str, float]:
    """Return ``values`` of ``names``, in order. Raises `InputError` that lists the missing ones."""
    names = tuple(names)
    missing = [n for n in names if n not in values]
    if missing:
        unused = [n for n in values if n not in names]
        hint = near_matches(missing[0], unused) if unused else ""
        raise InputError(
            f"missing {kind}: {', '.join(missing)}",
            where=where,
            hint=hint if hint.startswith("did") else "",
        )
    return {n: values[n] for n in names}
