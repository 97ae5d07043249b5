"""Symplectic splitting for a rigid body whose torque depends on attitude, time and parameters, in C.

The motion is split into torque alone, which changes the momentum at constant attitude, and the torque-free
motion, which changes the attitude at constant momentum; both flows are exact, and a symmetric
composition of them has the order of its coefficients. The torque-free energy is quadratic in the
momentum, so that compositions for Runge-Kutta-Nystroem problems serve (Blanes and Moan, J. Comput. Appl.
Math. 142 (2002) 313).

All steps of a run are equal: that is why energy does not drift (Hairer, Lubich and Wanner, Geometric
Numerical Integration, 2nd ed. (2006), sect. IX.8; steps that follow the motion lose it unless they are
chosen reversibly, sect. VIII.3, and then energy is bounded for reversible motions alone, which a torque
that changes with time does not make). How long they are is found by the run itself: every two of them
are compared with one of twice the length from the same start, which costs half as much again, and by
their order that gives the local error of one (Hairer, Norsett and Wanner, Solving Ordinary Differential
Equations I (1993), sect. II.4). Where it exceeds the relative tolerance, in the angle of the turn and
relative to the largest momentum so far, or where the fastest rate of body, frame and torque times the
longest part of a step is more than 2, the run begins again with shorter steps; what was done counts as
rejected. So the tolerance holds for each step of the run that is handed out. If that takes more than
``max_steps`` steps the run is refused, and it ends at a place where shorter steps do not help, as a pole
of the torque is. A step that is given by ``first_step`` stays as it is, and the
largest local error is reported where it exceeds the tolerance. Absolute tolerances are not used.

The torque-free turn of a body with two equal moments is elementary; else it is a Taylor series in parts
of at most half a radian, of so many terms that the rest is lost in rounding (`free_turn.c`). Constants of
the elliptic functions (van Zon and Schofield, J. Comput. Phys. 225 (2007) 145; Celledoni, Fasso,
Saefstroem and Zanna, SIAM J. Sci. Comput. 30 (2008) 2084) change with every kick, and in double precision
they lose digits next to the separatrix and to symmetry, where the series knows no difference. Momentum
is kept twice: as body rates, which are right about axes of small moments too, and with components in the
reference frame, which without torque do not change at all; the first follow the second as far as
rounding goes. A state between two steps is a step of a part of the length.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any

from codegen.frontend.layout import Layout
from codegen.integrate import group
from codegen.integrate.group import CONSTANTS, KICK, START, Variables, kicks, start
from codegen.ir.names import identifier
from codegen.ir.program import SINGULARITIES, Program
from codegen.loops import lookout, runge_kutta, samples
from codegen.loops.running import NativeMethod
from codegen.native import native
from codegen.native.trajectory import Problem
from codegen.passes.pipeline import by_parameters
from codegen.watch.narrow import narrow
from eom.errors import InputError

NAME = "splitting"
ROW = 28
"""Numbers of a row of dense output: see `keep` in splitting.c."""

ORDER = 6
"""Of Blanes and Moan's composition, symmetric: kick, drift, kick, ..., kick."""
_KICKS = (
    0.0414649985182624,
    0.198128671918067,
    -0.0400061921041533,
    0.0752539843015807,
    -0.0115113874206879,
)
_DRIFTS = (
    0.123229775946271,
    0.290553797799558,
    -0.127049212625417,
    -0.246331761062075,
    0.357208872795928,
)
_HALF = (*_KICKS, 0.5 - sum(_KICKS))
KICKS = (*_HALF, *_HALF[::-1])
DRIFTS = (*_DRIFTS, 1 - 2 * sum(_DRIFTS), *_DRIFTS[::-1])
FURTHER_STATUS = "    {name}_COARSE = 6,   /* the chosen step is too long: begin again */\n"


def files(program: Program, layout: Layout) -> Mapping[str, str]:
    """Return header and source of the integrator by file name.

    Raises `InputError` for what is not one rigid body with a quaternion, and for a torque that depends
    on the body rates.
    """
    filled, _, _ = _filled(program, layout)
    return filled


def build(
    program: Program, layout: Layout, sampled: bool = False
) -> tuple[NativeMethod, group.Between]:
    """Compile the integrator of a system for this machine; `group.integrate` runs it.

    Raises `CompilerError` if that fails, and `InputError` as `files`.
    """
    filled, constants, watch = _filled(program, layout)
    if sampled:
        variables = _body(layout)
        rows = ((kicks(program, variables), CONSTANTS), (start(program, variables), START))
        group.check_sampled(NAME, layout, rows)
    text = group.single_text(program, layout, NAME, filled, sampled)
    prefix = f"{identifier(layout.name)}_{NAME}"
    room = max(1, len(layout.results[SINGULARITIES]))
    of_rates = max(1, len(by_parameters(program, layout.sizes).values))
    sizes = (of_rates, constants["kick"])
    state, output = _structures(prefix, len(layout.states), room, sizes, watch.fields)
    flags = native.flags_for(0, len(program.instructions))
    begin, run, library = runge_kutta.loaded(text, flags, prefix, state)
    terms = _terms(len(layout.states))
    made = NativeMethod(
        terms, group.unbound, begin, run, state, output, library, notice=_notice,
        sampled=samples.functions(library, prefix) if sampled else None,
    )  # fmt: skip
    return made, group.between(library, prefix)


def _notice(state: Any, problem: Problem) -> str:
    """Return the notice of a run with a given step: its error, and what it passes over."""
    if problem.first_step is None or not state.error > problem.rtol:
        return ""
    if math.isinf(state.error):
        return (
            f"steps of {abs(state.h):.3g} s, as given, pass over something narrow in the torque; leave "
            "first_step out, or give a shorter one"
        )
    return (
        f"steps of {abs(state.h):.3g} s, as given, have local errors of up to {state.error:.1e}, "
        f"more than rtol = {problem.rtol:.1e}; leave first_step out, or give a shorter one"
    )


def _terms(states: int) -> int:
    return -(-ROW // states)


def _body(layout: Layout) -> Variables:
    variables = group.variables_of(NAME, layout)
    body, others = variables.attitude.body, variables.attitude.others
    hint = "choose method rkmk, which also keeps the quaternion of unit length"
    if body is None:
        raise InputError(
            f"method {NAME} finds no rigid body that turns with the quaternion",
            where=layout.name,
            expected="rates J d omega/dt = -omega x J omega + torque, J of parameters alone",
            hint=f"give moments of inertia as parameters or exact numbers, or {hint}",
        )
    if any(body.of_rates):
        axes = ", ".join(f"b{k}" for k, mixed in enumerate(body.of_rates, 1) if mixed)
        raise InputError(
            f"method {NAME} needs a torque that does not depend on the body rates",
            where=layout.name,
            got=f"the torque about {axes} does",
            hint=hint,
        )
    if others:
        names = ", ".join(layout.states[k].name for k in others)
        raise InputError(
            f"method {NAME} moves one rigid body alone", where=layout.name, got=names, hint=hint
        )
    return variables


def _filled(
    program: Program, layout: Layout
) -> tuple[Mapping[str, str], dict[str, int], lookout.Lookout]:
    variables = _body(layout)
    _check_sight(program, layout)
    rates = variables.attitude.body.rates if variables.attitude.body else ()
    values = group.values(layout, NAME)
    watch = lookout.of_time(program, values["PREFIX"], 1)
    kicked, begin = kicks(program, variables), start(program, variables)
    parts = [(kicked, KICK, "kick"), (kicked, CONSTANTS, "known")]
    made = group.functions(values["PREFIX"], [*parts, (begin, START, "begin")])
    text = resources.files("codegen.loops").joinpath("free_turn.c").read_text("ascii")
    values |= {
        "METHOD": f"splitting into torque and exact free turns, order {ORDER},",
        "ORDER": str(ORDER),
        "STAGES": str(len(DRIFTS)),
        "KICKS": ", ".join(map(repr, KICKS)),
        "DRIFTS": ", ".join(map(repr, DRIFTS)),
        "FREE_TURN": text,
        "KERNELS": made.text,
        "QUATERNION": ", ".join(map(str, variables.attitude.quaternion)),
        "RATES": ", ".join(map(str, rates)),
        "DENSE_SHAPE": "[@ROW@]",
        "ROW": str(_terms(variables.count) * variables.count),
        "OF_KICK": str(made.constants["kick"]),
        "OF_CONSTANTS": str(made.constants["known"]),
        "OF_BEGIN": str(made.constants["begin"]),
        "STACK": "about 3000",
        **_of_watch(watch, values["PREFIX"]),
        "FURTHER_STATUS": FURTHER_STATUS.format(name=values["UPPER"]),
    }
    filled = {
        f"{values['PREFIX']}.{kind}": runge_kutta.fill(f"splitting.{kind}", values)
        for kind in ("h", "c")
    }
    return filled, made.constants, watch


def _check_sight(program: Program, layout: Layout) -> None:
    """Raise `InputError` for torques that equal steps could pass over something of, unseen."""
    found = narrow(program)
    if found.watched is not None:
        raise InputError(
            f"method {NAME} makes equal steps, which may pass over what is narrow in the torque",
            where=layout.name,
            got="operations on the attitude that have pieces or a scale of their own",
            hint="choose method rkmk, which looks between its stages and ends steps where pieces change",
        )


_PASSED_OVER = """\
        ahead = look_ahead(s, u, direction);
        if (ahead == 1) {
            const double part = s->h / equal;
            s->h = equal;
            if (s->chosen) return coarse(s, part);
            s->error = HUGE_VAL;
        }
"""


_FUNCTIONS = """\
/* A step over a jump of the torque: by the torque before it and that behind. */
static void pass_over(const {prefix} *s, double h, const double *u, Point *at) {{
    const double part = part_before(s, h);
    kick(s, part * h, at);
    drift(s, h, at);
    torque_at(s, s->t + h, u, at);
    kick(s, (1.0 - part) * h, at);
}}

/* What a jump of the torque may have changed the momentum by, which is known to rtol of its length. */
static void keep_kick({prefix} *s, int over, const Point *at) {{
    double square = 0.0;
    for (int i = 3; over && i < 6; ++i) {{
        const double jump = at->torque[i] - s->torque[i];
        square += jump * jump;
    }}
    keep_jump(s, 0, s->t, s->edge_off * sqrt(square), s->rtol * length_of_momentum(at));
}}

"""


_OVER = """\
const int over = ahead == 2 && is_shortest(s, h);
        if (over) pass_over(s, h, u, &at);
        else """


def _of_watch(watch: lookout.Lookout, prefix: str) -> dict[str, str]:
    """Return texts for the template: what is narrow in time asks for shorter steps all the way."""
    own = {
        "PASS_OVER": _FUNCTIONS.format(prefix=prefix),
        "LOOK_AHEAD": _PASSED_OVER,
        "OVER": _OVER,
        "KEEP_JUMP": "        keep_kick(s, over, &at);\n",
    }
    return {**watch.texts, **(own if watch.fields else dict.fromkeys(own, ""))}


@cache
def _structures(
    prefix: str,
    states: int,
    room: int,
    constants: tuple[int, int],
    watched: tuple[tuple[str, Any], ...],
) -> tuple[type[ctypes.Structure], type[ctypes.Structure]]:
    """Mirror the two structures of splitting.h."""
    double: Any = ctypes.c_double
    names = (
        "t", "t_end", "h", "h_max", "rtol", "margin", "t_low", "t_old", "h_old", "error", "size",
        "excess", "h_tried", "t_tried",
    )  # fmt: skip
    lengths = (
        ("atol", states), ("x", states), ("y", 10), ("y_low", 10), ("torque", 6), ("moments", 3),
        ("ratios", 3), ("axes", 9), ("frame", 3), ("constant", 3), ("row", _terms(states) * states),
        ("pair", _terms(states) * states),
        ("singular", room), ("closest", room),
    )  # fmt: skip
    state: list[tuple[str, Any]] = [(f, double) for f in names]
    state += [(f, double * length) for f, length in lengths]
    state += [(f, ctypes.c_longlong) for f in ("steps", "rejected", "evaluations")]
    state += [(f, ctypes.c_int) for f in ("status", "which", "chosen", "vain", "second")]
    kept = zip(("constants", "of_kick"), constants, strict=True)
    state += [(f, double * length) for f, length in kept]
    state += watched
    return runge_kutta.structures(prefix, state)
