"""The numbers of a scene: parameters, and the states at the start."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from typing import Any

import sympy as sp

from eom.errors import InputError, near_matches
from eom.kinematics.coordinates import attitude, constraint_value, quaternion_of_sequence
from eom.kinematics.coordinates import quaternion as quaternion_coordinates
from eom.quantities import Definition
from eom.rotations import angles_of_matrix, matrix_of_quaternion
from eom.scenes import parse
from eom.scenes.description import (
    Description,
    InitialAttitude,
    inertia_values,
    of_norm_one,
    principal_values,
)
from eom.scenes.given import Place
from eom.scenes.stated import Stated
from eom.system import System
from eom.units import in_unit

Expr = Any
QUATERNION = ("q0", "q1", "q2", "q3")


def constants(scene: Description) -> dict[str, float]:
    """Return the numbers of the scene that are no initial values, by parameter name."""
    values = {n: v.value for n, v in scene.parameters.items()}
    matrix = inertia_values(scene)
    if matrix is not None:
        values |= {f"J{i + 1}{j + 1}": matrix[i][j] for i in range(3) for j in range(i, 3)}
    else:
        moments = principal_values(scene)[: 2 if scene.model == "spinner" else 3]
        values |= {f"I{k}": v for k, v in enumerate(moments, 1)}
    if scene.torque.weight is not None:
        weight = scene.torque.weight
        values |= {"m": weight.mass, "g": weight.gravity}
        values |= {f"r{k}": v for k, v in enumerate(weight.centre_of_mass, 1) if v}
    if scene.torque.gravity_gradient is not None:
        values["n"] = scene.torque.gravity_gradient.orbital_rate
    return values


def places(scene: Description) -> dict[str, Place]:
    """Return where the numbers of `constants`, and the sizes of a solid, are said in the scene's file."""
    body, weight = scene.body, ("torque", "weight")
    found: dict[str, Place] = {}
    if body.solid is not None:
        because = f"set {', '.join(('mass', *body.size))} of the {body.solid}"
        found |= {n: Place("kg m^2", (), because) for n in constants(scene) if n[0] in "IJ"}
        found |= {n: Place("m", (("body", "size", n),)) for n in body.size}
    elif body.matrix is not None:
        pairs = [(i, j) for i in range(3) for j in range(i, 3)]
        found |= {
            f"J{i + 1}{j + 1}": Place(
                "kg m^2", (("body", "matrix", i, j), ("body", "matrix", j, i))[: 1 + (i != j)]
            )
            for i, j in pairs
        }
    else:
        moments = range(len(body.moments or ()))
        found |= {f"I{k + 1}": Place("kg m^2", (("body", "moments", k),)) for k in moments}
    masses = (("body", "mass"),) if body.mass is not None else ()
    if scene.torque.weight is not None:
        masses = (*masses, (*weight, "mass"))
        found |= {"m": Place("kg", masses), "g": Place("m/s^2", ((*weight, "gravity"),))}
        found |= {f"r{k + 1}": Place("m", ((*weight, "centre_of_mass", k),)) for k in range(3)}
    if masses:
        found["mass"] = Place("kg", masses)
    if scene.torque.gravity_gradient is not None:
        found["n"] = Place("rad/s", (("torque", "gravity_gradient", "orbital_rate"),))
    return found


def attitude_groups(scene: Description) -> tuple[tuple[str, ...], ...]:
    """Return the names of angles, and of coordinates, of which each group is the attitude."""
    if scene.model == "spinner":
        return (tuple(q.name for q in attitude("3-1-2").coordinates),)
    kinds = dict.fromkeys(k for k in (scene.sequence, scene.coordinates) if k not in {"", "none"})
    return tuple(tuple(q.name for q in attitude(kind).coordinates) for kind in kinds)


def attitude_names(scene: Description) -> frozenset[str]:
    """Return the names of all coordinates and angles of the attitude."""
    return frozenset(n for group in attitude_groups(scene) for n in group)


def attitude_at_start(scene: Description, names: tuple[str, ...]) -> dict[str, float]:
    """Return the attitude at the start in one of `attitude_groups`, as far as the scene gives it."""
    values = {**initial(scene), **_turned(scene), **_initial_attitude(scene)}
    quaternion = [values[q] for q in QUATERNION if q in values]
    if not {*names} <= {*values} and scene.sequence and len(quaternion) == len(QUATERNION):
        turned = angles_of_matrix(matrix_of_quaternion(quaternion), scene.sequence)
        values |= dict(zip(attitude_groups(scene)[0], turned, strict=True))
    return {n: values[n] for n in names if n in values}


def sizes(scene: Description) -> dict[str, Expr]:
    """Return the mass and the sizes of a solid as exact numbers, by the names that formulas use."""
    body = scene.body
    given = {**body.size, **({} if body.mass is None else {"mass": body.mass})}
    return {n: sp.Rational(str(v)) for n, v in given.items()}


def initial_names(scene: Description) -> set[str]:
    """Return the names that formulas of initial values use."""
    return {str(s.name) for e in _formulas(scene).values() for s in e.free_symbols}


def initial(scene: Description) -> dict[str, float]:
    """Return the given initial values as numbers. Raises `InputError` for formulas that have none."""
    values = constants(scene)
    formulas = _formulas(scene)
    return {
        name: number(formulas[name], values, f"[initial] {name}")
        if name in formulas
        else float(value)
        for name, value in scene.initial.items()
    }


def _formulas(scene: Description) -> dict[str, Expr]:
    """Return the initial values that are formulas, over parameters and what the scene defines."""
    names = {n: sp.Symbol(n, real=True) for n in constants(scene)} | sizes(scene)
    texts = {n: v for n, v in scene.initial.items() if isinstance(v, str)}
    return {n: parse.parse(text, names, f"[initial] {n}") for n, text in texts.items()}


def number(expression: Expr, values: Mapping[str, float], where: str) -> float:
    """Return a formula for numbers of its symbols by name. Raises `InputError` where it has none."""
    numbers = {s: sp.Float(values[s.name]) for s in expression.free_symbols}
    value = sp.N(expression.xreplace(numbers))
    if not value.is_real or not math.isfinite(value):
        raise InputError("no finite number", where=where, got=f"{expression} = {value}")
    return float(value)


def in_coordinates(given: InitialAttitude, wanted: str, where: str) -> tuple[float, ...]:
    """Return an attitude in ``wanted`` coordinates: a sequence's angles (rad), else as a quaternion.

    Raises `InputError` for angles of another sequence.
    """
    angles = given.radians or tuple(math.radians(a) for a in given.degrees or ())
    if angles and wanted == given.sequence:
        return angles
    if wanted not in {"quaternion", "dcm"}:
        raise InputError(
            f"initial attitude in other coordinates than attitude = {wanted!r}",
            where=where,
            got=f"sequence {given.sequence}" if angles else "quaternion",
            hint="give the angles of the chosen sequence, or choose quaternion or dcm",
        )
    if given.quaternion:
        return of_norm_one(given.quaternion, where)
    return quaternion_of_sequence(given.sequence, angles)


def states(scene: Description, full: System) -> dict[str, float]:
    """Return every state that the scene's initial values determine, by name.

    An output that is given must determine one missing state; it must be linear in it.
    """
    _check_units(scene, full)
    states, given = full.state_names, initial(scene)
    values = dict.fromkeys(scene.control.states, 0.0)
    values |= {n: v for n, v in given.items() if n in states or n in scene.control.stepped}
    if scene.coordinates == "quaternion" and {*QUATERNION} <= {*values}:
        values |= zip(
            QUATERNION, of_norm_one([values[q] for q in QUATERNION], "[initial]"), strict=True
        )
    for name, value in {**_turned(scene), **_initial_attitude(scene)}.items():
        if name in values:
            raise InputError(
                f"{name} is given twice", where="[initial] and [initial_attitude]", got=name
            )
        values[name] = value
    angles = {n for a in full.angles for n in a.names} | {*scene.control.stepped}
    for output in full.outputs:
        if output.name in given and output.name not in angles:
            name, value = _state_of_output(scene, full, output, values)
            values[name] = value
    _check_constraints(scene, values)
    return values


def _check_units(scene: Description, full: System) -> None:
    """Raise `InputError` for an initial value of another dimension than its state or output."""
    units = {q.name: q.unit for q in (*full.states, *full.output_quantities)}
    known = {q.name: q.unit for q in full.parameters} | dict.fromkeys(scene.body.size, "m")
    own = {n: v.unit for n, v in scene.parameters.items() if v.unit}
    stated = Stated({**known, "mass": "kg"}, own)
    for name, given in scene.initial.items():
        if isinstance(given, str):
            where = f"[initial] {name}"
            in_unit(given, units.get(name, ""), where)
            stated.check(given, where, units.get(name, ""))


def _state_of_output(
    scene: Description, full: System, output: Definition, values: Mapping[str, float]
) -> tuple[str, float]:
    known = {
        **values,
        **constants(scene),
        **{n: v.value for n, v in scene.inputs.items()},
        "t": 0.0,
    }
    value = full.expand(output.expression)
    rest = value.xreplace(
        {q: sp.Float(known[q.name]) for q in value.free_symbols if q.name in known}
    )
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
    return missing[0].name, float((initial(scene)[output.name] - offset) / slope)


def _turned(scene: Description) -> dict[str, float]:
    """Return the quaternion of a scene whose initial values are angles that are outputs."""
    if not scene.sequence:
        return {}
    names = [q.name for q in attitude(scene.sequence).coordinates]
    values = initial(scene)
    given = [n for n in names if n in values]
    if not given:
        return {}
    if len(given) < len(names) or scene.initial_attitude is not None:
        raise InputError(
            "an attitude is three angles, given once", where="[initial]",
            got=", ".join(given) + (" and [initial_attitude]" if scene.initial_attitude else ""),
            expected=", ".join(names),
        )  # fmt: skip
    q = quaternion_of_sequence(scene.sequence, [values[n] for n in names])
    return {f"q{k}": v for k, v in enumerate(q)}


def _initial_attitude(scene: Description) -> dict[str, float]:
    given = scene.initial_attitude
    if given is None:
        return {}
    wanted = "3-1-2" if scene.model == "spinner" else scene.coordinates
    q = in_coordinates(given, wanted, "[initial_attitude]")
    if wanted != "dcm":
        return {c.name: v for c, v in zip(attitude(wanted).coordinates, q, strict=True)}
    coordinates = quaternion_coordinates()
    matrix = coordinates.matrix.xreplace(
        {s: sp.Float(v) for s, v in zip(coordinates.symbols, q, strict=True)}
    )
    return {c.name: float(v) for c, v in zip(attitude("dcm").coordinates, matrix, strict=True)}


def _check_constraints(scene: Description, values: Mapping[str, float]) -> None:
    """Refuse a quaternion without unit norm and direction cosines that are not orthonormal."""
    if scene.coordinates == "none" or scene.model == "spinner":
        return
    for name, meaning, expression in attitude(scene.coordinates).constraints:
        free = {s.name for s in expression.free_symbols}
        if free <= set(values):
            found = float(
                expression.xreplace({s: sp.Float(values[s.name]) for s in expression.free_symbols})
            )
            expected = constraint_value(name)
            if abs(found - expected) > 1e-9:
                raise InputError(
                    f"{scene.coordinates} at the start is no rotation", where="[initial]",
                    got=f"{meaning} = {found!r}", expected=f"{expected} to within 1e-9",
                    hint="[initial_attitude] takes angles and makes them exact",
                )  # fmt: skip


_ATTITUDE = (
    'an attitude may be given in [initial_attitude]: sequence = "3-1-3" with degrees = [0, 30, 0], '
    "or quaternion = [1, 0, 0, 0]"
)


def pick(
    values: Mapping[str, float],
    names: Iterable[str],
    kind: str,
    where: str,
    attitudes: Collection[str] = (),
) -> dict[str, float]:
    """Return ``values`` of ``names``, in order. Raises `InputError` that lists the missing ones.

    ``attitudes``: names that may be given as an attitude.
    """
    names = tuple(names)
    missing = [n for n in names if n not in values]
    if missing:
        unused = [n for n in values if n not in names]
        hint = near_matches(missing[0], unused) if unused else ""
        if not hint.startswith("did"):
            hint = _ATTITUDE if {*missing} & {*attitudes} else f"as --set {missing[0]}=VALUE"
        raise InputError(
            f"missing {kind}: {', '.join(missing)}",
            where=where,
            expected=f"a line such as {missing[0]} = 0.5",
            hint=hint,
        )
    return {n: values[n] for n in names}
