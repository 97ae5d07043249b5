"""The methods of `codegen.simulate` by name, and how each comes to its integrator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from codegen.compiled import Compiled
from codegen.identity import SameObject
from codegen.integrate import choice, group, rkmk, runge_kutta, scipy_, splitting, taylor
from codegen.integrate.dop853 import DOP853
from codegen.integrate.trajectory import Problem, Trajectory
from eom.errors import InputError, unknown_name

Integrator = Callable[[Problem], Trajectory]


@dataclass(frozen=True)
class Task:
    """What is to be integrated: ``signals`` give the inputs over time where they are functions."""

    compiled: Compiled
    problem: Problem
    signals: scipy_.Inputs | None


@dataclass(frozen=True)
class Method:
    """A name, what it is, and what prepares the integrator and says what it is called in full."""

    name: str
    meaning: str
    prepare: Callable[[Task], tuple[Integrator, str]]


@lru_cache(maxsize=64)
def _dop853_once(key: SameObject[Compiled]) -> runge_kutta.NativeMethod:
    return runge_kutta.build(DOP853, key.value.program, key.value.layout)


@lru_cache(maxsize=64)
def _taylor_once(key: SameObject[Compiled], order: int) -> runge_kutta.NativeMethod:
    return taylor.build(key.value.program, key.value.layout, order)


@lru_cache(maxsize=64)
def _rkmk_once(key: SameObject[Compiled]) -> tuple[runge_kutta.NativeMethod, group.Between]:
    return rkmk.build(key.value.program, key.value.layout)


@lru_cache(maxsize=64)
def _splitting_once(key: SameObject[Compiled]) -> tuple[runge_kutta.NativeMethod, group.Between]:
    return splitting.build(key.value.program, key.value.layout)


def _native(method: runge_kutta.NativeMethod) -> Integrator:
    return lambda problem: runge_kutta.integrate(method, problem)


def _dop853(task: Task) -> tuple[Integrator, str]:
    """In generated C where that is the target and nothing calls Python; by SciPy otherwise."""
    if task.compiled.target == "c" and task.signals is None:
        return _native(_dop853_once(SameObject(task.compiled))), "DOP853 in generated C"
    integrator, used = _scipy("DOP853")(task)
    reason = " (inputs are Python functions)" if task.signals is not None else ""
    return integrator, used + reason


def _taylor(task: Task) -> tuple[Integrator, str]:
    if task.signals is not None:
        raise InputError(
            "method taylor cannot differentiate inputs that are Python functions",
            hint="write them into the system as functions of time, or choose DOP853",
        )
    order = taylor.order_of(task.problem.rtol)
    native = _taylor_once(SameObject(task.compiled), order)
    return _native(native), f"Taylor series of order {order} in generated C"


def _refuse_signals(name: str, task: Task) -> None:
    if task.signals is not None:
        raise InputError(
            f"method {name} runs in C and cannot call inputs that are Python functions",
            hint="write them into the system as functions of time, or choose DOP853",
        )


def _rkmk(task: Task) -> tuple[Integrator, str]:
    _refuse_signals("rkmk", task)
    native, evaluate = _rkmk_once(SameObject(task.compiled))
    used = "Runge-Kutta-Munthe-Kaas of order 8 in generated C"
    return lambda problem: group.integrate(native, evaluate, problem), used


def _splitting(task: Task) -> tuple[Integrator, str]:
    _refuse_signals("splitting", task)
    native, evaluate = _splitting_once(SameObject(task.compiled))
    used = f"splitting of order {splitting.METHOD.order} in generated C"
    return lambda problem: group.integrate(native, evaluate, problem), used


def _scipy(name: str) -> Callable[[Task], tuple[Integrator, str]]:
    def prepare(task: Task) -> tuple[Integrator, str]:
        used = f"{name} of SciPy over {task.compiled.target} functions"
        return lambda p: scipy_.integrate(task.compiled, p, name, task.signals), used

    return prepare


def _auto(task: Task) -> tuple[Integrator, str]:
    return choice.prepared(task, {row.name: row.prepare for row in ROWS})


ROWS: tuple[Method, ...] = (
    Method("auto", "closed form, Taylor series, DOP853 or a stiff method: see `choice`", _auto),
    Method("DOP853", "explicit Runge-Kutta of order 8, loop in C beside the target c", _dop853),
    Method("taylor", "Taylor series, loop in C, order from the relative tolerance", _taylor),
    Method("rkmk", "Lie-group Runge-Kutta of order 8 for attitude as a quaternion", _rkmk),
    Method("splitting", "symplectic: exact free-body turns and kicks of torque, fixed step", _splitting),
    *(Method(f"scipy:{m}", f"{m} of SciPy over the compiled functions", _scipy(m))
      for m in scipy_.METHODS),
)  # fmt: skip
OF_ATTITUDE = (rkmk.NAME, splitting.NAME)
"""Methods for systems with an attitude quaternion alone."""
METHODS = tuple(row.name for row in ROWS)
"""Names that ``method`` takes; `ROWS` says what they are."""


def integrator_of(task: Task, method: str) -> tuple[Integrator, str]:
    """Choose the integrator; return it, ready to run, and what it is called."""
    row = next((row for row in ROWS if row.name == method), None)
    if row is None:
        raise unknown_name("method", method, METHODS)
    return row.prepare(task)
