"""What the methods on the group of rotations share: variables, functions in C, dense output."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.frontend.attitude import attitude_of
from codegen.frontend.layout import Layout, names_of
from codegen.integrate.momentum import Variables
from codegen.ir.groups import SINGULARITIES
from codegen.ir.names import comment, identifier
from codegen.ir.program import Program
from codegen.loops import projection, runge_kutta
from codegen.loops.runge_kutta import NativeMethod
from codegen.native.trajectory import Array, Problem, Stepwise, Trajectory
from codegen.targets import c
from eom.errors import InputError

Pointer = int | None
Between = Callable[[Pointer, Pointer, int, int, int, int], None]
"""The function of the generated file that evaluates rows: parameters, inputs, count, theta, rows, x."""


def variables_of(method: str, layout: Layout) -> Variables:
    """Return the variables of a system. Raises `InputError` unless it states one unit quaternion."""
    attitude = attitude_of(layout.attitudes, len(layout.states))
    if attitude is None:
        raise InputError(
            f"method {method} needs one unit quaternion that the system states, not none or several",
            where=layout.name,
            got=", ".join(names_of(layout.states)),
            expected="four states q, scalar first, with dq/dt = q (0, omega)/2",
            hint='ask for attitude = "quaternion", state attitudes=[BodyAttitude(...)] of a system from '
            "elsewhere, or choose another method",
        )
    return Variables(attitude, len(layout.states))


@dataclass(frozen=True)
class Functions:
    """Functions of a generated file, and how many constants each of them keeps, by name."""

    text: str
    constants: dict[str, int]


def functions(prefix: str, parts: Sequence[tuple[Program, str, str]]) -> Functions:
    """Return static functions ``prefix``_name of groups of programs: (program, group, name)."""
    lines: list[str] = []
    constants = {}
    for program, group, name in parts:
        own, count = c.kernels(program, group, f"{prefix}_{name}")
        lines += own
        constants[name] = max(1, count)
    return Functions("\n".join(lines), constants)


def values(layout: Layout, suffix: str) -> dict[str, str]:
    """Return what the templates of every method need to know of a system."""
    name, singular = identifier(layout.name), len(layout.results[SINGULARITIES])
    prefix = f"{name}_{suffix}"
    text = resources.files("codegen.loops").joinpath("quaternions.c").read_text("ascii")
    return {
        "TITLE": comment(layout.title),
        "NAME": name,
        "PREFIX": prefix,
        "UPPER": prefix.upper(),
        "HEADER": f"{prefix}.h",
        "STATES": str(len(layout.states)),
        "SINGULARITIES": str(singular),
        "SINGULAR_ROOM": str(max(1, singular)),
        "COORDINATES": ", ".join(map(str, layout.coordinates)),
        "QUATERNIONS": text,
        **projection.NONE,
    }


def single_text(program: Program, layout: Layout, suffix: str, header: str, source: str) -> str:
    """Return functions and integrator as one text that compiles by itself."""
    name = identifier(layout.name)
    rest = (header + source).replace(f'#include "{name}.h"\n', "")
    return c.single_text(program, layout) + rest.replace(f'#include "{name}_{suffix}.h"\n', "")


def between(library: ctypes.CDLL, prefix: str) -> Between:
    """Return the function that evaluates rows of dense output."""
    function: Any = getattr(library, f"{prefix}_between")
    pointer, size = ctypes.c_void_p, ctypes.c_size_t
    function.argtypes, function.restype = [pointer, pointer, size, pointer, pointer, pointer], None
    return function  # type: ignore[no-any-return]


def unbound(*_: Array) -> None:
    """Stand where `integrate` puts the dense output of a problem, which needs its parameters."""


def integrate(method: NativeMethod, evaluate: Between, problem: Problem) -> Trajectory:
    """Integrate a problem; its dense output is evaluated with its own parameters and inputs."""

    def solution(t: Array, h: Array, x: Array, rows: Array) -> RowSolution:
        return RowSolution(t, h, x, rows, evaluate, problem)

    return runge_kutta.integrate(replace(method, solution=solution), problem)


def _address(array: Array) -> Pointer:
    return array.ctypes.data if array.size else None


class RowSolution(Stepwise):
    """Partial steps on the group, evaluated in C."""

    def __init__(
        self, t: Array, h: Array, x: Array, rows: Array, evaluate: Between, problem: Problem
    ) -> None:
        super().__init__(t, h, x, rows)
        self._evaluate, self._problem = evaluate, problem

    def _within(self, k: NDArray[np.intp], since: Array) -> Array:
        theta = np.ascontiguousarray(since / self._h[k])
        rows = np.ascontiguousarray(self._rows[k])
        value = np.empty((len(k), self._x.shape[1]))
        self._evaluate(
            _address(self._problem.parameters), _address(self._problem.inputs), len(k),
            theta.ctypes.data, rows.ctypes.data, value.ctypes.data,
        )  # fmt: skip
        return value
