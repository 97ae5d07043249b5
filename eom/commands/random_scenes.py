"""Random scenes: bodies of all symmetries, torques from a grammar, all attitudes, hard starts.

A scene is named by a seed, a number and how many kinds there are. Its kind, the number modulo that,
decides what is derived and compiled: attitude, shape of the inertia, formulas of the torque. All numbers
belong to the scene. The same names give the same scene.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from codegen.measure.workprecision.case import Case

ATTITUDES = ("none", "quaternion", "dcm", "3-2-1", "3-1-3", "1-2-3", "2-1-2", "3-1-2", "1-3-1")
ANGLE = {"quaternion": "q1", "dcm": "C23"}
"""What a spring pulls on; the sine of the second angle in all sequences."""


@dataclass(frozen=True)
class Term:
    """A term of a torque about axis k: its formula with {k} and {angle}, and its parameters.

    Each is drawn times a scale: M (moment times rate squared), c (moment times rate), J (moment),
    w (rate), or 1.
    """

    formula: str
    scales: tuple[tuple[str, str], ...]
    needs_attitude: bool = False


TERMS = (
    Term("M{k}", (("M{k}", "M"),)),
    Term("A{k}*sin(f{k}*t + e{k})", (("A{k}", "M"), ("f{k}", "w"), ("e{k}", "1"))),
    Term("-c{k}*omega_{k}", (("c{k}", "c"),)),
    Term("-d{k}*omega_{k}*abs(omega_{k})", (("d{k}", "J"),)),
    Term("-b{k}*sign(omega_{k})", (("b{k}", "M"),)),
    Term("-s{k}*{angle}", (("s{k}", "M"),), needs_attitude=True),
)
COUNTS = (0, 0, 1, 1, 2)
"""How many terms a component has."""
SPECIAL = ("components", "components", "components", "weight", "gravity_gradient")


@dataclass(frozen=True)
class Kind:
    """What is compiled once: attitude, torque, its components, whether the inertia is a full matrix."""

    attitude: str
    torque: str
    terms: tuple[tuple[Term, ...], ...]
    full: bool


def kind(seed: int, number: int) -> Kind:
    """Return a kind of scene; the first ones go through the attitudes."""
    draw = random.Random(f"kind {seed} {number}")  # noqa: S311 - reproducible scenes
    attitude = ATTITUDES[number % len(ATTITUDES)]
    torque = draw.choice(SPECIAL) if attitude != "none" else "components"
    usable = [t for t in TERMS if attitude != "none" or not t.needs_attitude]
    terms = tuple(tuple(draw.sample(usable, draw.choice(COUNTS))) for _ in range(3))
    return Kind(attitude, torque, terms, full=draw.random() < 0.25)


def draw_scene(seed: int, number: int, kinds: int) -> Case:
    """Return scene ``number`` as a case; ``title`` says what was drawn."""
    from codegen.measure.workprecision.case import Case
    from eom.problems import from_scene
    from eom.scenes.scene import Scene

    scene = Scene(**description(seed, number, kinds))
    problem = from_scene(scene)
    numbers = (problem.start, problem.parameters, problem.inputs)
    return Case(problem.name, scene.description, problem.system, *numbers, problem.end)


def description(seed: int, number: int, kinds: int) -> dict[str, Any]:
    """Return the data of a scene, as a scene file has them."""
    chosen = kind(seed, number % kinds)
    draw = random.Random(f"scene {seed} {number}")  # noqa: S311 - reproducible scenes
    size = 10 ** draw.uniform(-3, 3)
    moments = _moments(draw, size)
    omega, rate = _omega(draw)
    torque, parameters = _torque(chosen, draw, size, rate)
    data: dict[str, Any] = {
        "name": f"scene-{number % kinds}",
        "description": f"number {number}: {chosen.attitude}, {torque}, moments {moments}, omega {omega}",
        "attitude": chosen.attitude,
        "body": {"matrix": _matrix(moments)} if chosen.full else {"moments": moments},
        "torque": torque,
        "parameters": parameters,
        "initial": {f"omega_{k}": w for k, w in enumerate(omega, 1)},
        "integration": {"t_end": draw.uniform(0.3, 3.0) * 2 * math.pi / rate},
    }
    if chosen.attitude != "none":
        data["initial_attitude"] = _attitude(chosen.attitude, draw)
    return data


def _moments(draw: random.Random, size: float) -> list[float]:
    """Second moments along three axes give what a body can have; some of them are equal."""
    x, y, z = (size * 10 ** draw.uniform(-2, 0) for _ in range(3))
    shape = draw.random()
    y = x if shape < 0.25 else y
    z = x if shape < 0.05 else z
    return [y + z, x + z, x + y]


def _matrix(moments: list[float]) -> list[list[float]]:
    """Turn principal moments by half a radian about b3, then b1."""
    c, s = math.cos(0.5), math.sin(0.5)
    R = [[c, s, 0.0], [-s * c, c * c, s], [s * s, -c * s, c]]
    J = [
        [sum(R[i][m] * moments[m] * R[j][m] for m in range(3)) for j in range(3)] for i in range(3)
    ]
    return [[J[max(i, j)][min(i, j)] for j in range(3)] for i in range(3)]


def _omega(draw: random.Random) -> tuple[list[float], float]:
    """Return components, some or all of them zero or tiny, and the rate that times are measured by."""
    rate = 10 ** draw.uniform(-1, 1)
    masks: tuple[Callable[[], float], ...] = (
        lambda: draw.uniform(-1, 1), lambda: draw.uniform(-1, 1), lambda: draw.uniform(-1, 1),
        lambda: 0.0, lambda: 1e-8 * draw.uniform(-1, 1),
    )  # fmt: skip
    if draw.random() < 0.1:
        return [0.0, 0.0, 0.0], rate
    return [rate * draw.choice(masks)() for _ in range(3)], rate


def _torque(
    chosen: Kind, draw: random.Random, size: float, rate: float
) -> tuple[dict[str, Any], dict[str, float]]:
    if chosen.torque == "weight":
        arm = [draw.choice((0.0, draw.uniform(-1, 1))) for _ in range(2)]
        mass = size * rate**2 / 9.81
        return {"weight": {"mass": mass, "centre_of_mass": [*arm, 1.0]}}, {}
    if chosen.torque == "gravity_gradient":
        return {"gravity_gradient": {"orbital_rate": rate * draw.uniform(0.05, 1.0)}}, {}
    scales = {"M": size * rate**2, "c": size * rate, "J": size, "w": rate, "1": 1.0}
    angle = ANGLE.get(chosen.attitude, "sin(theta)")
    parts, parameters = [], {}
    for k, terms in enumerate(chosen.terms, 1):
        parts.append(" + ".join(t.formula.format(k=k, angle=angle) for t in terms) or "0")
        for term in terms:
            for name, scale in term.scales:
                parameters[name.format(k=k)] = scales[scale] * draw.uniform(0.01, 0.5)
    return {"components": parts}, parameters


def _attitude(name: str, draw: random.Random) -> dict[str, Any]:
    """Any turn; with angles also next to, and in, the singular configuration."""
    if name in {"quaternion", "dcm"}:
        q = [draw.gauss(0, 1) for _ in range(4)]
        norm = math.sqrt(sum(v * v for v in q))
        return {"quaternion": [v / norm for v in q]}
    singular = 0.0 if name[0] == name[-1] else math.pi / 2
    near = draw.choice((0.0, 1e-7, 1e-4, 1e-2, *[draw.uniform(0.3, 1.2)] * 6))
    angles = [draw.uniform(-3, 3), singular - near, draw.uniform(-3, 3)]
    return {"sequence": name, "radians": angles}
