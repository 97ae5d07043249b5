"""Taylor series of high order with their whole loop in generated C, for one system and one order.

Steps of method taylor that end where the series of an argument may no longer be trusted.

An operation that is no polynomial is seen by its series near one point alone. How far its argument may
move from there is a row of `codegen.watch.trust`; the argument's own coefficients say how far it moves.
Where that is more, the step is cut; smooth motions pass the test as they are. A step that is cut down to
rounding, as a value comes to a singularity that the rates do not have, is made all the same, so that kinks
are passed; many of these in a row end the run. What stands in the templates of one trajectory and of
lanes is a table; it is empty for polynomials.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cache, lru_cache
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.derivatives.taylor import Prepared, prepare
from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.program import RATES, SINGULARITIES, Program, SameObject
from codegen.loops import crossings, projection, runge_kutta, samples, switches
from codegen.loops.jets import limited, series
from codegen.loops.running import NativeMethod
from codegen.native import native
from codegen.native.trajectory import Array, Stepwise
from codegen.passes.pipeline import by_parameters
from codegen.targets import c
from codegen.watch.trust import is_checked
from eom.errors import InputError

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


def single_text(
    program: Program, layout: Layout, order: int, sampled: bool = False, whole: bool = True
) -> str:
    """Return functions and integrator as one text that compiles by itself.

    ``sampled``: with what stands round the loop where laws are sampled. ``whole``: with functions that
    the integrator does not call.
    """
    name = identifier(layout.name)
    header, source = files(program, layout, order).values()
    rest = (header + source).replace(f'#include "{name}.h"\n', "")
    rest = rest.replace(f'#include "{name}_taylor.h"\n', "")
    if sampled:
        rest = samples.around(rest, "taylor", layout)
    return c.single_text(program, layout, "" if whole else rest) + rest


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
        **of_one(prepared, order),
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
    state += fields(limits)
    state += crossings.fields(events, order)
    return runge_kutta.structures(prefix, state)


@lru_cache(maxsize=4)
def _text_once(
    program: SameObject[Program], layout: SameObject[Layout], order: int, sampled: bool
) -> str:
    return single_text(program.value, layout.value, order, sampled, whole=False)


def begin(program: Program, layout: Layout, order: int) -> None:
    """Begin to compile what `build` needs, see `codegen.native.native.ahead`; nothing without a series."""
    with suppress(InputError):
        native.ahead(_text_once(SameObject(program), SameObject(layout), order, False), FLAGS)


def build(program: Program, layout: Layout, order: int, sampled: bool = False) -> NativeMethod:
    """Compile the integrator of a system for this machine; `running.integrate` runs it.

    Raises `CompilerError` if that fails, and `InputError` where a value has no Taylor series.
    """
    prepared = _prepared(program, layout)
    text = _text_once(SameObject(program), SameObject(layout), order, sampled)
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
        sampled=samples.functions(library, prefix) if sampled else None,
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


MOST_HELD = 64
"""So many steps in a row that are no longer than rounding: nothing leads away from the singularity."""
FINEST_CHECK = 2.0**-46
"""The slope after every step is held to so much at least: what rounding makes of sharp rates is more."""

_ONE = {
    "REACH_FIELDS": "    int held;                    /* steps in a row, no longer than rounding */\n",
    "REACH_START": "    s->held = 0;\n",
    "REACH_ROOM": "    double moving[LINEAR + CURVED * P];\n",
    "REACH_JET": ", moving",
    "REACH_STEP": f"""\
        const double inside = within_reach(moving, smaller(h_abs, fabs(rest)), smallest);
        if (inside < h_abs) {{
            s->held = inside <= smallest ? s->held + 1 : 0;
            if (s->held > {MOST_HELD}) return stuck(s, 100.0 * smallest * direction, u);
            h_abs = larger(inside, smallest);
        }}
""",
}
"""What stands in the templates of one trajectory whose rates have limits."""
_LANES = {
    "REACH_FIELDS": "    lane_ held;\n",
    "REACH_ENTER": "        r->held[lane] = 0.0;\n",
    "REACH_STUCK": f"((mask_)(r->held > {MOST_HELD}.0) | (",
    "REACH_STUCK_END": "))",
    "REACH_STEP": """\
    const lane_ inside = within_reach_(r, smaller_(h_abs, far), smallest);
    const mask_ cut = (mask_)(inside < h_abs);
    s->held = lanes_choose_(cut & (mask_)(inside <= smallest), r->held + 1.0, lanes_all_(0.0));
    h_abs = lanes_choose_(cut, larger_(inside, smallest), h_abs);
""",
    "REACH_FURTHER": "    lane_ held;\n",
    "REACH_PASSED": "        run.held = step.held;\n",
}
"""The same of lanes."""


def of_one(prepared: Prepared, order: int) -> dict[str, str]:
    """Return what the template of one trajectory needs."""
    straight, curved = limited(prepared, order)
    checked = is_checked(prepared, (*straight, *curved))
    check = f"larger(s->rtol, {FINEST_CHECK!r})" if checked else "s->rtol"
    doubt = {"CHECKED": "1 || " if checked else "", "CHECK": check}
    if not (straight or curved):
        return dict.fromkeys(_ONE, "") | {"REACHES": "", **doubt}
    counts = {"LINEAR": int(bool(straight)), "CURVED": len(curved)}
    return {**_ONE, "REACHES": _filled("reaches.c", counts), **doubt}


def of_lanes(prepared: Prepared, order: int) -> dict[str, str]:
    """Return what the template of lanes needs."""
    straight, curved = limited(prepared, order)
    checked = is_checked(prepared, (*straight, *curved))
    check = f"fmax(o->rtol, {FINEST_CHECK!r})" if checked else "o->rtol"
    doubt = {"CHECKED": "1 || " if checked else "", "CHECK": check}
    if not (straight or curved):
        return dict.fromkeys(_LANES, "") | {"REACHES": "", **doubt}
    first = f"P * N + P * {len(prepared.switches)}"
    places = {"LINEAR": int(bool(straight)), "LIMITS": len(curved), "FIRST": first}
    return {**_LANES, "REACHES": _filled("reaches_lanes.c", places), **doubt}


def _filled(template: str, values: Mapping[str, object]) -> str:
    text = resources.files("codegen.loops").joinpath(template).read_text("ascii")
    for key, value in values.items():
        text = text.replace(f"@{key}@", str(value))
    return text


def fields(count: int) -> list[tuple[str, Any]]:
    """Mirror the field of the structure of one trajectory; ``count``: of limits."""
    return [("held", ctypes.c_int)] if count else []
