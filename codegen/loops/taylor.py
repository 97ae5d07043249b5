"""Taylor series of high order with their whole loop in generated C, for one system and one order."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.derivatives.taylor import Prepared, prepare
from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.program import RATES, SINGULARITIES, Program
from codegen.loops import crossings, projection, reaches, runge_kutta, switches
from codegen.loops.jets import limited, series
from codegen.loops.runge_kutta import NativeMethod
from codegen.native.trajectory import Array, Stepwise
from codegen.passes.pipeline import by_parameters
from codegen.targets import c

FURTHER_ORDERS = 2
"""Added to the order that is best where work grows with its square: a step also costs a part that does
not depend on it. The best order was 13 where the square alone gives 10 (heavy top and satellite, 1e-6)."""
CAUTION = 1 / 32
"""The last terms are held to this part of the tolerance, since errors of all steps add up."""
FULL, UNSEEN = 2.0**-50, 2.0**-68
"""At tolerances below the first the last terms are held to the second: compensated sums resolve what is
smaller than an ulp, and what is cut off has the same sign in many steps. Over 1e6 rotations of a body
the energy was wrong by 1.3e-12, in proportion to the steps, where terms were held to 2^-52, and by 9e-14
where they were held to 2^-64, growing like the power 0.62 +- 0.11 of the steps."""
FLAGS = ("-O2", "-ffp-contract=fast")
"""Sums of products are nearly all there is: a fused operation does both and rounds once."""


def order_of(rtol: float) -> int:
    """Return the order that suits a tolerance: Jorba and Zou (2005), sect. 3.1, and a few more."""
    held = UNSEEN if rtol < FULL else CAUTION * min(1.0, rtol)
    return math.ceil(1 + FURTHER_ORDERS - math.log(held) / 2)


def _takes_rests(order: int) -> bool:
    """Return whether an order is that of full precision, where the rounding of 1/k counts."""
    return order >= order_of(0.5 * FULL)


def files(program: Program, layout: Layout, order: int) -> Mapping[str, str]:
    """Return header and source of the integrator by file name.

    Raises `InputError` for a value that changes with time and has no Taylor series.
    """
    prepared = _prepared(program, layout)
    values = {
        **_values(prepared, layout, order),
        **crossings.of_taylor(program, layout, f"{identifier(layout.name)}_taylor", order),
    }
    return {
        f"{values['PREFIX']}.{kind}": runge_kutta.fill(f"taylor.{kind}", values)
        for kind in ("h", "c")
    }


def single_text(program: Program, layout: Layout, order: int) -> str:
    """Return functions and integrator as one text that compiles by itself."""
    name = identifier(layout.name)
    header, source = files(program, layout, order).values()
    rest = (header + source).replace(f'#include "{name}.h"\n', "")
    return c.single_text(program, layout) + rest.replace(f'#include "{name}_taylor.h"\n', "")


def _prepared(program: Program, layout: Layout) -> Prepared:
    """Return the rates, and the expressions of events behind them, with the partners of their rules."""
    count = crossings.count_of(layout)
    rates, events = program.results[RATES], program.results.get(crossings.GROUP, ())[:count]
    if events:
        program = replace(program, results={RATES: (*rates, *events)})
    return prepare(program, RATES, layout)


def _values(prepared: Prepared, layout: Layout, order: int) -> dict[str, str]:
    name = identifier(layout.name)
    prefix = f"{name}_taylor"
    further = crossings.count_of(layout)
    functions, constants = series(prepared, f"{prefix}_series", order, further, _takes_rests(order))
    singular, n = len(layout.results[SINGULARITIES]), len(layout.states)
    return {
        "TITLE": comment(layout.title),
        "NAME": name,
        "PREFIX": prefix,
        "UPPER": prefix.upper(),
        "HEADER": f"{prefix}.h",
        "STATES": str(n),
        "SINGULARITIES": str(singular),
        "SINGULAR_ROOM": str(max(1, singular)),
        "COORDINATES": ", ".join(map(str, layout.coordinates)),
        "ORDER": str(order),
        "DENSE_SHAPE": f"[{order}][n]",
        "STACK": f"about {8 * len(prepared.program.instructions) * (order + 1)}",
        "BRANCHES": str(int(prepared.has_branches)),
        "CAUTION": repr(CAUTION),
        "FULL": repr(FULL),
        "UNSEEN": repr(UNSEEN),
        "SERIES_CONSTANTS": str(max(1, constants)),
        "SERIES": "\n".join(functions),
        **projection.texts(layout, prefix, projection.TAYLOR),
        **switches.of_one(prepared, layout, order, bool(further)),
        **reaches.of_one(prepared, order),
    }


@cache
def _structures(
    prefix: str,
    n: int,
    room: int,
    order: int,
    constants: tuple[int, int],
    events: tuple[int, int],
    branches: int,
    limits: int,
) -> tuple[type[ctypes.Structure], type[ctypes.Structure]]:
    """Mirror the two structures of taylor.h."""
    double: Any = ctypes.c_double
    vector: Any = double * n
    state: list[tuple[str, Any]] = [
        (f, double)
        for f in ("t", "t_end", "h", "h_max", "rtol", "margin", "t_low", "t_old", "h_old", "reach")
    ]
    state += [(f, vector) for f in ("atol", "x", "x_low", "x_old", "floor", "size")]
    state += [("jet", vector * order), ("singular", double * room), ("closest", double * room)]
    state += [(f, ctypes.c_longlong) for f in ("steps", "rejected", "evaluations")]
    state += [(f, ctypes.c_int) for f in ("status", "which")]
    state += [("constants", double * constants[0]), ("series_constants", double * constants[1])]
    state += switches.fields(branches, order, n)
    state += reaches.fields(limits)
    state += crossings.fields(events, order)
    return runge_kutta.structures(prefix, state)


def build(program: Program, layout: Layout, order: int) -> NativeMethod:
    """Compile the integrator of a system for this machine; `runge_kutta.integrate` runs it.

    Raises `CompilerError` if that fails, and `InputError` where a value has no Taylor series.
    """
    prepared = _prepared(program, layout)
    text = single_text(program, layout, order)
    prefix = f"{identifier(layout.name)}_taylor"
    events = crossings.count_of(layout)
    _, of_series = series(prepared, f"{prefix}_series", order, events)
    of_rates = len(by_parameters(program, layout.sizes).values)
    constants = (max(1, of_rates), max(1, of_series))
    n, singular = len(layout.states), len(layout.results[SINGULARITIES])
    branches = len(prepared.switches)
    limits = sum(map(len, limited(prepared, order)))
    state, output = _structures(
        prefix,
        n,
        max(1, singular),
        order,
        constants,
        crossings.sizes(program, layout),
        branches,
        limits,
    )
    start, run, library = runge_kutta.loaded(text, FLAGS, prefix, state)
    room = crossings.most(layout)
    return NativeMethod(
        order, TaylorSolution, start, run, state, output, library, room,
        notice=crossings.notice(program, layout), overflows=_overflows,
    )  # fmt: skip


def _overflows(state: Any) -> bool:
    """Return whether the rates are finite where a run stopped, and further coefficients are not."""
    jet = np.ctypeslib.as_array(state.jet)
    return bool(np.isfinite(jet[0]).all() and not np.isfinite(jet).all())


class TaylorSolution(Stepwise):
    """The polynomials of the series."""

    def _within(self, k: NDArray[np.intp], since: Array) -> Array:
        terms, step = self._rows[k], since[:, None]
        value = np.zeros_like(self._x[k])
        for j in range(terms.shape[1] - 1, -1, -1):
            value = (value + terms[:, j]) * step
        return value + self._x[k]
