"""Initial value problems that integrators are measured by: systems, numbers, sources.

A system that can be derived is derived; only problems that are given as equations in their source are
written as such. Units are SI. The ready scenes are problems, too: `from_scene`.

The satellite has its greatest moment along the orbit normal and librates. One with the least there
tumbles, and its motion is chaotic: after 20 orbits twelve digits are lost, after 100 all, by any method.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import cos, inf, pi, sin

import sympy as sp

from eom.errors import InputError, unknown_name
from eom.mechanics.dissipation import viscous_slug
from eom.mechanics.rigidbody import free_rigid_body, gravity_gradient_satellite, heavy_top
from eom.mechanics.spinning import lecture_torque
from eom.opening import AnyScene, load_scene
from eom.quantities import TIME
from eom.scenes import catalogue
from eom.scenes.given import number_of
from eom.system import System

ORBIT = 1.13e-3
"""Rate of a low circular orbit, rad/s."""


@dataclass(frozen=True)
class Problem:
    """A system, where it starts at t = 0, and until when it is integrated.

    ``derive``: makes the system. ``start``, ``parameters``, ``inputs``: numbers by name. ``closed``:
    how the solution is known in closed form, if it is.
    ``stiff``: explicit methods are held by stability and not by accuracy.
    """

    name: str
    title: str
    source: str
    derive: Callable[[], System]
    start: Mapping[str, float]
    parameters: Mapping[str, float]
    end: float
    inputs: Mapping[str, float]
    closed: str = ""
    stiff: bool = False

    @cached_property
    def system(self) -> System:
        """The system, derived once."""
        return self.derive()


def from_scene(scene: AnyScene) -> Problem:
    """Return a scene as a problem: the smallest system for its outputs, until its end time."""
    return Problem(
        name=scene.name,
        title=scene.title,
        source="scene",
        derive=scene.derive,
        start=scene.initial_values(),
        parameters=scene.parameter_values(),
        end=scene.integration.t_end,
        inputs=scene.input_values(),
    )


def _equations(name: str, factors: tuple[float, float, float], torque: sp.Expr) -> System:
    """Return y1' = a y2 y3, y2' = b y3 y1, y3' = c y1 y2 + torque."""
    y = sp.symbols("y1:4", real=True)
    a, b, c = (sp.Rational(str(f)) for f in factors)
    rates = (a * y[1] * y[2], b * y[2] * y[0], c * y[0] * y[1] + torque)
    return System.from_rates(name, dict(zip(y, rates, strict=True)))


MOMENTS = {"I1": 1.0, "I2": 2.0, "I3": 3.0}
AT_REST = {"q0": 1.0, "q1": 0.0, "q2": 0.0, "q3": 0.0}
SPIN = {"omega_1": 0.3, "omega_2": 1.0, "omega_3": 0.8}

PROBLEMS: tuple[Problem, ...] = (
    Problem(
        "detest-b5",
        "Euler's equations of DETEST, problem B5, to t = 1000",
        "Hull, Enright, Fellen, Sedgwick, SIAM J. Numer. Anal. 9 (1972) 603; end time 20 there",
        lambda: _equations("detest_b5", (1, -1, -0.51), sp.Integer(0)),
        {"y1": 0.0, "y2": 1.0, "y3": 1.0},
        {},
        1000.0,
        {},
        closed="sn, cn, dn",
    ),
    Problem(
        "forced-rigid-body",
        "Euler's equations with the torque sin(t)^2 / 4 about one axis",
        "the rigid body among the problems of SciML",
        lambda: _equations("forced_rigid_body", (-2, 1.25, -0.5), sp.sin(TIME) ** 2 / 4),
        {"y1": 1.0, "y2": 0.0, "y3": 0.9},
        {},
        10.0,
        {},
    ),
    Problem(
        "free-body-attitude",
        "Torque-free body, Euler's equations and quaternion, I = (1, 2, 3)",
        "derived; closed form by Jacobi (1850)",
        lambda: free_rigid_body("quaternion"),
        {**SPIN, **AT_REST},
        MOMENTS,
        20.0,
        {},
        closed="Jacobi's functions and theta functions: codegen.free_motion",
    ),
    Problem(
        "spinner-with-torque",
        "3-1-2 spinner under a constant torque about -b1",
        "derived; lecture 001",
        lambda: lecture_torque().system(),
        {"theta": 0.1, "psi": 0.0, "phi": 0.0, "theta_dot": 0.0, "psi_dot": 0.2, "C": 20.0},
        {"I1": 0.06, "I2": 0.12, "M1": 0.5},
        10.0,
        {},
    ),
    Problem(
        "heavy-top-quaternion",
        "Heavy symmetric top with quaternion, 64 turns",
        "derived",
        heavy_top,
        {"omega_1": 0.1, "omega_2": 0.2, "omega_3": 20.0,
         "q0": cos(0.3), "q1": sin(0.3), "q2": 0.0, "q3": 0.0},
        {"I1": 1.0, "I2": 1.0, "I3": 0.3, "m": 1.0, "g": 10.0, "r3": 0.2},
        20.0,
        {},
    ),
    Problem(
        "gravity-gradient-100",
        "Satellite librating under gravity-gradient torque, 100 orbits",
        "derived; Hughes, Spacecraft Attitude Dynamics (1986), sect. 8.1",
        gravity_gradient_satellite,
        {"omega_1": 1e-4, "omega_2": 2e-4, "omega_3": ORBIT, **AT_REST},
        {"I1": 7.0, "I2": 10.0, "I3": 12.0, "n": ORBIT},
        200 * pi / ORBIT,
        {},
    ),
    Problem(
        "damped-body",
        "Torque-free body with a viscous slug",
        "derived; Hughes, Spacecraft Attitude Dynamics (1986), ch. 5",
        viscous_slug,
        {**SPIN, "sigma_1": 0.5, "sigma_2": 0.0, "sigma_3": -0.5},
        {**MOMENTS, "J_s": 1.0, "c": 1.0},
        20.0,
        {},
    ),
    Problem(
        "damped-body-stiff",
        "Torque-free body with a viscous slug, a million times the damping",
        "derived; Hughes, Spacecraft Attitude Dynamics (1986), ch. 5",
        viscous_slug,
        {**SPIN, "sigma_1": 0.5, "sigma_2": 0.0, "sigma_3": -0.5},
        {**MOMENTS, "J_s": 1.0, "c": 1e6},
        20.0,
        {},
        stiff=True,
    ),
)  # fmt: skip


def names() -> list[str]:
    """Return the names of the reference problems and of the ready scenes."""
    return [*(row.name for row in PROBLEMS), *catalogue.names()]


def ready(
    name: str, values: Mapping[str, float | str] | None = None, end: float | None = None
) -> Problem:
    """Return a reference problem, a ready scene, or a scene from a file.

    ``values``: others of parameters, inputs and initial values by name, as `eom.Scene.with_values`
    takes them; ``end``: another end time (s). Raises `InputError` for other names, and for values and
    times that cannot be.
    """
    rows = {row.name: row for row in PROBLEMS}
    if name in rows:
        return _changed(rows[name], values or {}, end)
    if not is_scene(name):
        raise unknown_name("problem or scene", name, names())
    scene = load_scene(name)
    if values:
        scene = scene.with_values(values)
    if end is not None:
        plan = {**scene.integration.model_dump(exclude_unset=True), "t_end": end}
        scene = scene.changed(integration=plan)
    return from_scene(scene)


def is_scene(name: str) -> bool:
    """Return whether a name is that of a ready scene or of a file, and of no reference problem."""
    return catalogue.is_file(name) or name in catalogue.names()


def _changed(problem: Problem, values: Mapping[str, float | str], end: float | None) -> Problem:
    """Return a reference problem with other numbers. Raises `InputError` for those that cannot be."""
    if end is not None and not 0 < end < inf:
        raise InputError("the end time is not positive", where=f"{problem.name}: --t-end", got=end)
    system = problem.system if values else None
    quantities = (*system.states, *system.parameters, *system.inputs) if system else ()
    units = {q.name: q.unit for q in quantities}
    for name in values:
        if name not in units:
            raise unknown_name("parameter, input or initial value", name, units, problem.name)
    numbers = {n: number_of(v, units[n], f"{problem.name}: {n}") for n, v in values.items()}
    start, parameters, inputs = (
        {n: numbers.get(n, v) for n, v in group.items()}
        for group in (problem.start, problem.parameters, problem.inputs)
    )
    return replace(
        problem, start=start, parameters=parameters, inputs=inputs, end=problem.end if end is None else end
    )  # fmt: skip
