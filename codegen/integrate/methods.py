"""The methods of `codegen.simulate` by name, and how each comes to its integrator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from codegen.compiling import events
from codegen.compiling.compiled import Compiled
from codegen.frontend.layout import Layout
from codegen.integrate import choice, group, rkmk, scipy_, splitting, sundials
from codegen.integrate.choice import Task
from codegen.integrate.scipy_ import Projector, with_values
from codegen.ir.program import Program, SameObject
from codegen.loops import projection, runge_kutta, running, taylor
from codegen.loops.crossings import GROUP
from codegen.loops.tableaux import DOP853, DP5, TSIT5, Tableau
from codegen.native.trajectory import Problem, Trajectory
from eom.errors import InputError, unknown_name

Integrator = Callable[[Problem], Trajectory]


@dataclass(frozen=True)
class Method:
    """A name, what it is, and what prepares the integrator and says what it is called in full.

    ``projects``: whether states can be brought back onto invariants after each step.
    ``finds``: whether events are found.
    """

    name: str
    meaning: str
    prepare: Callable[[Task], tuple[Integrator, str]]
    projects: bool = False
    finds: bool = False


_WITHOUT_FUNCTIONS = (
    "write inputs into the system by System.with_control, or sample them: codegen.Sampled"
)
"""What to do with inputs that are Python functions where generated C is needed."""

Further = tuple[tuple[str, ...], tuple[events.Event, ...], bool]
"""What a loop does beside integrating: invariants to project onto, events, laws that are sampled."""


def _further(task: Task) -> Further:
    """Return that of a task; of its events what generated code depends on, the expressions."""
    return task.problem.project, events.bare(task.events), bool(task.problem.laws)


@lru_cache(maxsize=64)
def _extended_once(key: SameObject[Compiled], further: Further) -> tuple[Program, Layout]:
    """Return program and layout of the generated loop, with its projection and events if any."""
    compiled = key.value
    names, looked_for, _ = further
    found = compiled.program, compiled.layout
    if names:
        found = projection.extended(*found, names, compiled.stable)
    if not looked_for or GROUP in found[1].results:  # over time since a start: made there
        return found
    return events.extended(*found, compiled, looked_for)


@lru_cache(maxsize=64)
def _runge_kutta_once(
    key: SameObject[Compiled], further: Further, tableau: Tableau
) -> running.NativeMethod:
    return runge_kutta.build(tableau, *_extended_once(key, further), further[2])


@lru_cache(maxsize=64)
def _rkmk_once(
    key: SameObject[Compiled], sampled: bool
) -> tuple[running.NativeMethod, group.Between]:
    return rkmk.build(key.value.program, key.value.layout, sampled=sampled)


@lru_cache(maxsize=64)
def _splitting_once(
    key: SameObject[Compiled], sampled: bool
) -> tuple[running.NativeMethod, group.Between]:
    return splitting.build(key.value.program, key.value.layout, sampled)


@lru_cache(maxsize=64)
def _taylor_once(key: SameObject[Compiled], further: Further, order: int) -> running.NativeMethod:
    return taylor.build(*_extended_once(key, further), order, further[2])


@dataclass(frozen=True)
class Native:
    """A loop in generated C as an integrator, with what its projection needs beside it."""

    compiled: Compiled
    method: running.NativeMethod

    def __call__(self, problem: Problem) -> Trajectory:
        """Integrate a problem."""
        if not problem.project:
            return running.integrate(self.method, problem)
        found = running.integrate(self.method, with_values(self.compiled, problem))
        if not (problem.dense_output and problem.t_eval is not None):
            return found
        return replace(found, y=Projector(self.compiled, problem).points(found.t, found.y))

    def quick(self, problem: Problem, **said: Any) -> running.Prepared | None:
        """Return the quick way for problems like this one but for their values, if there is one.

        ``said``: fields of the trajectories beside what is found.
        """
        quick = None if problem.project else self.method.quick
        return None if quick is None else quick.prepared(problem, **said)


def _runge_kutta(
    tableau: Tableau, name: str, elsewhere: str
) -> Callable[[Task], tuple[Integrator, str]]:
    """In generated C where that is the target and nothing calls Python; by SciPy otherwise."""

    def prepare(task: Task) -> tuple[Integrator, str]:
        compiled = task.compiled
        if compiled.target == "c" and task.signals is None:
            native = _runge_kutta_once(SameObject(compiled), _further(task), tableau)
            return Native(compiled, native), f"{name} in generated C"
        if task.events:
            raise InputError(
                f"method {name} finds events in generated C alone",
                got="inputs that are Python functions" if task.signals else compiled.target,
                expected="the target c, and inputs that are numbers",
                hint=_WITHOUT_FUNCTIONS if task.signals else "",
            )
        integrator, used = _scipy(elsewhere)(task)
        reason = " (inputs are Python functions)" if task.signals is not None else ""
        return integrator, used + reason

    return prepare


_dop853 = _runge_kutta(DOP853, "DOP853", "DOP853")


def _taylor(task: Task) -> tuple[Integrator, str]:
    if task.signals is not None:
        raise InputError(
            "method taylor cannot differentiate inputs that are Python functions",
            hint="write them into the system by System.with_control, sample them by codegen.Sampled, or "
            "choose DOP853",
        )
    order = taylor.order_of(task.problem.rtol)
    native = _taylor_once(SameObject(task.compiled), _further(task), order)
    return Native(task.compiled, native), f"Taylor series of order {order} in generated C"


def _refuse_signals(name: str, task: Task) -> None:
    if task.signals is not None:
        raise InputError(
            f"method {name} runs in C and cannot call inputs that are Python functions",
            hint="write them into the system by System.with_control, sample them by codegen.Sampled, or "
            "choose DOP853",
        )


def _rkmk(task: Task) -> tuple[Integrator, str]:
    _refuse_signals("rkmk", task)
    native, evaluate = _rkmk_once(SameObject(task.compiled), bool(task.problem.laws))
    used = "Runge-Kutta-Munthe-Kaas of order 8 in generated C"
    return lambda problem: group.integrate(native, evaluate, problem), used


def _splitting(task: Task) -> tuple[Integrator, str]:
    _refuse_signals("splitting", task)
    native, evaluate = _splitting_once(SameObject(task.compiled), bool(task.problem.laws))
    used = f"splitting of order {splitting.ORDER} in generated C"
    return lambda problem: group.integrate(native, evaluate, problem), used


def _scipy(name: str) -> Callable[[Task], tuple[Integrator, str]]:
    def prepare(task: Task) -> tuple[Integrator, str]:
        loop = "in the loop of" if name in scipy_.TABLEAUX else "of"
        used = f"{name} {loop} SciPy over {task.compiled.target} functions"
        return lambda p: scipy_.integrate(task.compiled, p, name, task.signals), used

    return prepare


def _auto(task: Task) -> tuple[Integrator, str]:
    return choice.prepared(task, {row.name: row.prepare for row in ROWS})


def begin(program: Program, layout: Layout, method: str, rtol: float) -> None:
    """Begin to compile the loop in C that a method is going to need, beside all else that is done.

    For ``auto`` that of an explicit method; where another is taken, or what it does beside integrating
    stands in another loop, nothing is lost but the work. Nothing is begun for other methods.
    """
    order = taylor.order_of(rtol)
    if method == "auto":
        method = "DOP853" if choice.against_series(program, layout, order) else "taylor"
    if method == "taylor":
        taylor.begin(program, layout, order)
    elif method in _TABLEAUX:
        runge_kutta.begin(_TABLEAUX[method], program, layout)


_TABLEAUX = {"DOP853": DOP853, "DP5": DP5, "Tsit5": TSIT5}


def decided(task: Task) -> choice.Decided | None:
    """Return what `auto` decides for all initial states at once: see `choice.decided`."""
    return choice.decided(task, {row.name: row.prepare for row in ROWS})


def resumed(task: Task, first: Trajectory) -> Trajectory:
    """Go on where a Taylor series of an ensemble stopped: see `choice.resumed`."""
    return choice.resumed(task, {row.name: row.prepare for row in ROWS}, first)


def _sundials(kind: str) -> Callable[[Task], tuple[Integrator, str]]:
    def prepare(task: Task) -> tuple[Integrator, str]:
        sundials.require(f"sundials:{kind}")
        used = f"CVODE of SUNDIALS ({kind}) over {task.compiled.target} functions"
        return lambda p: scipy_.integrate(task.compiled, p, f"CVODE {kind}", task.signals), used

    return prepare


ROWS: tuple[Method, ...] = (
    Method("auto", "closed form, Taylor series, DOP853 or a stiff method: see `choice`", _auto,
           projects=True, finds=True),
    Method("DOP853", "explicit Runge-Kutta of order 8, loop in C beside the target c", _dop853,
           projects=True, finds=True),
    Method("DP5", "explicit Runge-Kutta of order 5, of Dormand and Prince, loop in C likewise",
           _runge_kutta(DP5, "DP5", "RK45"), projects=True, finds=True),
    Method("Tsit5", "explicit Runge-Kutta of order 5, of Tsitouras, loop in C likewise",
           _runge_kutta(TSIT5, "Tsit5", "Tsit5"), projects=True, finds=True),
    Method("taylor", "Taylor series, loop in C, order from the relative tolerance", _taylor,
           projects=True, finds=True),
    Method("rkmk", "Lie-group Runge-Kutta of order 8 for attitude as a quaternion", _rkmk),
    Method("splitting", "symplectic: exact free-body turns and kicks of torque, equal steps", _splitting),
    *(Method(f"scipy:{m}", f"{m} of SciPy over the compiled functions", _scipy(m),
             projects=m not in scipy_.MULTISTEP)
      for m in scipy_.METHODS),
    *(Method(f"sundials:{k}", f"CVODE of SUNDIALS, {k}; needs the extra sundials", _sundials(k))
      for k in sundials.KINDS),
)  # fmt: skip
OF_ATTITUDE = (rkmk.NAME, splitting.NAME)
"""Methods for systems with an attitude quaternion alone."""
METHODS = tuple(row.name for row in ROWS)
"""Names of integration methods that `codegen.simulate` takes as ``method``.

``auto`` chooses, and says why. DOP853, DP5, Tsit5 (explicit Runge-Kutta methods of orders 8, 5, 5) and
taylor (Taylor series) run in generated C beside the target c; rkmk and splitting are for attitude as a
quaternion, their tolerance is an angle in rad and a part of the length of the angular momentum, not of each
component; names with ``scipy:`` and ``sundials:`` are methods of these libraries over the compiled
functions. `ROWS` says more. Sources: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations
I (1993); Jorba and Zou, Experimental Mathematics 14 (2005); Munthe-Kaas, Appl. Numer. Math. 29 (1999)
115; Blanes and Moan, J. Comput. Appl. Math. 142 (2002) 313.
"""


def can_project(method: str) -> bool:
    """Return whether a method brings states back onto invariants; an unknown one cannot."""
    return any(row.name == method and row.projects for row in ROWS)


def integrator_of(task: Task, method: str) -> tuple[Integrator, str]:
    """Choose the integrator; return it, ready to run, and what it is called."""
    row = next((row for row in ROWS if row.name == method), None)
    if row is None:
        raise unknown_name("method", method, METHODS)
    if task.problem.project and not row.projects:
        able = [row.name for row in ROWS if row.projects]
        raise InputError(f"method {method} cannot project its states onto invariants",
                         expected=f"one of {', '.join(able)}")  # fmt: skip
    if task.events and not row.finds:
        able = [row.name for row in ROWS if row.finds]
        raise InputError(f"method {method} finds no events", got=", ".join(e.label for e in task.events),
                         expected=f"one of {', '.join(able)}")  # fmt: skip
    return row.prepare(task)
