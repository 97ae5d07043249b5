"""The motion of a result in space: of the bodies of its scene, or the one that its system states."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from eom.errors import InputError
from eom.quantities import Definition, Quantity
from eom.rotations import quaternion_product
from eom.structure import QUATERNION
from eom.system import System
from eom.views.animation.animation import Animation, animation_of, animation_of_motion
from eom.views.animation.animation_page import page
from eom.views.draw.picture import Floats

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from codegen import Result
    from eom.opening import AnyScene
    from eom.structure import BodyAttitude

STEP, FEWEST, MOST = 0.2, 201, 4001
"""Radians that a body turns between two times, about; and numbers of times."""


@dataclass(frozen=True)
class Shown:
    """An animation that a notebook displays, and that is written as a page."""

    animation: Animation

    def write(self, path: str | Path) -> Path:
        """Write it as one page of HTML (.html); return its path. Raises `InputError` where that fails."""
        from pathlib import Path

        from codegen.runs.export import whole

        file = Path(path)
        if file.suffix != ".html":
            raise InputError("unknown kind of file", where=str(file), expected="a name that ends in .html",
                             hint="eom animate writes films")  # fmt: skip
        return whole(file, lambda part: part.write_text(page(self.animation), encoding="utf-8"))

    def _repr_html_(self) -> str:
        """Return a frame with the page in it, which asks for nothing."""
        from html import escape

        return (
            f'<iframe srcdoc="{escape(page(self.animation))}" width="100%" height="640"></iframe>'
        )

    def __repr__(self) -> str:
        """Name it and say how long it is."""
        t = self.animation.times
        return f"Animation of {self.animation.title}: {len(t)} times from {t[0]:g} to {t[-1]:g} s"


def animated(result: Result, scene: AnyScene | None = None, speed: float | None = None) -> Shown:
    """Return the animation of a result: see `codegen.Result.animate`.

    ``scene``: that it came from; ``speed``: seconds of the motion that are shown in one. Raises
    `InputError` for systems without a body that is known, and results that do not know what they came
    from. Lengths in m, angles in rad, vectors in the frame of reference A.
    """
    if speed is not None and not (math.isfinite(speed) and speed > 0):
        raise InputError("not a positive number", where="speed", got=speed)
    if scene is not None:
        if not hasattr(scene, "derive"):
            raise InputError("not a scene", where="animate", got=type(scene).__name__,
                             expected="what eom.load_scene returns")  # fmt: skip
        return Shown(_of_scene(result, scene, speed))
    compiled, values = _origin(result)
    found = [a for a in compiled.system.attitudes if a.sequence or a.kind == QUATERNION]
    if len(found) != 1 or None in found[0].coordinates or found[0].unspun:
        raise InputError(
            "no single body with an attitude is known",
            where=f"animate, system {compiled.layout.name!r}",
            got=f"{len(found)} bodies with a quaternion or angles among the states",
            hint="give the scene that it was derived from: result.animate(eom.load_scene(...))",
        )
    return Shown(_of_body(result, compiled, values, found[0], speed))


def _origin(result: Result) -> tuple[Any, Any]:
    """Return the compiled system of a result, and its problem."""
    origin: Any = result.origin
    if origin is None:
        raise InputError("a result that does not know what it came from", where="animate",
                         hint="animate before it is pickled or saved, or give its scene")  # fmt: skip
    return origin.compiled, origin.problem


def _of_body(
    result: Result, compiled: Any, problem: Any, body: BodyAttitude, speed: float | None
) -> Animation:
    """Return the animation of a body that a system states, at times that are equally far apart."""
    names = ["eom_w_1", "eom_w_2", "eom_w_3"]
    expressions = list(body.omega)
    if body.inertia is not None:
        names += [f"eom_J_{k}" for k in range(9)]
        expressions += list(body.inertia)
    asked = _with_outputs(compiled.system, names, expressions)
    t = np.linspace(result.t[0], result.t_stop, FEWEST)
    for _ in range(2):
        y = _at(result, t)
        values = asked.outputs(
            t, y, problem.parameters, problem.inputs if problem.inputs.size else None
        )
        omega = np.ascontiguousarray(values[:3].T)
        turned = float(np.linalg.norm(omega, axis=1).max() * abs(t[-1] - t[0]))
        count = min(MOST, math.ceil(turned / STEP) + 1)
        if count <= len(t):
            break
        t = np.linspace(t[0], t[-1], count)
    J = values[3:, 0].reshape(3, 3) if body.inertia is not None else np.eye(3)
    quaternions = _quaternions(body, y, compiled.system.state_names)
    title = compiled.system.title or compiled.system.name
    return animation_of_motion(title, t, quaternions, omega, J, speed=speed)


def _with_outputs(system: System, names: list[str], expressions: list[Any]) -> Any:
    import sympy as sp

    import codegen

    outputs = tuple(
        Definition(Quantity(sp.Symbol(n, real=True)), sp.sympify(e, strict=True))
        for n, e in zip(names, expressions, strict=True)
    )
    return codegen.compile(replace(system, outputs=outputs, invariants=()), "numpy")


def _quaternions(body: BodyAttitude, y: Floats, names: tuple[str, ...]) -> Floats:
    """Return the attitude (N, 4), scalar first, from states (n, N)."""
    rows = [y[names.index(str(c))] for c in body.coordinates]
    if body.kind == QUATERNION:
        return np.array(rows).T
    q: Any = (np.ones_like(rows[0]), *(np.zeros_like(rows[0]) for _ in range(3)))
    for angle, axis in zip(rows, body.sequence, strict=True):
        turn: list[Any] = [np.cos(angle / 2), *(np.zeros_like(angle) for _ in range(3))]
        turn[axis] = np.sin(angle / 2)
        q = quaternion_product(q, turn)
    return np.array(q).T


def _at(result: Result, t: Floats) -> Floats:
    """Return the states (n, N) at times of a run, made again for these."""
    origin: Any = result.origin
    if result.sol:
        return np.asarray(result.sol(t))
    problem = replace(
        origin.problem,
        t_eval=t - origin.problem.start,
        dense_output=False,
        events=(),
        laws=origin.problem.laws,
    )
    made = origin.again(problem, origin.method)
    if len(made.t) != len(t):
        raise InputError("the motion cannot be made again", where="animate", got=result.message,
                         hint="simulate with dense_output=True")  # fmt: skip
    return np.asarray(made.y)


def _of_scene(result: Result, scene: AnyScene, speed: float | None) -> Animation:
    """Return the animation of the motion with attitude, of a scene with the numbers of the result."""
    compiled, problem = _origin(result)
    layout = compiled.layout
    given = {
        **dict(zip((q.name for q in layout.states), problem.x0.tolist(), strict=True)),
        **dict(zip((q.name for q in layout.parameters), problem.parameters.tolist(), strict=True)),
        **dict(zip((q.name for q in layout.inputs), problem.inputs.tolist(), strict=True)),
        **compiled.structure.parameters,
    }
    own = scene.parameter_values()
    other = {n: given[n] for n, v in own.items() if n in given and given[n] != v}
    return animation_of(
        scene.with_values(other) if other else scene,
        lambda prepared: _motion(prepared, given, result),
        seconds=abs(float(result.t_stop - result.t[0])),
        speed=speed,
    )


def _motion(prepared: AnyScene, given: Mapping[str, float], result: Result) -> Result:
    """Return the motion of a scene of `with_attitude`, the result's own if its states say where bodies are.

    Raises `InputError` where they do not and the scene does not move as the result does.
    """
    compiled, problem = _origin(result)
    known, names = set(compiled.system.state_names), prepared.derive().state_names
    missing = [n for n in names if n not in known | _spins(prepared)]
    if not missing:
        return _own(prepared, names, given, result)
    driven = result.origin.signals is not None or problem.laws  # type: ignore[attr-defined]
    if driven or {*compiled.system.input_names} != {*prepared.derive().input_names}:
        raise InputError(
            "inputs that are functions or laws are animated from states that say where bodies are alone",
            where="animate", got=f"a result without {', '.join(missing)}",
            hint="ask the scene for them as outputs, or write the laws into the scene",
        )  # fmt: skip
    return _moved(prepared, given, result)


def _spins(scene: AnyScene) -> set[str]:
    """Return the names of the angles of rotors, which follow from their speeds."""
    rotors = scene.tree.rotors if scene.is_tree else ()
    return {r.states[0].name for r in rotors if r.speed is None}


def _own(
    prepared: AnyScene, names: tuple[str, ...], given: Mapping[str, float], result: Result
) -> Result:
    """Return a result at equally spaced times in the states of a prepared scene, with its outputs."""
    import codegen

    compiled, problem = _origin(result)
    plan = prepared.integration
    t = np.linspace(float(result.t[0]), float(result.t_stop), plan.points)
    y = _at(result, t)
    u: Any = result.origin.inputs(t, y)  # type: ignore[attr-defined]
    found = dict(zip(compiled.system.state_names, y, strict=True))
    found |= dict(zip(compiled.system.input_names, u, strict=True))
    if compiled.system.outputs:
        values = compiled.outputs(t, y, problem.parameters, u if len(u) else None)
        found |= dict(zip((d.name for d in compiled.system.outputs), values, strict=True))
    system = prepared.derive()
    own = {n: found[n] for n in names if n in found}
    driving = {n: np.broadcast_to(found[n], t.shape) for n in system.input_names if n in found}
    outputs = dict(driving)
    if system.outputs and len(own) == len(names):
        made = codegen.compile(system, "numpy")
        numbers, held = prepared.parameter_values(), prepared.input_values()
        order = [q.name for q in made.layout.parameters]
        parameters = [given[n] if n in given else numbers[n] for n in order]
        inputs = [
            driving[n] if n in driving else np.full(len(t), held[n]) for n in system.input_names
        ]
        rows = made.outputs(
            t, np.array([*own.values()]), parameters, np.array(inputs) if inputs else None
        )
        outputs |= dict(zip((d.name for d in system.outputs), rows, strict=True))
    return replace(
        result, t=t - t[0], y=np.array([*own.values()]), names=tuple(own), outputs=outputs, held={},
        t_stop=float(t[-1] - t[0]),
    )  # fmt: skip


def _moved(prepared: AnyScene, given: Mapping[str, float], result: Result) -> Result:
    """Return the run of a scene from the values of a result, as far as it has these."""
    import codegen

    plan = prepared.integration
    t = np.linspace(0.0, plan.t_end, plan.points)
    start, parameters, inputs = (
        {n: given.get(n, v) for n, v in own.items()}
        for own in (prepared.initial_values(), prepared.parameter_values(), prepared.input_values())
    )
    rtol, atol = result.origin.problem.rtol, plan.atol  # type: ignore[attr-defined]
    compiled = codegen.compile(prepared.derive())
    return codegen.simulate(
        compiled, start, (0.0, plan.t_end), parameters, plan.method, rtol, atol, t, inputs=inputs
    )
