"""Explicit Runge-Kutta methods in JavaScript: the tableaux and the step control of `runge_kutta`.

The text depends on the tableau alone; it integrates any module that `codegen.targets.javascript`
writes, so that pages with several systems hold it once. It stands beside generated JavaScript as
``runge_kutta.c`` stands beside generated C, and takes the same steps up to rounding; instead of ending a
step at each time that is asked for, it interpolates, so that frames of a page do not change the motion;
at samples of a law, where inputs change, steps end.
``lookout.mjs`` is ``ahead.c`` and ``narrow.c`` in JavaScript, ``projection.mjs`` is ``projection.c``; what
is watched, and what is kept (`codegen.loops.projection.extended`), they know from the module.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import resources

from codegen.loops import lookout
from codegen.loops.tableaux import DOP853, DP5, TSIT5, Row, Tableau
from eom.errors import InputError

TABLEAUX: Mapping[str, Tableau] = {t.name: t for t in (DOP853, DP5, TSIT5)}


def files(name: str) -> Mapping[str, str]:
    """Return the module of a method by file name. Raises `InputError` for others than `TABLEAUX`."""
    if name not in TABLEAUX:
        raise InputError(
            "no such integrator in JavaScript", got=name, expected=f"one of {', '.join(TABLEAUX)}"
        )
    return {f"{name}.mjs": text(TABLEAUX[name])}


def text(tableau: Tableau) -> str:
    """Return the module of a method: one function, named as the method; see its first lines."""
    written = _template("runge_kutta.mjs")
    further = {
        "LOOKOUT": _template("lookout.mjs"),
        "PROJECTION": _template("projection.mjs") + "\n",
    }
    for key, value in {**further, **_values(tableau)}.items():
        written = written.replace(f"@{key}@", value)
    return written


def _template(name: str) -> str:
    return resources.files("codegen.loops").joinpath(name).read_text(encoding="ascii")


def _values(tableau: Tableau) -> dict[str, str]:
    last, terms = tableau.main_stages, tableau.dense_terms
    stages, dense = len(tableau.stages), range(len(tableau.dense))
    arrays = [(f"k{s}", "W") for s in range(stages)] + [(f"d{d}", "n") for d in range(terms)]
    root = f"Math.pow(error, 1 / {tableau.order})"
    return {
        "METHOD": f"{tableau.name.upper()}, an explicit Runge-Kutta method of order {tableau.order},",
        "NAME": tableau.name,
        "ORDER": str(tableau.order),
        "LAST": str(last),
        "ARRAYS": "\n".join(f"  const {a} = new Float64Array({size});" for a, size in arrays),
        "STAGES": "\n".join(_stage(tableau, s, "      x", "s.t") for s in range(1, last)),
        "DENSE_STAGES": _further_stages(tableau),
        "DENSE_COEFFICIENTS": "\n".join(
            f"      d{3 + d}[i] = h * ({_sum(tableau.dense[d])});" for d in dense
        ),
        "INTERPOLANT": _nested(terms),
        "UPDATE": _sum(tableau.stages[last]),
        "ROOT": "Math.sqrt(Math.sqrt(Math.sqrt(error)))" if tableau.order == 8 else root,
        **_error(tableau),
        **lookout.numbers(tableau),
        "SEEN": ", ".join(f"k{s}" for s in lookout.apart(tableau)),
    }


def _stage(tableau: Tableau, s: int, start: str, time: str) -> str:
    """Return the lines of a stage; ``start``: indent and the state at the start of the step."""
    indent = start[: len(start) - len(start.lstrip())]
    state = start.strip()
    return (
        f"{indent}for (let i = 0; i < n; ++i) y[i] = {state}[i] + h * ({_sum(tableau.stages[s])});\n"
        f"{indent}values({time} + {tableau.nodes[s]!r} * h, y, p, u, k{s});"
    )


def _further_stages(tableau: Tableau) -> str:
    """Return the stages that dense output alone needs."""
    further = range(tableau.main_stages + 1, len(tableau.stages))
    lines = [_stage(tableau, s, "    xOld", "s.tOld") for s in further]
    lines += [f"    s.evaluations += {len(further)};"] if further else []
    return "\n".join(lines)


def _error(tableau: Tableau) -> dict[str, str]:
    """Return the sums of the error estimates, and the error: the norm of one, or of their mixture."""
    estimates = {"high": tableau.error_high, "low": tableau.error_low}
    used = {name: row for name, row in estimates.items() if row}
    terms = [f"        const e_{n} = scale * ({_sum(row)});" for n, row in used.items()]
    terms += [f"        {n} += e_{n} * e_{n};" for n in used]
    mixed = "high > 0 ? h * high / Math.sqrt((high + 0.01 * low) * n) : high"
    return {
        "ERROR_SUMS": ", ".join(f"{n} = 0" for n in used),
        "ERROR_TERMS": "\n".join(terms),
        "ERROR": mixed if tableau.error_low else "h * Math.sqrt(high / n)",
    }


def _sum(row: Row) -> str:
    terms = (f"{weight!r} * k{j}[i]" for j, weight in enumerate(row) if weight)
    return " + ".join(terms).replace("+ -", "- ")


def _nested(terms: int) -> str:
    """Return the interpolant less its first value: theta and 1 - theta by turns."""
    written = f"d{terms - 1}[i] * {'theta' if terms % 2 else 'rest'}"
    for d in range(terms - 2, -1, -1):
        written = f"({written} + d{d}[i]) * {'rest' if d % 2 else 'theta'}"
    return written
