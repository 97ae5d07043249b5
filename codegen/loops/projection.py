"""Projection: after each step the state is brought back onto invariants by the least change.

Hairer, Lubich and Wanner, Geometric Numerical Integration, 2nd ed. (2006), sect. IV.4, algorithm 4.2:
the error of a step moves the state off the invariants by no more than itself, so that the order of
the method stays. The change is found by Gauss and Newton's method with the generated derivatives of
the invariants, at most four turns, one as a rule. It is the least in the states over their scales:
states of one unit are measured together, by the largest of them (or atol / rtol where that is
larger), so that |q| = 1 is restored without a turn of the body.

Gradients may be parallel or zero, as those of T and H are in a spin about a principal axis. They are
made orthogonal one by one, that with most left of it first; one counts only while the rounding of its
invariant moves the state along what is left of it by less than 1/16 of the tolerance (of 1024 units
in the last place if that is more), and moves the state only where its invariant is off by more than
rounding. What does not count drifts as it would without projection.

The program of the system gets one more group of results, `GROUP`: the chosen invariants, their values
at the start, which are further parameters, and the derivatives by the states. So generated code needs
nothing else, and its users can project by giving these parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from importlib import resources

import sympy as sp

from codegen.derivatives.derivative import JACOBIAN, derive, identity, slots
from codegen.frontend.layout import Layout
from codegen.ir.names import identifier
from codegen.ir.ops import Instruction
from codegen.ir.passes import prune
from codegen.ir.program import INVARIANTS, Program
from codegen.passes.pipeline import formed, join, optimise
from eom.errors import InputError, unknown_name
from eom.quantities import Quantity

GROUP = "projection"
NONE = dict.fromkeys(("PROJECTION", "PROJECT", "PROJECT_POINT", "PROJECT_STOP"), "")
"""What stands in the templates of a method that does not project."""


def chosen(layout: Layout, project: bool | str | Sequence[str]) -> tuple[str, ...]:
    """Return the names of the invariants that ``project`` asks for: True for all, or names.

    Raises `InputError` for unknown names, and where the system has no invariants.
    """
    known = layout.results[INVARIANTS]
    if isinstance(project, bool):
        if project and not known:
            raise InputError("there is nothing to project onto", got="a system without invariants")
        return known if project else ()
    names = (project,) if isinstance(project, str) else tuple(dict.fromkeys(project))
    for name in names:
        if name not in known:
            raise unknown_name("invariant", name, known)
    return names


def extended(
    program: Program, layout: Layout, names: Sequence[str], stable: bool = False
) -> tuple[Program, Layout]:
    """Return program and layout with the group `GROUP` and one more parameter an invariant.

    The further parameters are the values that the invariants ``names`` are to keep, in this order.
    """
    places = [layout.results[INVARIANTS].index(name) for name in names]
    values = prune(
        replace(program, results={GROUP: tuple(program.results[INVARIANTS][k] for k in places)})
    )
    derived = derive(values, GROUP, identity(values, GROUP), slots(values, "state"))
    found = formed(derived.program, stable)
    both = (*found.results[GROUP], *found.results[JACOBIAN])
    whole = optimise(replace(found, results={GROUP: both}))
    first = len(layout.parameters)
    kept = [Instruction("parameter", (), first + k) for k in range(len(names))]
    count, results = len(whole.instructions), whole.results[GROUP]
    numbers = (*results[: len(names)], *range(count, count + len(names)), *results[len(names) :])
    whole = replace(whole, instructions=(*whole.instructions, *kept), results={GROUP: numbers})
    programs = {group: prune(program, [group]) for group in program.results}
    return join({**programs, GROUP: whole}), _layout(layout, names, derived.pattern)


def _layout(layout: Layout, names: Sequence[str], pattern: tuple[tuple[int, int], ...]) -> Layout:
    taken = {q.name for q in (*layout.states, *layout.parameters, *layout.inputs)}
    kept = []
    for name in names:
        word = f"{name}_kept"
        while word in taken:
            word += "_"
        taken.add(word)
        kept.append(Quantity(sp.Symbol(word, real=True), "", f"value that {name} is to keep"))
    entries = tuple(f"d{r}_{c}" for r, c in pattern)
    results = {**layout.results, GROUP: (*names, *(q.name for q in kept), *entries)}
    return replace(
        layout,
        parameters=(*layout.parameters, *kept),
        results=results,
        patterns={**layout.patterns, GROUP: pattern},
    )


# --- in generated C ------------------------------------------------------------------------------

RUNGE_KUTTA = """\
        if (project(s, t_new, x_new, x_low, u)) {{
            {name}_rates(t_new, x_new, &s->constants, u, k[{last}]);
            s->evaluations += 1;
        }}"""
"""The interpolant takes both ends and their slopes, so that it goes through what was projected."""
TAYLOR = """\
        if (project(s, t_new, x_new, x_low, u)) { /* a cubic takes the polynomial to the new end */
            for (int i = 0; i < N; ++i) {
                const double change = (x_new[i] - s->x[i]) - increment(s, i, h);
                s->jet[1][i] += 3.0 * change / (h * h);
                s->jet[2][i] -= 2.0 * change / (h * h * h);
            }
        }"""


def texts(layout: Layout, prefix: str, after_step: str) -> dict[str, str]:
    """Return what the templates of the loops need: functions, and calls of them, or nothing.

    ``after_step``: `RUNGE_KUTTA` with its names filled in, or `TAYLOR`.
    """
    if GROUP not in layout.results:
        return dict(NONE)
    return {
        "PROJECTION": _functions(layout, prefix),
        "PROJECT": f"{after_step}\n",
        "PROJECT_POINT": "        project_point(s, o->grid[o->next], y, u);\n",
        "PROJECT_STOP": "        project_point(s, t_stop, x_new, u);\n",
    }


def _functions(layout: Layout, prefix: str) -> str:
    pattern = layout.patterns[GROUP]
    unit = units(layout)
    values = {
        "NAME": identifier(layout.name),
        "PREFIX": prefix,
        "COUNT": (len(layout.results[GROUP]) - len(pattern)) // 2,
        "ENTRIES": len(pattern),
        "ROOM": max(1, len(pattern)),
        "ROWS": ", ".join(str(r) for r, _ in pattern) or "0",
        "COLUMNS": ", ".join(str(c) for _, c in pattern) or "0",
        "UNITS": ", ".join(map(str, unit)),
        "UNIT_COUNT": max(unit) + 1,
    }
    text = resources.files("codegen.loops").joinpath("projection.c").read_text("ascii")
    for key, value in values.items():
        text = text.replace(f"@{key}@", str(value))
    return text


def units(layout: Layout) -> list[int]:
    """Return for each state the number of its unit."""
    known = list(dict.fromkeys(q.unit for q in layout.states))
    return [known.index(q.unit) for q in layout.states]
