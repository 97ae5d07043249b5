"""Steps of method taylor that end where the series of an argument may no longer be trusted.

An operation that is no polynomial is seen by its series near one point alone. How far its argument may
move from there is a row of `codegen.watch.trust`; the argument's own coefficients say how far it moves.
Where that is more, the step is cut; smooth motions pass the test as they are. A step that is cut down to
rounding, as a value comes to a singularity that the rates do not have, is made all the same, so that kinks
are passed; many of these in a row end the run. What stands in the templates of one trajectory and of
lanes is a table; it is empty for polynomials.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from importlib import resources
from typing import Any

from codegen.derivatives.taylor import Prepared
from codegen.loops.jets import limited
from codegen.watch.trust import is_checked

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
