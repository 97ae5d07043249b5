"""Branches in method taylor: steps end where a branch changes.

The series of a step are those of one choice of every branch. The coefficients of the switching functions,
by whose signs branches choose, are computed with them (`codegen.derivatives.taylor.Prepared.switches`), and
the first change of sign in a step is isolated (`roots.c`, `switches.c`), so that a branch that changes and
changes back within a step is seen. The step ends just beyond it. What stands in the templates of one
trajectory and of lanes is a table; it is empty where there are no branches.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping
from importlib import resources
from typing import Any

from codegen.derivatives.taylor import Prepared
from codegen.frontend.layout import Layout
from codegen.ir.names import identifier
from codegen.loops import jumps

MOST_CROWDED = 16
"""So many steps from switch to switch, each no longer than rounding: rates on both sides of it lead back
to it, as with dry friction at rest. For each further switching function as many are allowed again."""
PARTS = 17
"""Parts of a step, each 16 times as long as the one before, in which changes of sign are looked for."""

_ONE = {
    "SWITCH_FIELDS": """\
    double switch_jet[@ORDER@][@SWITCH_COUNT@]; /* Taylor coefficients of the switching functions */
    int crowded;                 /* steps from switch to switch that are no longer than rounding */
""",
    "SWITCH_START": "    s->crowded = 0;\n",
    "SWITCH_JET": ", &s->switch_jet[0][0]",
    "STUCK": f"s->crowded > {MOST_CROWDED} * SWITCHES || (",
    "STUCK_END": ")",
    "SWITCH_AHEAD": """\
        const base here = {s, u, s->t, direction};
        h_abs = smaller(h_abs, fabs(rest));
        double longest = h_abs;
        const double landing = length_to_switch(&here, &longest, smallest);
        h_abs = smaller(longest, landing);
""",
    "FITS": "(h_abs < landing ? fits(s, h, t_new, x_new, u) : fits_before(s, h, longest, u))",
    "SWITCH_PASSED": """\
        s->crowded = h_abs >= landing && h_abs <= larger(64.0 * smallest, 1e-15 * longest)
            ? s->crowded + 1 : 0;
        keep_jumps(s, h_abs >= landing, h, t_new, x_new, u);
""",
}
"""What stands in the templates of one trajectory that has branches."""
_LANES = {
    "SWITCH_FIELDS": "    lane_ crowded;\n",
    "SWITCH_STEP": "    mask_ crowded;\n",
    "SWITCH_ENTER": "        r->crowded[lane] = 0.0;\n",
    "SWITCH_STUCK": f"((mask_)(r->crowded > {MOST_CROWDED}.0 * SWITCHES) | (",
    "SWITCH_STUCK_END": "))",
    "SWITCH_AHEAD": """\
    lane_ longest = smaller_(h_abs, far);
    const lane_ landing = to_switch_(r, &longest, smallest);
    h_abs = smaller_(longest, landing);
""",
    "FITS": "fits_before_(r, o, s, (mask_)(h_abs >= landing), longest)",
    "SWITCH_TRIED": """\
        s->crowded = (mask_)(h_abs >= landing)
            & (mask_)(h_abs <= larger_(64.0 * smallest, 1e-15 * longest));
""",
    "SWITCH_PASSED": """\
        run.crowded = lanes_choose_(step.crowded, run.crowded + 1.0, lanes_all_(0.0));
""",
}
"""The same of lanes."""


def of_one(prepared: Prepared, layout: Layout, order: int, has_roots: bool) -> dict[str, str]:
    """Return what the template of one trajectory needs; ``has_roots``: it isolates roots anyway."""
    if not prepared.switches:
        fits = "fits(s, h, t_new, x_new, u)"
        return dict.fromkeys(_ONE, "") | {"SWITCHING": "", "FITS": fits}
    roots = "" if has_roots else f"#define D {order}\n\n{_template('roots.c')}"
    name, n = identifier(layout.name), len(layout.states)
    prefix = f"{name}_taylor"
    head = f"#define SWITCHES {len(prepared.switches)}\n{roots}{jumps.functions(prefix)}"
    own = _template("switches_one.c").replace("@NAME@", name)
    found = _filled(_ONE, f"{head}{own}", prepared, prefix, order)
    found["SWITCH_FIELDS"] += jumps.held(n)
    found["SWITCH_START"] += jumps.begin(n)
    return found


def of_lanes(prepared: Prepared, prefix: str, order: int) -> dict[str, str]:
    """Return what the template of lanes needs."""
    if not prepared.switches:
        fits = "fits_(r, o, s->h, s->t, s->x, s->size)"
        return dict.fromkeys(_LANES, "") | {"SWITCHING": "", "SWITCH_COUNT": "", "FITS": fits}
    head = f"#define D P\n\n{_template('roots.c')}"
    texts = _filled(_LANES, f"{head}{_template('switches_lanes.c')}", prepared, prefix, order)
    return texts | {"SWITCH_COUNT": f"#define SWITCHES {len(prepared.switches)}\n"}


def _filled(
    texts: Mapping[str, str], functions: str, prepared: Prepared, prefix: str, order: int
) -> dict[str, str]:
    values = {
        "SWITCHES": _template("switches.c"),
        "SWITCH_BINOMIALS": ", ".join(f"{math.comb(order - 1, k)}.0" for k in range(order)),
        "SWITCH_PARTS": str(PARTS),
        "SWITCH_COUNT": str(len(prepared.switches)),
        "ORDER": str(order),
        "PREFIX": prefix,
    }
    found = {**texts, "SWITCHING": functions}
    for key, value in values.items():
        found = {k: text.replace(f"@{key}@", value) for k, text in found.items()}
    return found


def _template(name: str) -> str:
    return resources.files("codegen.loops").joinpath(name).read_text("ascii")


def fields(count: int, order: int, states: int) -> list[tuple[str, Any]]:
    """Mirror the fields of the structure of one trajectory."""
    if not count:
        return []
    double: Any = ctypes.c_double
    own = [("switch_jet", double * count * order), ("crowded", ctypes.c_int)]
    return [*own, *jumps.fields(states)]
