"""Work-precision diagrams: run time over error of many programs on one problem, measured by `codegen`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eom.errors import InputError
from eom.views.draw.formulas import short
from eom.views.draw.picture import Axis, Curve, Dash, Item, Marks, Panel, Picture, check, points

if TYPE_CHECKING:
    from codegen.measure.workprecision.measuring import Diagram, Point

Style = tuple[Dash, float]

COLOURS = ("blue", "red", "green", "orange", "purple", "sky", "yellow", "grey")
STYLES: Mapping[str, Style] = {
    "solve_ivp:": ("dotted", 1.2),
    "scipy:": ("dashed", 1.2),
    "sundials:": ("dashed", 2.2),
    "heyoka": ("solid", 2.6),
}
"""Dash and width by the beginning of a program's name; this project's own are solid and of usual width."""
OWN: Style = ("solid", 1.5)
HEYOKA = "black"
ROUNDING = 1e-16
"""References with errors below this are as good as doubles are."""
AROUND = 3.0
"""Room beside the least and the greatest error and time, as a factor."""


def work_precision(diagram: Diagram) -> Picture:
    """Return time (s) over error, both on logarithmic scales, fine results to the right.

    Parameters
    ----------
    diagram : Diagram
        Of `codegen.measure.workprecision.measuring.measure`.

    Returns
    -------
    Picture
        The time (s) of an integration over its error: that at the end, of the state that is worst,
        over its largest size. A dotted vertical line stands at the reference's own error where it
        is above rounding.

    Raises
    ------
    InputError
        Where nothing was measured.

    Examples
    --------
    >>> from codegen.measure.workprecision import measuring, programs
    >>> from codegen.measure.workprecision.case import Case
    >>> from eom import problems
    >>> p = problems.ready("heavy-top")
    >>> case = Case(p.name, p.title, p.system, p.start, p.parameters, p.inputs, 0.1)
    >>> plan = measuring.Plan((1e-6, 1e-9), rounds=1, limit=60.0)
    >>> measured = measuring.measure(case, programs.programs(["DOP853"]), plan)
    >>> [(point.program, point.rtol) for point in measured.points]
    [('DOP853', 1e-06), ('DOP853', 1e-09)]
    >>> work_precision(measured).rows[0][0].axes[1].words
    'time of the integration [s]'
    """
    if not diagram.points:
        raise InputError("nothing was measured", where=short(diagram.case.title))
    names = dict.fromkeys(p.program for p in diagram.points)
    items: list[Item] = [
        item
        for name in names
        for item in _program(
            name, _number(name, names), [p for p in diagram.points if p.program == name]
        )
    ]
    times = _limits([p.seconds for p in diagram.points])
    reference = diagram.reference.error
    if reference > ROUNDING:
        line = points([reference, reference], times)
        items.append(Curve(line, "grey", 0.9, "dotted", "error of the reference"))
    low, high = _limits([p.error for p in diagram.points])
    axes = (
        Axis(
            "error at the end, of the state that is worst, over its largest size",
            "log",
            (high, low),
        ),
        Axis("time of the integration [s]", "log", times),
    )
    panel = Panel(tuple(items), axes, height=2.2)
    best = min(diagram.points, key=lambda p: p.error)
    caption = (
        "Run time over error of each program, lower and further right is better; the least error is "
        f"{best.error:.1e}, of {short(best.program)}."
    )
    return check(Picture(((panel,),), short(diagram.case.title), caption))


def _style(name: str) -> Style:
    return next((v for k, v in STYLES.items() if name.startswith(k)), OWN)


def _number(name: str, names: Iterable[str]) -> int:
    """Return the number of a program among those of its dash, so that no two lines look the same."""
    return [n for n in names if _style(n)[0] == _style(name)[0]].index(name)


def _program(name: str, number: int, measured: Sequence[Point]) -> tuple[Item, Item]:
    """Return the line of a program and its dots, in the order of its tolerances."""
    dash, width = _style(name)
    colour = HEYOKA if name == "heyoka" else COLOURS[number % len(COLOURS)]
    at = points([p.error for p in measured], [p.seconds for p in measured])
    return Curve(at, colour, width, dash, short(name)), Marks(at, colour, 4.0)


def _limits(values: Sequence[float]) -> tuple[float, float]:
    known = np.array([v for v in values if 0 < v < np.inf])
    if not len(known):
        return ROUNDING, 1.0
    return float(known.min() / AROUND), float(known.max() * AROUND)
