"""A scene of one body as a tree in angles, for its closed form."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.kinematics.coordinates import SEQUENCES, elementary, rotation_sequence
from eom.kinematics.frames import vector
from eom.mechanics.spinning import OMEGA, PHI, PSI, PSI_DOT, SPIN, THETA, THETA_DOT
from eom.multibody.files.scene import TreeScene
from eom.multibody.model.attachments import Load
from eom.multibody.model.bodies import Body
from eom.multibody.model.joints import SEQUENCE_TO
from eom.multibody.model.model import Tree
from eom.scenes.assembly import torques_of
from eom.scenes.description import inertia_values, principal_values
from eom.scenes.scene import Scene

Expr = Any
SPINNER = "3-1-2"
_READ = ("body", "torque", "parameters", "inputs")


def single_tree(scene: Scene, attitude: str = "") -> Tree:
    """Return the tree of a ``scene`` of one body in angles, its equal moments under one symbol.

    ``attitude``: a sequence of angles, by default the scene's, or one whose last turn is about the axis of
    symmetry. Raises `InputError` for formulas over what the angles replace, and other angles of a spinner.
    """
    said = scene.as_stated()
    spins = said.model == "spinner"
    data: dict[str, Any] = {"name": said.name, "attitude": _sequence(said, attitude)}
    data |= {k: v for k, v in said.model_dump(exclude_unset=True).items() if k in _READ}
    if spins:
        weight = data.get("torque", {}).get("weight")
        data["torque"] = {"weight": weight} if weight else {}
        data["body"] = {"moments": principal_values(said)}
        data = {k: v for k, v in data.items() if k not in {"parameters", "inputs"}}
    if said.torque.weight is None and not data["body"].get("solid"):
        data["body"] = {**data["body"], "mass": 1.0}  # no matter: the inertia is about the joint
    tree = TreeScene(**data).tree
    tree = replace(tree, bodies=tuple(_with_equal_moments(b, said) for b in tree.bodies))
    return _with_couple(tree, said) if spins else tree


def _sequence(scene: Scene, attitude: str) -> str:
    if scene.model == "spinner":
        if attitude not in {"", SPINNER}:
            raise InputError(
                "a spinner has its own angles", where=f"{scene.name}: attitude", got=attitude,
                expected=SPINNER,
            )  # fmt: skip
        return SPINNER
    own = scene.attitude if scene.attitude in SEQUENCES else scene.sequence
    return attitude or own or SEQUENCE_TO[_symmetric(scene)]


def _symmetric(scene: Scene) -> int | None:
    """Return the axis about which the body is symmetric and, if it is heavy, its centre of mass lies."""
    if inertia_values(scene) is not None:
        return None
    moments, weight = principal_values(scene), scene.torque.weight
    centre = weight.centre_of_mass if weight else (0.0, 0.0, 0.0)
    for k in (2, 1, 0):
        i, j = (n for n in range(3) if n != k)
        if moments[i] == moments[j] and centre[i] == centre[j] == 0:
            return k
    return None


def _with_equal_moments(body: Body, scene: Scene) -> Body:
    moments = [row[k] for k, row in enumerate(body.turned_inertia)]
    if inertia_values(scene) is not None or not all(isinstance(x, sp.Symbol) for x in moments):
        return body
    values = principal_values(scene)
    return replace(body, inertia=tuple(moments[values.index(v)] for v in values), about="origin")


def _with_couple(tree: Tree, scene: Scene) -> Tree:
    """Return the tree of a spinner under its torque, which is given in axes that do not turn with phi."""
    couple, (joint,) = torques_of(scene)["components"], tree.joints
    q, w = ([x.symbol for x in xs] for xs in (joint.coordinates, joint.speeds))
    rates = rotation_sequence(SPINNER, q).rates(vector("B", w))
    known = dict(zip((PSI, THETA, PHI, PSI_DOT, THETA_DOT, OMEGA), (*q, *rates), strict=True))
    turned = elementary(2, PHI) * sp.Matrix(list(couple.components.components))
    torque = tuple(x.xreplace(known | {SPIN: w[1]}) for x in turned)
    if not any(torque):
        return tree
    load = Load(joint.child, torque=torque, axes="body")
    parameters = (*tree.parameters, *couple.parameters)
    return replace(tree, loads=(load,), inputs=couple.inputs, parameters=parameters)
