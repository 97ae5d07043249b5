"""Narrow features in the generated loops of Runge-Kutta methods: what their templates need.

`codegen.watch.narrow` says what is watched; ``ahead.c`` looks ahead in time, ``narrow.c`` at the stages. A
program of which nothing is watched leaves the templates as they are.
"""

from __future__ import annotations

import ctypes
import math
import re
from dataclasses import dataclass, replace
from importlib import resources
from itertools import pairwise
from typing import Any

from codegen.ir.program import RATES, Program
from codegen.loops import jumps
from codegen.loops.tableaux import Tableau
from codegen.targets import c
from codegen.targets.c_helpers import table_function
from codegen.targets.render import table_names
from codegen.watch.narrow import AHEAD, MARGIN, VERDICT, WATCHED, Narrow, narrow

APART = 0.08
"""Stages are looked at that are so far apart at least, in steps: low-order values of others would show
as movement."""
CROWDED = 16
"""So many passages of a change of piece at one place, one after the other: rates on both sides lead back
to it. The estimate of the error alone then chooses the steps, until one leaves the place."""

NONE = dict.fromkeys(
    ("LOOKOUT", "LOOKOUT_FIELDS", "LOOKOUT_START", "LOOK_AHEAD", "AFTER_LOOK", "OVER", "MEAN", "PASSES",
     "KEEP_JUMP", "CUT", "FORESEE", "KEEP_WATCHED"),
    "",
)  # fmt: skip
"""What stands in the templates where nothing is watched."""

_LOOK_AHEAD = """\
        const double proposed = s->h;
        const int ahead = look_ahead(s, u, direction);
"""
_OVER = """\
        const int over = ahead == 2 && is_shortest(s, h);
        const double early = over ? part_before(s, h) : 0.0;
"""
_MEAN = "over ? early * k[0][i] + (1.0 - early) * k[{end}][i] : "
_PASSES = """\
        if (over && isfinite(error)) error = fmin(error, 0.5);
"""
_KEEP_JUMP = """\
        double off[{count}];
        for (int i = 0; i < {count}; ++i) {{
            static const double node[] = {{{nodes}}};
            double stray = 0.0; /* from the rates before and behind, where more than one piece changes */
            for (int j = 1; over && j < {end}; ++j) {{
                const double behind = node[j] * fabs(h) - s->edge;
                if (fabs(behind) > s->edge_off + spacing(s->t))
                    stray = fmax(stray, fabs(k[j][i] - k[behind < 0.0 ? 0 : {end}][i]));
            }}
            const double jump = k[{end}][i] - k[0][i];
            off[i] = over ? copysign(s->edge_off * fabs(jump) + fabs(h) * stray, jump) : 0.0;
        }}
{keep}"""
_AFTER_LOOK = """\
        if (ahead == 2) s->h = fmax(s->h, proposed);
"""


@dataclass(frozen=True)
class Steps:
    """What a method's steps are to a jump of the rates: of how many values, and states, it is given.

    ``keep``: as C, takes in that the values may be ``off`` so far (`codegen.loops.jumps`).
    """

    tableau: Tableau
    values: int
    states: int
    keep: str


@dataclass(frozen=True)
class Lookout:
    """Texts for the templates, and the fields of the structure that they add."""

    texts: dict[str, str]
    fields: tuple[tuple[str, Any], ...] = ()
    width: int = 0
    """Number of values at each stage that are watched beside the rates."""


def of_time(program: Program, prefix: str, count: int) -> Lookout:
    """Return what looks ahead in time alone, for any loop that proposes its steps so.

    ``count``: of the values that a jump of the rates is given.
    """
    found = narrow(program)
    if found.ahead is None:
        return Lookout(dict(NONE))
    lines, constants = kernel(found.ahead, AHEAD, f"{prefix}_ahead")
    room = max(1, constants)
    text = "\n".join([*lines, jumps.functions(prefix) + _filled("ahead.c", prefix)])
    texts = {
        "LOOKOUT": text,
        "LOOKOUT_FIELDS": f"    double of_ahead[{room}], edge, edge_off;\n{jumps.held(count)}",
        "LOOKOUT_START": f"    {prefix}_ahead_constants(p, 1, s->of_ahead);\n{jumps.begin(count)}",
        "LOOK_AHEAD": _LOOK_AHEAD,
        "AFTER_LOOK": _AFTER_LOOK,
    }
    double = ctypes.c_double
    own = (("of_ahead", double * room), ("edge", double), ("edge_off", double))
    return Lookout(NONE | texts, (*own, *jumps.fields(count)))


def of(program: Program, prefix: str, steps: Steps) -> Lookout:
    """Return what looks ahead, and watches the stages of a method, for the rates of a program."""
    found, tableau = narrow(program), steps.tableau
    ahead = _over_jumps(of_time(program, prefix, steps.states), steps)
    if found.watched is None or found.verdict is None:
        return ahead
    watched, constants = kernel(found.watched, WATCHED, f"{prefix}_watched")
    verdict, _ = kernel(found.verdict, VERDICT, f"{prefix}_verdict")
    room, texts = max(1, constants), ahead.texts
    further = _filled("narrow.c", prefix, **_numbers(found, len(program.results[RATES]), tableau))
    head = [*watched, *verdict, further]
    double, integer = ctypes.c_double, ctypes.c_int
    fields: tuple[tuple[str, Any], ...] = (
        ("of_watched", double * room), ("wanted", double), ("passed", double),
        ("passing", integer), ("crowded", integer), ("tries", integer),
    )  # fmt: skip
    own = {
        "LOOKOUT": texts["LOOKOUT"] + "\n".join(head),
        "LOOKOUT_FIELDS": texts["LOOKOUT_FIELDS"] + _FIELDS.format(room=room),
        "LOOKOUT_START": texts["LOOKOUT_START"] + _START.format(prefix=prefix),
        "CUT": "        if (is_cut(s, k, h)) continue;\n",
        "FORESEE": "        foresee(s, k, h);\n",
        "KEEP_WATCHED": _KEEP.format(last=tableau.main_stages),
    }
    return Lookout(texts | own, (*ahead.fields, *fields), found.columns)


def _over_jumps(ahead: Lookout, steps: Steps) -> Lookout:
    """Add how a shortest step passes over a jump: by the rates of its first stage and that at its end."""
    if not ahead.fields:
        return ahead
    nodes, last = steps.tableau.nodes, steps.tableau.main_stages
    assert nodes[last - 1] == 1
    own = {
        "OVER": _OVER,
        "MEAN": _MEAN.format(end=last - 1),
        "PASSES": _PASSES,
        "KEEP_JUMP": _KEEP_JUMP.format(
            count=steps.values,
            end=last - 1,
            keep=steps.keep,
            nodes=", ".join(map(repr, map(float, nodes[:last]))),
        ),
    }
    return replace(ahead, texts=ahead.texts | own)


_KEEP = """\
        for (int i = FIRST; i < W; ++i) s->f[i] = k[{last}][i];
"""
_FIELDS = """\
    double of_watched[{room}], wanted, passed; /* the step before a change of piece, and where that was */
    int passing, crowded, tries;
"""
_START = """\
    s->wanted = 0.0, s->passed = -HUGE_VAL;
    s->passing = s->crowded = s->tries = 0;
    {prefix}_watched_constants(p, 1, s->of_watched);
"""


def numbers(tableau: Tableau) -> dict[str, str]:
    """Return what any loop of a method is given of its stages and of the law, by key of the templates."""
    nodes = [*tableau.nodes[: tableau.main_stages], 1.0]
    places = [float(nodes[k]) for k in apart(tableau)]
    return {
        "PLACES": ", ".join(map(repr, places)),
        "NEARNESS": ", ".join(repr(1 / (b - a)) for a, b in pairwise(places)),
        "BEYOND": repr(_beyond(places)),
        "CROWDED": str(CROWDED),
        "DEPTH": f"{MARGIN}.0",
    }


def _numbers(found: Narrow, rates: int, tableau: Tableau) -> dict[str, str]:
    stages = apart(tableau)
    return {
        **numbers(tableau),
        "RATES": str(rates),
        "WATCHED": str(rates + found.columns),
        "COLUMNS": str(found.columns),
        "GUARDED": str(found.guarded),
        "GUARDS": str(found.guards),
        "PIECES": str(found.pieces),
        "SEEN_COUNT": str(len(stages)),
        "SEEN": ", ".join(map(str, stages)),
        "SOON_SHARES": ", ".join(repr(share) for share, _ in found.soon),
        "SOON_LENGTHS": ", ".join(repr(length) for _, length in found.soon),
        "TO_ZERO": ", ".join(str(int(one_sided)) for one_sided in found.to_zero),
    }


def _beyond(places: list[float]) -> float:
    """Return how far bounds between stages reach beyond all stages, over the range of what was seen there.

    The steepest slope is at most that range over the shortest distance of two stages.
    """
    gaps = [b - a for a, b in pairwise(places)]
    return math.ceil(50 * max(gaps) / min(gaps)) / 100


def apart(tableau: Tableau) -> list[int]:
    """Return the stages of a method in order of time that stand apart, its end the last."""
    nodes = [*tableau.nodes[: tableau.main_stages], 1.0]
    found = [0]
    for k in sorted(range(1, tableau.main_stages), key=lambda k: (float(nodes[k]), k)):
        if nodes[k] - nodes[found[-1]] >= APART and 1 - nodes[k] >= APART:
            found.append(k)
    return [*found, tableau.main_stages]


def kernel(program: Program, group: str, head: str) -> tuple[list[str], int]:
    """Return static functions of a group, its tables among them, and the number of their constants."""
    lines, constants = c.kernels(program, group, head)
    names = table_names(program)
    tables = [f"{table_function(n, table)}\n" for table, n in names.items()]
    texts = [*tables, *lines]
    for n in names.values():
        texts = [re.sub(rf"\b{n}\(", f"{head}_{n}(", text) for text in texts]
    return texts, constants


def _filled(template: str, prefix: str, **values: str) -> str:
    text = resources.files("codegen.loops").joinpath(template).read_text("ascii")
    for key, value in {"PREFIX": prefix, "DEPTH": f"{MARGIN}.0", **values}.items():
        text = text.replace(f"@{key}@", value)
    return text
