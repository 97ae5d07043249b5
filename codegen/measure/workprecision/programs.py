"""What is measured: this project's methods, SciPy on a lambdified function, heyoka.

A `Program` prepares one run of a case at one tolerance; the run returns its end and the seconds of
the integration alone, everything compiled beforehand. Absolute tolerances are rtol / 1000 for all
but heyoka, which has one tolerance.
"""

from __future__ import annotations

import importlib
import importlib.util
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from codegen.compiling.compiled import Compiled
from codegen.integrate.methods import METHODS
from codegen.measure.workprecision.case import Case
from codegen.native.children import TooLongError, watch
from codegen.native.trajectory import Array
from codegen.runs.simulation import simulate
from eom.errors import InputError, unknown_name

ABSOLUTE = 1e-3
MAX_STEPS = 2_000_000
PEERS = ("DOP853", "LSODA", "Radau")
"""SciPy's methods that run on a lambdified function: the best explicit one, and two for stiff systems."""


@dataclass(frozen=True)
class End:
    """States at the end, seconds, and steps (-1: not reported)."""

    y: Array
    seconds: float
    steps: int


Run = Callable[[float], End]
"""Integrate once; give up with `TooLongError` after so many seconds of processor time
(heyoka: after `MAX_STEPS`)."""


@dataclass(frozen=True)
class Program:
    """A name, and what prepares a run at a tolerance. Raises `InputError` where it does not apply."""

    name: str
    prepare: Callable[[Case, Compiled, float], Run]


def programs(names: Sequence[str] = ()) -> list[Program]:
    """Return the programs by name, in order; all of them without names. Raises `InputError`."""
    rows = [_ours(m) for m in METHODS] + [_solve_ivp(m) for m in PEERS]
    rows.append(Program("heyoka", _heyoka))
    for name in names:
        if name not in {row.name for row in rows}:
            raise unknown_name("method", name, [row.name for row in rows])
    return [row for row in rows if not names or row.name in names]


def _ours(method: str) -> Program:
    def prepare(case: Case, compiled: Compiled, rtol: float) -> Run:
        def run(limit: float) -> End:
            result = simulate(
                compiled,
                case.start,
                (0.0, case.end),
                None,
                method,
                rtol,
                ABSOLUTE * rtol,
                [case.end],
                inputs=case.inputs,
                max_steps=MAX_STEPS,
                progress=watch(limit),
            )
            if result.status != 0:
                raise InputError(result.message)
            return End(result.y_stop, result.seconds, result.steps)

        return run

    return Program(method, prepare)


def numbered(case: Case) -> tuple[list[Any], list[Any], Any]:
    """Return states, rates over them and time alone, and the mass matrix or None."""
    system = case.system
    given = {**case.parameters, **case.inputs}
    quantities = (*system.parameters, *system.inputs)
    values = {q.symbol: sp.Float(given[q.name], 17) for q in quantities}
    rates = [sp.N(system.expand(r).xreplace(values), 17) for r in system.rates]
    mass = system.mass_matrix
    if mass is not None:
        mass = mass.applyfunc(lambda e: sp.N(system.expand(e).xreplace(values), 17))
    return [q.symbol for q in system.states], rates, mass


def lambdified(case: Case) -> Callable[..., Any]:
    """Return f(t, x), as SciPy's users make it: lambdify over floats, common parts shared."""
    states, rates, mass = numbered(case)
    arguments = (case.system.time, states)
    function: Callable[..., Any] = sp.lambdify(arguments, rates, modules="math", cse=True)
    if mass is None:
        return function
    matrix = sp.lambdify(arguments, mass.tolist(), modules="math", cse=True)
    return lambda t, x: np.linalg.solve(matrix(t, x), function(t, x))


def _solve_ivp(method: str) -> Program:
    def prepare(case: Case, _: Compiled, rtol: float) -> Run:
        solve_ivp: Any = importlib.import_module("scipy.integrate").solve_ivp
        function = lambdified(case)
        start = [case.start[n] for n in case.system.state_names]

        def run(limit: float) -> End:
            rates = _watched(function, limit) if limit < np.inf else function
            span, end, atol = (0.0, case.end), [case.end], ABSOLUTE * rtol
            began = time.perf_counter()
            result = solve_ivp(rates, span, start, method, end, rtol=rtol, atol=atol)
            seconds = time.perf_counter() - began
            if not result.success:
                raise InputError(result.message)
            return End(result.y[:, -1], seconds, -1)

        return run

    return Program(f"solve_ivp:{method}", prepare)


def _watched(function: Callable[..., Any], limit: float) -> Callable[..., Any]:
    listener = watch(limit)

    def watched(t: float, x: Any) -> Any:
        listener(t)
        return function(t, x)

    return watched


def _heyoka(case: Case, _: Compiled, rtol: float) -> Run:
    build = heyoka_builder(case)
    start = [case.start[n] for n in case.system.state_names]
    integrator = build(rtol)

    def run(_: float) -> End:
        heyoka: Any = importlib.import_module("heyoka")
        integrator.time = 0.0
        integrator.state[:] = start
        began = time.perf_counter()
        outcome = integrator.propagate_until(case.end, max_steps=MAX_STEPS)
        seconds = time.perf_counter() - began
        if outcome[0] == heyoka.taylor_outcome.step_limit:
            raise TooLongError
        if outcome[0] != heyoka.taylor_outcome.time_limit:
            raise InputError(f"heyoka stopped: {outcome[0]}")
        return End(np.array(integrator.state), seconds, int(outcome[3]))

    return run


def heyoka_builder(case: Case) -> Callable[[float], Any]:
    """Return what makes heyoka's integrator of a case at a tolerance.

    Raises `InputError` where heyoka is not installed, and for what it cannot integrate.
    """
    if importlib.util.find_spec("heyoka") is None:
        raise InputError("heyoka is not installed", hint="pip install 'eom-toolkit[bench]'")
    heyoka: Any = importlib.import_module("heyoka")
    states, rates, mass = numbered(case)
    if mass is not None:
        raise InputError("heyoka takes rates, not a mass matrix")
    start = [case.start[n] for n in case.system.state_names]
    names = {case.system.time: heyoka.time}
    try:
        pairs = [
            (heyoka.expression(str(s)), heyoka.from_sympy(r, names))
            for s, r in zip(states, rates, strict=True)
        ]
    except (TypeError, ValueError) as error:
        raise InputError("heyoka does not know a function", got=str(error)) from None
    return lambda rtol: heyoka.taylor_adaptive(pairs, start, tol=rtol)
