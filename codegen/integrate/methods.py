"""The methods of `codegen.simulate` by name, and how each comes to its integrator."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Generic, TypeVar

from codegen.compiled import Compiled
from codegen.integrate import projection, runge_kutta, scipy_, sundials, taylor
from codegen.integrate.dop853 import DOP853
from codegen.integrate.dp5 import DP5
from codegen.integrate.projector import Projector, with_values
from codegen.integrate.tableau import Tableau
from codegen.integrate.trajectory import Problem, Trajectory
from codegen.integrate.tsit5 import TSIT5
from codegen.layout import Layout
from codegen.program import Program
from codegen.targets.registry import c_files
from eom.errors import InputError, unknown_name

T = TypeVar("T")
Integrator = Callable[[Problem], Trajectory]


@dataclass(frozen=True, eq=False)
class SameObject(Generic[T]):
    """A value as a key by identity, kept alive while it is in a cache."""

    value: T

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SameObject) and other.value is self.value

    def __hash__(self) -> int:
        return id(self.value)


@dataclass(frozen=True)
class Task:
    """What is to be integrated: ``signals`` give the inputs over time where they are functions."""

    compiled: Compiled
    problem: Problem
    signals: scipy_.Inputs | None


@dataclass(frozen=True)
class Method:
    """A name, what it is, and what prepares the integrator and says what it is called in full.

    ``projects``: whether states can be brought back onto invariants after each step.
    """

    name: str
    meaning: str
    prepare: Callable[[Task], tuple[Integrator, str]]
    projects: bool = False


@lru_cache(maxsize=64)
def _extended_once(key: SameObject[Compiled], names: tuple[str, ...]) -> tuple[Program, Layout]:
    """Return program and layout of the generated loop, with the projection onto ``names`` if any."""
    compiled = key.value
    if not names:
        return compiled.program, compiled.layout
    return projection.extended(compiled.program, compiled.layout, names, compiled.stable)


@lru_cache(maxsize=64)
def _runge_kutta_once(
    key: SameObject[Compiled], names: tuple[str, ...], tableau: Tableau
) -> runge_kutta.NativeMethod:
    return runge_kutta.build(tableau, *_extended_once(key, names))


@lru_cache(maxsize=64)
def _taylor_once(
    key: SameObject[Compiled], names: tuple[str, ...], order: int
) -> runge_kutta.NativeMethod:
    return taylor.build(*_extended_once(key, names), order)


def _native(compiled: Compiled, method: runge_kutta.NativeMethod) -> Integrator:
    def integrate(problem: Problem) -> Trajectory:
        if not problem.project:
            return runge_kutta.integrate(method, problem)
        found = runge_kutta.integrate(method, with_values(compiled, problem))
        if not (problem.dense_output and problem.t_eval is not None):
            return found
        return replace(found, y=Projector(compiled, problem).points(found.t, found.y))

    return integrate


def _runge_kutta(
    tableau: Tableau, name: str, elsewhere: str
) -> Callable[[Task], tuple[Integrator, str]]:
    """In generated C where that is the target and nothing calls Python; by SciPy otherwise."""

    def prepare(task: Task) -> tuple[Integrator, str]:
        compiled = task.compiled
        if compiled.target == "c" and task.signals is None:
            native = _runge_kutta_once(SameObject(compiled), task.problem.project, tableau)
            return _native(compiled, native), f"{name} in generated C"
        integrator, used = _scipy(elsewhere)(task)
        reason = " (inputs are Python functions)" if task.signals is not None else ""
        return integrator, used + reason

    return prepare


_dop853 = _runge_kutta(DOP853, "DOP853", "DOP853")


def _taylor(task: Task) -> tuple[Integrator, str]:
    if task.signals is not None:
        raise InputError(
            "method taylor cannot differentiate inputs that are Python functions",
            hint="write them into the system as functions of time, or choose DOP853",
        )
    order = taylor.order_of(task.problem.rtol)
    native = _taylor_once(SameObject(task.compiled), task.problem.project, order)
    return _native(task.compiled, native), f"Taylor series of order {order} in generated C"


def _scipy(name: str) -> Callable[[Task], tuple[Integrator, str]]:
    def prepare(task: Task) -> tuple[Integrator, str]:
        loop = "in the loop of" if name in scipy_.TABLEAUX else "of"
        used = f"{name} {loop} SciPy over {task.compiled.target} functions"
        return lambda p: scipy_.integrate(task.compiled, p, name, task.signals), used

    return prepare


def _sundials(kind: str) -> Callable[[Task], tuple[Integrator, str]]:
    def prepare(task: Task) -> tuple[Integrator, str]:
        sundials.require(f"sundials:{kind}")
        used = f"CVODE of SUNDIALS ({kind}) over {task.compiled.target} functions"
        return lambda p: scipy_.integrate(task.compiled, p, f"CVODE {kind}", task.signals), used

    return prepare


ROWS = (
    Method("auto", "DOP853", _dop853, projects=True),
    Method("DOP853", "explicit Runge-Kutta of order 8, loop in C beside the target c", _dop853,
           projects=True),
    Method("DP5", "explicit Runge-Kutta of order 5, of Dormand and Prince, loop in C likewise",
           _runge_kutta(DP5, "DP5", "RK45"), projects=True),
    Method("Tsit5", "explicit Runge-Kutta of order 5, of Tsitouras, loop in C likewise",
           _runge_kutta(TSIT5, "Tsit5", "Tsit5"), projects=True),
    Method("taylor", "Taylor series, loop in C, order from the relative tolerance", _taylor,
           projects=True),
    *(Method(f"scipy:{m}", f"{m} of SciPy over the compiled functions", _scipy(m),
             projects=m not in scipy_.MULTISTEP)
      for m in scipy_.METHODS),
    *(Method(f"sundials:{k}", f"CVODE of SUNDIALS, {k}; needs the extra sundials", _sundials(k))
      for k in sundials.KINDS),
)  # fmt: skip
METHODS = tuple(row.name for row in ROWS)
"""Names that ``method`` takes; `ROWS` says what they are."""


def integrator_of(task: Task, method: str) -> tuple[Integrator, str]:
    """Choose the integrator; return it, ready to run, and what it is called."""
    row = next((row for row in ROWS if row.name == method), None)
    if row is None:
        raise unknown_name("method", method, METHODS)
    if task.problem.project and not row.projects:
        able = [row.name for row in ROWS if row.projects]
        raise InputError(
            f"method {method} cannot project its states onto invariants",
            expected=f"one of {', '.join(able)}",
        )
    return row.prepare(task)


def _taylor_files(program: Program, layout: Layout, rtol: float) -> Mapping[str, str]:
    return taylor.files(program, layout, taylor.order_of(rtol))


def _tableau_files(tableau: Tableau) -> Callable[[Program, Layout, float], Mapping[str, str]]:
    return lambda program, layout, rtol: runge_kutta.files(tableau, layout)


INTEGRATORS: Mapping[str, Callable[[Program, Layout, float], Mapping[str, str]]] = {
    **{t.name: _tableau_files(t) for t in (DOP853, DP5, TSIT5)},
    "taylor": _taylor_files,
}
"""Integrators whose whole loop is generated C, by the name that their files carry."""


def files(program: Program, layout: Layout, method: str, rtol: float = 1e-9) -> Mapping[str, str]:
    """Return header and source in C of an integrator, one of `INTEGRATORS`, by file name.

    They include the header of the functions that target ``c`` generates. ``rtol``: decides the order
    of method taylor; what is generated takes other tolerances, too, but not as fast. Raises
    `InputError` for other words, and where a value has no Taylor series.
    """
    if method not in INTEGRATORS:
        raise unknown_name("integrator", method, INTEGRATORS)
    return INTEGRATORS[method](program, layout, rtol)


def package(program: Program, layout: Layout, method: str, rtol: float = 1e-9) -> Mapping[str, str]:
    """Return all files of target ``c``, with this integrator instead of DOP853, as `files` does."""
    return c_files(program, layout, files(program, layout, method, rtol))
