"""Simulate a system: one run of an integrator that is prepared, and kept for the next one.

Integrators that are kept by whoever makes many runs; what both take is said once, with `simulate`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from codegen.compiling.compiled import Compiled
from codegen.compiling.events import Given
from codegen.native.trajectory import MAX_STEPS
from codegen.runs.arguments import arguments_of
from codegen.runs.given import InputsGiven, Values
from codegen.runs.prepared import AUTO, DEFAULT_MARGIN, Integrator, asked_of, prepared, run_of
from codegen.runs.result import Result
from eom.errors import typed
from eom.system import System

KEPT, MOST_KEPT = 64, 4096
"""So many integrators are kept, where times and tolerances to store are so many at most."""


@typed
def simulate(
    system: System | Compiled,
    initial: Values,
    t_span: tuple[float, float],
    parameters: Values = None,
    method: str = AUTO,
    rtol: float = 1e-9,
    atol: ArrayLike | None = None,
    t_eval: ArrayLike | None = None,
    *,
    inputs: InputsGiven | None = None,
    outputs: Sequence[str] | None = None,
    dense_output: bool = False,
    first_step: float | None = None,
    max_step: float = math.inf,
    max_steps: int = MAX_STEPS,
    margin: float = DEFAULT_MARGIN,
    project: bool | str | Sequence[str] | None = None,
    events: Given = None,
    epoch: float = 0.0,
    accuracy: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Result:
    """Integrate ``system`` from ``initial`` over ``t_span`` (s); backwards if the end is earlier.

    Parameters
    ----------
    system : System or Compiled
        What to integrate. An `eom.System` is compiled at the first call, and kept.
    initial : mapping or sequence of float
        The states at the start: numbers by name or in order; by name also texts with units, as "30 deg"
        (`eom.units`), which are put into SI. A state whose rate is zero, and which became a parameter
        of a scene's system, may stand here or among ``parameters``; the initial value counts.
    t_span : (float, float)
        Start and end (s).
    parameters : mapping or sequence of float, optional
        As ``initial``. Not needed where there are none, or where all are compiled in.
    method : str, default "auto"
        One of `METHODS`. With ``auto`` it is a closed form where there is one, else what suits the
        rates; `Result.why` says why.
    rtol : float, default 1e-9
        Relative tolerance: steps meet the local error ``atol + rtol |x|``.
    atol : float or array, optional
        Absolute tolerance, a number or (n,); rtol / 1000 of the scale of each state unless given, see
        `codegen.integrate.scales`.
    t_eval : array, optional
        Times to store (s). Without it every step is stored, with a closed form 1001 times at equal
        distances.
    inputs : mapping or callable, optional
        A number or a function for each input, or one function of all that returns them by name or in
        order. Functions are of time, f(t), or of time and states, f(t, x) with ``x["theta"]``, by what
        they take: what can be called with the time alone is f(t). They are called from Python, and may
        state their knots and longest step (`codegen.Signal`).
    outputs : sequence of str, optional
        Names of outputs and states; only states that these need are integrated. All unless given.
    dense_output : bool, default False
        Whether ``sol`` of the result is made, a function of time.
    first_step : float, optional
        Length of the first step (s).
    max_step : float, default inf
        Longest step (s). A feature of the rates that is narrower than a step may be stepped over,
        unless this is shorter.
    max_steps : int
        Most steps to try; the run stops there, and says so.
    margin : float, default 1e-6
        The run stops where a singularity's expression gets below it.
    project : bool, str or sequence of str, optional
        Invariants, by name or True for all, onto which the state is brought back after each step, by
        the least change (`codegen.loops.projection`); all stored points lie on them. Unless given,
        those that the system maintains: what constraints leave, if the method can project. Methods that
        carry values of earlier steps along cannot.
    events : Event, expression, or several, in order or by name, optional
        Zeros of expressions to find (`codegen.compiling.events.Event`). Of the methods that run in
        generated C, taylor, DOP853, DP5 and Tsit5 find them. The states that they read are integrated
        with those that ``outputs`` need.
    epoch : float, default 0
        Time (s) of the system at which t is zero: its rates read epoch + t, and all times that are
        given or returned are since then, with digits of their own. A run that starts late without one
        keeps its digits too (`codegen.runs.clock`), but its times are then rounded where they are
        stored.
    accuracy : bool, default False
        Whether the error is estimated by a second run, so that ``notice`` says where no digit is left.
        `Result.accuracy` says the same afterwards.
    progress : callable, optional
        Called with the share that is done, 0 to 1.

    Returns
    -------
    Result
        Times, states and outputs by name, events, drift of the invariants, and how the run went.

    Raises
    ------
    InputError
        For unusable arguments.
    AssumptionError
        For values that contradict the system's assumptions.

    Notes
    -----
    Never raises for what happens on the way: it keeps what it has and says in ``status`` and
    ``message`` which quantity failed and when. Units are those of the system. With ``project`` the
    dense output goes through the points of the steps, and off the invariants between them by its own
    error.

    References
    ----------
    Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sect. II.5 and II.6;
    Jorba and Zou, Experimental Mathematics 14 (2005); others in the modules of `codegen.integrate`.

    Examples
    --------
    >>> import sympy as sp
    >>> import codegen
    >>> from eom import System
    >>> y, v, k = sp.symbols("y v k", real=True)
    >>> energy = {"energy": (v**2 + k * y**2) / 2}
    >>> oscillator = System.from_rates("oscillator", {y: v, v: -k * y}, invariants=energy)
    >>> compiled = codegen.compile(oscillator, "numpy")
    >>> run = simulate(compiled, {"y": 1, "v": 0}, (0, sp.pi), {"k": 4}, "scipy:DOP853")
    >>> run.status, round(float(run["y"][-1]), 6), run.drift["energy"].relative < 1e-8
    (0, 1.0, True)
    """
    arguments = (
        system, t_span, method, rtol, atol, t_eval, outputs, dense_output, first_step, max_step,
        max_steps, margin, project, events, epoch,
    )  # fmt: skip
    run = run_of(_prepared(arguments), initial, parameters, inputs, progress)
    return run.with_accuracy() if accuracy else run


@typed
@arguments_of(simulate)
def integrator(  # noqa: D417 - what `simulate` says of its arguments is put in
    system: System | Compiled,
    t_span: tuple[float, float] | None = None,
    method: str = AUTO,
    rtol: float = 1e-9,
    atol: ArrayLike | None = None,
    t_eval: ArrayLike | None = None,
    *,
    inputs: InputsGiven | None = None,
    outputs: Sequence[str] | None = None,
    dense_output: bool = False,
    first_step: float | None = None,
    max_step: float = math.inf,
    max_steps: int = MAX_STEPS,
    margin: float = DEFAULT_MARGIN,
    project: bool | str | Sequence[str] | None = None,
    events: Given = None,
    epoch: float = 0.0,
) -> Integrator:
    """Prepare runs of ``system`` once, to make many with other values: ``run(initial, parameters)``.

    A run gives what `codegen.simulate` gives, to the last bit.

    Parameters
    ----------
    system : System or Compiled
        What to integrate.
    t_span : (float, float), optional
        Start and end (s). May be left out where ``t_eval`` is given: then it is from its first to its
        last time.
    method : str, default "auto"
        One of `METHODS`. One that is named is compiled here; what ``auto`` chooses, which depends on
        the values, at the first run that needs it, and closed forms are found for each run.
    inputs : mapping or callable, optional
        For runs that are given none.

    Returns
    -------
    Integrator
        What `Integrator.run` calls with values.

    Raises
    ------
    InputError
        For unusable arguments.
    CompilerError
        Where the method needs C and there is no compiler.

    Notes
    -----
    A run that ends within some hundred steps costs a few microseconds beside its loop where values are
    numbers by name or in order, the method runs in generated C, and nothing is looked for on the way;
    with units in texts, functions, laws, events, projection, dense output or fewer ``outputs`` it costs
    more. Units are those of the system.

    Examples
    --------
    >>> import sympy as sp
    >>> y, v, k = sp.symbols("y v k", real=True)
    >>> oscillator = System.from_rates("oscillator", {y: v, v: -k * y})
    >>> swing = integrator(oscillator, t_eval=[0, sp.pi], method="scipy:DOP853")
    >>> [round(float(swing.run({"y": 1, "v": 0}, {"k": k})["y"][-1]), 6) for k in (1, 4)]
    [-1.0, 1.0]
    """
    asked = asked_of(
        system, t_span, method, rtol, atol, t_eval, outputs, dense_output, first_step, max_step,
        max_steps, margin, project, events, epoch,
    )  # fmt: skip
    return prepared(asked, inputs)


Arguments = tuple[Any, ...]


def _prepared(arguments: Arguments) -> Integrator:
    """Return an integrator for all arguments but values; the same for equal ones, if these are short."""
    system, span, *rest = arguments
    key = (id(system), *span, *[v if type(v) in _PLAIN else _text(v) for v in rest])
    found = _kept.get(key)
    if found is None:
        found = system, Integrator(asked_of(*arguments), {})
        if _LONG in key:
            return found[1]
    else:
        _kept.pop(key, None)
    _kept[key] = found  # the last is the latest used
    for oldest in list(_kept)[:-KEPT]:
        _kept.pop(oldest, None)
    return found[1]


_kept: dict[tuple[Hashable, ...], tuple[System | Compiled, Integrator]] = {}
"""Integrators by what arguments say, with their system, so that its identity stays its own."""


def _text(value: Any) -> Hashable:
    """Return what stands for an argument among keys; `_LONG` where it is too long, or may change."""
    kind = type(value)
    if kind is list or kind is tuple:
        texts = len(value) <= MOST_KEPT and set(map(type, value)) <= _PLAIN
        return tuple(value) if texts else _LONG
    if kind is np.ndarray and value.size <= MOST_KEPT and value.dtype == np.float64:
        return (value.shape, value.tobytes())
    return _LONG


_PLAIN = {float, int, bool, str, type(None)}
_LONG = object()
