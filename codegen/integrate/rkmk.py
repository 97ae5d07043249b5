"""Runge-Kutta methods of Munthe-Kaas for systems with an attitude quaternion, in generated C.

A step from q0 looks for q = q0 exp(a/2) and solves for the rotation vector a, whose rate is the inverse
of the differential of exp, exact in closed form for rotations, applied to the angular velocity; the
other variables go along (Munthe-Kaas, Appl. Numer. Math. 29 (1999) 115; Iserles, Munthe-Kaas, Norsett and
Zanna, Acta Numerica 9 (2000) 215). Any Runge-Kutta method keeps its order: here DOP853, order 8. The
quaternion is a product of unit quaternions, held in two parts; a rigid body is moved by its momentum with
components in the reference frame (`codegen.integrate.group`), which without torque does not change at
all. Dense output is the interpolant of a and of the others, of order 7, so that it is a rotation, too.

Errors are those of the states, each relative to its own size, as everywhere: what those of the turn and of
momentum make of them to first order. Where a body rate was left out as a first integral, it is kept to the
tolerance, too. A body rate follows from the momentum with the rounding error of H/J, below which nothing is
asked of a step: a run in which that is more than the tolerance of a small rate says so, one in which it is
far above, as for a needle, ends at its start with the reason.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

from codegen.frontend.layout import Layout, names_of
from codegen.integrate import group
from codegen.integrate.group import (
    ERRORS,
    FIXED,
    ROUNDING,
    SLOPES,
    START,
    STATES,
    Variables,
    local,
    start,
)
from codegen.ir.names import identifier
from codegen.ir.program import RATES, SINGULARITIES, Program
from codegen.loops import lookout, runge_kutta, samples
from codegen.loops.running import NativeMethod
from codegen.loops.tableaux import DOP853, Row, Tableau
from codegen.native import native
from codegen.native.trajectory import Problem
from codegen.passes.pipeline import by_parameters

NAME = "rkmk"
FURTHER_STATUS = """\
    {name}_THIN = 7,     /* rounding of momentum alone is more than the tolerance of a body rate */
"""
KEPT = ("slopes", "states", "errors", "rounding")
"""The functions of a generated file whose constants an integrator keeps."""


_KEEP = """\
        double strays[4 + M];
        errors_of(s, y_new, off, u, strays);
        for (int i = 0; i < 4 + M; ++i) keep_jump(s, i, s->t, fabs(strays[i]), allowed(s, x_new, i));
"""


@dataclass(frozen=True)
class _Shape:
    """Sizes of the arrays of an integrator."""

    variables: Variables
    tableau: Tableau
    states: int

    @property
    def local(self) -> int:
        return 3 + self.variables.number

    @property
    def point(self) -> int:
        return 4 + self.variables.number

    @property
    def terms(self) -> int:
        """Number of states' vectors that one step of dense output fills."""
        return -(-(self.point + self.tableau.dense_terms * self.local) // self.states)


def files(program: Program, layout: Layout, tableau: Tableau = DOP853) -> Mapping[str, str]:
    """Return header and source of the integrator by file name.

    Raises `InputError` for systems without an attitude quaternion, or with several.
    """
    filled, *_ = _filled(program, layout, tableau)
    return filled


def build(
    program: Program, layout: Layout, tableau: Tableau = DOP853, sampled: bool = False
) -> tuple[NativeMethod, group.Between]:
    """Compile the integrator of a system for this machine; `group.integrate` runs it.

    Raises `CompilerError` if that fails, and `InputError` as `files`.
    """
    filled, shape, constants, watch = _filled(program, layout, tableau)
    if sampled:
        begin_, changed = start(program, shape.variables), local(program, shape.variables)
        rows = ((begin_, START), (begin_, FIXED), (changed, STATES))
        group.check_sampled(NAME, layout, rows)
    text = group.single_text(program, layout, NAME, filled, sampled)
    prefix = f"{identifier(layout.name)}_{NAME}"
    room = max(1, len(layout.results[SINGULARITIES]))
    of_rates = max(1, len(by_parameters(program, layout.sizes).values))
    sizes = (of_rates, *(constants[name] for name in KEPT))
    state, output = _structures(prefix, shape, room, sizes, watch.fields, watch.width)
    flags = native.flags_for(0, len(program.instructions))
    begin, run, library = runge_kutta.loaded(text, flags, prefix, state)
    method = NativeMethod(
        shape.terms, group.unbound, begin, run, state, output, library,
        notice=partial(_notice, shape.variables, names_of(layout.states)),
        sampled=samples.functions(library, prefix) if sampled else None,
    )  # fmt: skip
    return method, group.between(library, prefix)


def _notice(variables: Variables, names: Sequence[str], state: Any, problem: Problem) -> str:
    """Return which body rates rounding of the momentum hides more of than the tolerance asks for."""
    body = variables.attitude.body
    if body is None:
        return ""
    asked = [(k, s) for k, s in enumerate(body.rates) if s >= 0]
    hidden = {
        names[s]: state.noise[k]
        for k, s in asked
        if state.noise[k] > problem.atol[s] + problem.rtol * state.largest[k]
    }
    if not hidden:
        return ""
    return (
        f"rounding of the momentum is {max(hidden.values()):.1e} in {', '.join(hidden)}, more than "
        "rtol asks for; methods taylor and DOP853 resolve small rates beside large ones"
    )


def _filled(
    program: Program, layout: Layout, tableau: Tableau
) -> tuple[Mapping[str, str], _Shape, dict[str, int], lookout.Lookout]:
    variables = group.variables_of(NAME, layout)
    shape = _Shape(variables, tableau, len(layout.states))
    values = group.values(layout, NAME)
    changed, begin = local(program, variables), start(program, variables)
    parts = [(changed, SLOPES, "slopes"), (changed, STATES, "states"), (changed, ERRORS, "errors")]
    parts += [(changed, ROUNDING, "rounding"), (begin, START, "begin"), (begin, FIXED, "fixed")]
    made = group.functions(values["PREFIX"], parts)
    values |= _of_variables(shape, made) | _of_tableau(tableau)
    slopes = replace(changed, results={RATES: changed.results[SLOPES]})
    steps = lookout.Steps(tableau, shape.local, shape.point, _KEEP)
    watch = lookout.of(slopes, values["PREFIX"], steps)
    values |= _of_watch(shape, watch)
    values["FURTHER_STATUS"] = FURTHER_STATUS.format(name=values["UPPER"])
    filled = {
        f"{values['PREFIX']}.{kind}": runge_kutta.fill(f"rkmk.{kind}", values)
        for kind in ("h", "c")
    }
    return filled, shape, made.constants, watch


def _of_watch(shape: _Shape, watch: lookout.Lookout) -> dict[str, str]:
    wide = watch.width > 0
    return {
        "WIDTH": "W" if wide else "D",
        "SLOPES": "watched" if wide else "slopes",
        "RATES_ROOM": str(shape.local + watch.width),
        **watch.texts,
    }


def _of_variables(shape: _Shape, made: group.Functions) -> dict[str, str]:
    variables = shape.variables
    quaternion = variables.attitude.quaternion
    first = next(s for s in variables.compared[4:] if s >= 0) if variables.number else 0
    body = "begins with the momentum, components in the reference frame"
    return {
        "VARIABLES": body if variables.momentum else "are the other states",
        "VARIABLE_COUNT": str(variables.number),
        "LOCAL": str(shape.local),
        "POINT": str(shape.point),
        "DENSE_SHAPE": "[@ROW@]",
        "ROW": str(shape.terms * shape.states),
        "MOMENTUM": str(variables.momentum),
        "QUATERNION": ", ".join(map(str, quaternion)),
        "STATE_OF": ", ".join(map(str, variables.compared)),
        "TOLERANCE_OF": ", ".join(str(s if s >= 0 else first) for s in variables.compared),
        "KERNELS": made.text,
        **{f"OF_{name.upper()}": str(made.constants[name]) for name in KEPT},
        "OF_START": str(max(made.constants["begin"], made.constants["fixed"])),
        "STACK": f"about {8 * shape.local * (len(shape.tableau.stages) + 16)}",
    }


def _of_tableau(tableau: Tableau) -> dict[str, str]:
    last, order = tableau.main_stages, tableau.order
    main = [_stage(tableau, s) for s in range(1, last)]
    extra = [_stage(tableau, s) for s in range(last + 1, len(tableau.stages))]
    dense = [
        f"        dense[{3 + d} * D] = h * ({_sum(row)});" for d, row in enumerate(tableau.dense)
    ]
    return {
        "METHOD": f"a Runge-Kutta method of Munthe-Kaas by {tableau.name.upper()}, of order {order},",
        "ORDER": str(order),
        "LAST": str(last),
        "ALL_STAGES": str(len(tableau.stages)),
        "DENSE_TERMS": str(tableau.dense_terms),
        "EVALUATIONS": str(last),
        "DENSE_EVALUATIONS": str(len(extra)),
        "STAGES": "\n".join(main),
        "DENSE_STAGES": "\n".join(extra),
        "DENSE_COEFFICIENTS": "\n".join(dense),
        "UPDATE": _sum(tableau.stages[last]),
        "ERROR_HIGH": _sum(tableau.error_high),
        "ERROR_LOW": _sum(tableau.error_low),
        "ROOT": "sqrt(sqrt(sqrt(error)))" if order == 8 else f"pow(error, 1.0 / {order}.0)",
    }


def _sum(row: Row) -> str:
    terms = [f"{weight!r} * k[{j}][i]" for j, weight in enumerate(row) if weight]
    return " + ".join(terms).replace("+ -", "- ")


def _stage(tableau: Tableau, s: int) -> str:
    indent = "        " if s < tableau.main_stages else "    "
    return (
        f"{indent}for (int i = 0; i < D; ++i) a[i] = h * ({_sum(tableau.stages[s])});\n"
        f"{indent}stage(s, s->t + {tableau.nodes[s]!r} * h, a, u, k[{s}]);"
    )


@cache
def _structures(
    prefix: str,
    shape: _Shape,
    room: int,
    constants: tuple[int, ...],
    watched: tuple[tuple[str, Any], ...],
    width: int,
) -> tuple[type[ctypes.Structure], type[ctypes.Structure]]:
    """Mirror the two structures of rkmk.h."""
    double: Any = ctypes.c_double
    names = ("t", "t_end", "h", "h_max", "rtol", "margin", "t_low", "t_old", "h_old")
    lengths = (
        ("atol", shape.states), ("x", shape.states), ("y", shape.point), ("y_low", shape.point),
        ("f", shape.local + width), ("size", shape.point), ("largest", 3), ("noise", 3),
        ("row", shape.terms * shape.states), ("singular", room), ("closest", room),
    )  # fmt: skip
    state: list[tuple[str, Any]] = [(f, double) for f in names]
    state += [(f, double * length) for f, length in lengths]
    state += [(f, ctypes.c_longlong) for f in ("steps", "rejected", "evaluations")]
    state += [(f, ctypes.c_int) for f in ("status", "which", "after_rejection")]
    kept = zip(("constants", *(f"of_{name}" for name in KEPT)), constants, strict=True)
    state += [(f, double * length) for f, length in kept]
    state += watched
    return runge_kutta.structures(prefix, state)
