"""Explicit Runge-Kutta methods with their whole loop in generated C."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from codegen.frontend.layout import Layout
from codegen.ir.names import comment, identifier
from codegen.ir.program import RATES, SINGULARITIES, Program, SameObject
from codegen.loops import crossings, lookout, projection, samples
from codegen.loops.running import NativeMethod
from codegen.loops.tableaux import Row, Tableau
from codegen.native import native
from codegen.native.trajectory import Array, Stepwise
from codegen.passes.pipeline import by_parameters
from codegen.targets import c


def files(
    tableau: Tableau, program: Program, layout: Layout, sampled: bool = False
) -> Mapping[str, str]:
    """Return header and source of the integrator by file name.

    ``sampled``: whether inputs change at its end, so that the rates there may be left out.
    """
    values = _values(tableau, program, layout)
    values |= _end_rates(tableau, values, sampled and not crossings.count_of(layout))
    return {
        f"{values['PREFIX']}.{kind}": fill(f"runge_kutta.{kind}", values) for kind in ("h", "c")
    }


def single_text(
    tableau: Tableau, program: Program, layout: Layout, sampled: bool = False, whole: bool = True
) -> str:
    """Return functions and integrator as one text that compiles by itself.

    ``sampled``: with what stands round the loop where laws are sampled. ``whole``: with functions that
    the integrator does not call.
    """
    name = identifier(layout.name)
    header, source = files(tableau, program, layout, sampled).values()
    rest = (header + source).replace(f'#include "{name}.h"\n', "")
    rest = rest.replace(f'#include "{name}_{tableau.name}.h"\n', "")
    if sampled:
        prefix = f"{name}_{tableau.name}"
        rates = _rates(name, prefix, _watch(tableau, program, prefix))
        rest = samples.around(rest, tableau.name, layout, rates)
    return c.single_text(program, layout, "" if whole else rest) + rest


SHARED = {"NUMBERS": "numbers.c", "START": "start.c", "EVENTS": "events.c", "STEPS": "steps.c",
          "INTERFACE": "interface.h", "OUTPUT": "output.h"}  # fmt: skip
"""What the texts of several methods have in common, by file."""


def fill(template: str, values: Mapping[str, str]) -> str:
    """Return a template of this folder with its keys replaced, those of the shared parts first."""
    text = _template(template)
    shared = {key: _template(file) for key, file in SHARED.items()}
    for key, value in {**shared, **_without_events(values), **values}.items():
        text = text.replace(f"@{key}@", value)
    return text


def _without_events(values: Mapping[str, str]) -> dict[str, str]:
    return {
        **crossings.NONE,
        "FURTHER_STATUS": "",
        "STOPPED": f"{values.get('UPPER', '')}_SINGULAR",
    }


def _template(name: str) -> str:
    return resources.files("codegen.loops").joinpath(name).read_text(encoding="ascii")


_KEEP = """\
        for (int i = 0; i < N; ++i)
            keep_jump(s, i, s->t, fabs(off[i]), s->atol[i] + s->rtol * fmax(fabs(s->x[i]), fabs(x_new[i])));
"""


def _watch(tableau: Tableau, program: Program, prefix: str) -> lookout.Lookout:
    n = len(program.results[RATES])
    return lookout.of(program, prefix, lookout.Steps(tableau, n, n, _KEEP))


def _values(tableau: Tableau, program: Program, layout: Layout) -> dict[str, str]:
    name, last = identifier(layout.name), tableau.main_stages
    singular, n = len(layout.results[SINGULARITIES]), len(layout.states)
    prefix = f"{name}_{tableau.name}"
    watch = _watch(tableau, program, prefix)
    rates = _rates(name, prefix, watch)
    main = [_stage(tableau, rates, s) for s in range(1, last)]
    dense = [
        f"        s->dense[{3 + d}][i] = h * ({_sum(row)});" for d, row in enumerate(tableau.dense)
    ]
    return {
        "TITLE": comment(layout.title),
        "METHOD": f"{tableau.name.upper()}, an explicit Runge-Kutta method of order {tableau.order},",
        "NAME": name,
        "PREFIX": prefix,
        "UPPER": prefix.upper(),
        "HEADER": f"{prefix}.h",
        "STATES": str(n),
        "SINGULARITIES": str(singular),
        "COORDINATES": ", ".join(map(str, layout.coordinates)),
        "SINGULAR_ROOM": str(max(1, singular)),
        "ORDER": str(tableau.order),
        "LAST": str(last),
        "ALL_STAGES": str(len(tableau.stages)),
        "DENSE_TERMS": str(tableau.dense_terms),
        "DENSE_SHAPE": f"[{tableau.dense_terms}][n]",
        "STACK": f"about {8 * n * (len(tableau.stages) + 8)}",
        "EVALUATIONS": str(last),
        "STAGES": "\n".join(main),
        "DENSE_COEFFICIENTS": "\n".join(dense),
        "DENSE_FACTOR": "theta" if tableau.dense_terms % 2 else "(1.0 - theta)",
        "UPDATE": _sum(tableau.stages[last]),
        "ROOT": _root(tableau.order),
        **_of_rates(rates, n, watch.width),
        **_further_stages(tableau, rates),
        **_error(tableau),
        **projection.texts(layout, prefix, projection.RUNGE_KUTTA.format(name=name, last=last)),
        **crossings.of_values(program, layout, prefix),
        **watch.texts,
    }


_AT_CHANGE = """\
        const int at_change = t_new == s->t_end; /* the rates there are those of other inputs */
        for (int i = 0; at_change && i < N; ++i) k[{last}][i] = 0.0;
        s->evaluations -= at_change;
        if (!at_change) {rates}
"""
_DENSE_AT_CHANGE = """\
        if (needs_dense || possible) {{
            if (at_change) {rates}
            s->evaluations += at_change;
            prepare_dense(s, k, h, x_new, u);
        }}
"""


def _end_rates(tableau: Tableau, values: Mapping[str, str], sampled: bool) -> dict[str, str]:
    """Return how the rates at the end of a step are found.

    Where inputs change there, it is for dense output alone; that needs a method whose estimate of the error
    does not read them, and nothing that is watched.
    """
    last = tableau.main_stages
    at, before, after = (values[k] for k in ("RATES_AT", "RATES_WITH", "RATES_END"))
    rates = f"{at}(t_new, x_new, {before}k[{last}]{after});"
    read = any(len(row) > last and row[last] for row in (tableau.error_high, tableau.error_low))
    if not sampled or read or values["WIDTH"] != "N":
        return {"END_RATES": f"        {rates}\n"}
    return {
        "END_RATES": _AT_CHANGE.format(last=last, rates=rates),
        "DENSE_LATER": _DENSE_AT_CHANGE.format(rates=rates),
    }


def _root(order: int) -> str:
    return "sqrt(sqrt(sqrt(error)))" if order == 8 else f"pow(error, 1.0 / {order}.0)"


class _Rates(NamedTuple):
    """How the rates are called: the function, its arguments before the array of results, and behind."""

    name: str
    before: str
    after: str


def _of_rates(rates: _Rates, n: int, width: int) -> dict[str, str]:
    return {
        "WIDTH": "W" if width else "N",
        "RATES_ROOM": str(n + width),
        "RATES_AT": rates.name,
        "RATES_WITH": rates.before,
        "RATES_END": rates.after,
    }


def _rates(name: str, prefix: str, watch: lookout.Lookout) -> _Rates:
    if not watch.width:
        return _Rates(f"{name}_rates", "&s->constants, u, ", "")
    return _Rates(f"{prefix}_watched", "1, s->of_watched, NULL, u, 1, ", ", 1")


_IN_WORDS = {
    0: "no further evaluation",
    1: "one more evaluation",
    2: "two more evaluations",
    3: "three more evaluations",
}


def _further_stages(tableau: Tableau, rates: _Rates) -> dict[str, str]:
    """Return how the stages that dense output alone needs are computed, and what they cost."""
    further = range(tableau.main_stages + 1, len(tableau.stages))
    lines = ["    double y[N];", *(_stage(tableau, rates, s) for s in further)]
    lines += [f"    s->evaluations += {len(further)};"]
    none = "    (void)u; /* the stages of the step are enough */"
    return {
        "DENSE_STAGES": "\n".join(lines) if further else none,
        "DENSE_COST": _IN_WORDS.get(len(further), f"{len(further)} more evaluations"),
    }


def _error(tableau: Tableau) -> dict[str, str]:
    """Return the sums of the error estimates, and the error: the norm of one, or of their mixture."""
    estimates = {"high": tableau.error_high, "low": tableau.error_low}
    used = {name: row for name, row in estimates.items() if row}
    indent = "            "
    terms = [f"{indent}const double e_{n} = scale * ({_sum(row)});" for n, row in used.items()]
    terms += [f"{indent}{n} += e_{n} * e_{n};" for n in used]
    mixed = "high > 0.0 ? fabs(h) * high / sqrt((high + 0.01 * low) * N) : high"
    return {
        "ERROR_SUMS": ", ".join(f"{n} = 0.0" for n in used),
        "ERROR_TERMS": "\n".join(terms),
        "ERROR": mixed if tableau.error_low else "fabs(h) * sqrt(high / N)",
    }


def _sum(row: Row) -> str:
    return " + ".join(f"{weight!r} * k[{j}][i]" for j, weight in enumerate(row) if weight).replace(
        "+ -", "- "
    )


def _stage(tableau: Tableau, rates: _Rates, s: int) -> str:
    indent = "        " if s < tableau.main_stages else "    "
    return (
        f"{indent}for (int i = 0; i < N; ++i) y[i] = s->x[i] + h * ({_sum(tableau.stages[s])});\n"
        f"{indent}{rates.name}(s->t + {tableau.nodes[s]!r} * h, y, {rates.before}k[{s}]{rates.after});"
    )


@cache
def _structures(
    prefix: str,
    n: int,
    room: int,
    terms: int,
    constants: int,
    events: tuple[int, int],
    watched: tuple[tuple[str, Any], ...],
    width: int,
) -> tuple[type[ctypes.Structure], type[ctypes.Structure]]:
    """Mirror the two structures of runge_kutta.h."""
    double: Any = ctypes.c_double
    vector: Any = double * n
    state: list[tuple[str, Any]] = [
        (f, double)
        for f in ("t", "t_end", "h", "h_max", "rtol", "margin", "t_low", "t_old", "h_old")
    ]
    state += [(f, vector) for f in ("atol", "x", "x_low")]
    state += [("f", double * (n + width)), ("x_old", vector)]
    state += [("dense", vector * terms), ("singular", double * room), ("closest", double * room)]
    state += [(f, ctypes.c_longlong) for f in ("steps", "rejected", "evaluations")]
    state += [(f, ctypes.c_int) for f in ("status", "which", "after_rejection")]
    state += [("constants", double * constants), *watched]
    state += crossings.fields(events, 0)
    return structures(prefix, state)


def structures(
    prefix: str, state: Sequence[tuple[str, Any]]
) -> tuple[type[ctypes.Structure], type[ctypes.Structure]]:
    """Return the structure of an integrator from its fields, and that of its output."""
    output: list[tuple[str, Any]] = [(f, ctypes.c_void_p) for f in ("t", "x", "dense", "grid")]
    output += [(f, ctypes.c_size_t) for f in ("capacity", "count", "grid_count", "next")]
    kinds = (
        type(f"{prefix}{suffix}", (ctypes.Structure,), {"_fields_": f})
        for suffix, f in (("", state), ("_output", output))
    )
    first, second = kinds
    return first, second


@lru_cache(maxsize=4)
def _text_once(
    tableau: Tableau, program: SameObject[Program], layout: SameObject[Layout], sampled: bool
) -> str:
    return single_text(tableau, program.value, layout.value, sampled, whole=False)


def begin(tableau: Tableau, program: Program, layout: Layout) -> None:
    """Begin to compile what `build` needs, see `codegen.native.native.ahead`."""
    text = _text_once(tableau, SameObject(program), SameObject(layout), False)
    native.ahead(text, native.flags_for_steps(len(program.instructions)))


def build(
    tableau: Tableau, program: Program, layout: Layout, sampled: bool = False
) -> NativeMethod:
    """Compile the integrator of a system for this machine. Raises `CompilerError` if that fails."""
    text = _text_once(tableau, SameObject(program), SameObject(layout), sampled)
    flags = native.flags_for_steps(len(program.instructions))
    prefix = f"{identifier(layout.name)}_{tableau.name}"
    n, singular = len(layout.states), len(layout.results[SINGULARITIES])
    constants = max(1, len(by_parameters(program, layout.sizes).values))
    events, room = crossings.sizes(program, layout), crossings.most(layout)
    terms = tableau.dense_terms
    watch = _watch(tableau, program, prefix)
    state, output = _structures(
        prefix, n, max(1, singular), terms, constants, events, watch.fields, watch.width
    )
    start, run, library = loaded(text, flags, prefix, state)
    return NativeMethod(
        terms, DenseSolution, start, run, state, output, library, room,
        crossings.notice(program, layout),
        samples.functions(library, prefix) if sampled else None,
    )  # fmt: skip


def loaded(
    text: str, flags: Sequence[str], prefix: str, state: type[ctypes.Structure]
) -> tuple[Any, Any, ctypes.CDLL]:
    """Compile and load an integrator; return its two functions and the library."""
    library = native.load(native.compile_library(text, flags), text, flags)
    size = getattr(library, f"{prefix}_size")
    size.restype = ctypes.c_size_t
    assert size() == ctypes.sizeof(state)
    start, run = getattr(library, f"{prefix}_start"), getattr(library, f"{prefix}_run")
    start.argtypes = [ctypes.c_void_p] * 3
    run.argtypes = [*[ctypes.c_void_p] * 3, ctypes.c_longlong]
    return start, run, library


class DenseSolution(Stepwise):
    """Polynomials of a tableau's interpolant."""

    def _within(self, k: NDArray[np.intp], since: Array) -> Array:
        theta = (since / self._h[k])[:, None]
        terms = self._rows[k]
        value = terms[:, -1] * (theta if terms.shape[1] % 2 else 1 - theta)
        for j in range(terms.shape[1] - 2, -1, -1):
            value = (value + terms[:, j]) * (1 - theta if j % 2 else theta)
        return np.asarray(value + self._x[k])
