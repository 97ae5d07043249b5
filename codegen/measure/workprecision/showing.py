"""A diagram as a table and as JSON data."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from rich.table import Table

from codegen.integrate.methods import METHODS
from codegen.measure.workprecision.measuring import Diagram, Point, fastest, time_at

SCHEMA = 1
ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)
"""Errors that the columns of the table are about."""
COMPARED = ("heyoka", "solve_ivp:DOP853", "solve_ivp:LSODA")
"""Programs that this project's fastest method is compared with."""
SPREAD = 0.25
"""Medians that exceed the least time by more are told."""


def names(points: Sequence[Point]) -> list[str]:
    """Return the programs in the order in which they were measured."""
    return list(dict.fromkeys(p.program for p in points))


def table(diagram: Diagram) -> Table:
    """Return a row a program: least time for each error, then the least error and its time."""
    reference = diagram.reference
    result = Table(box=None, pad_edge=False, title=f"{diagram.case.name}: {diagram.case.title}")
    result.caption = f"reference: {reference.how}, itself within {reference.error:.1e}"
    errors = [f"{e:.0e}" for e in ERRORS]
    for column in ("time for error <=", *errors, "least error", "in"):
        result.add_column(column, no_wrap=True)
    for name in names(diagram.points):
        own = [p for p in diagram.points if p.program == name]
        best = min(own, key=lambda p: p.error)
        cells = [time_text(fastest(own, e)) for e in ERRORS]
        least = f"{'' if best.known else '< '}{best.error:.1e}"
        result.add_row(name, *cells, least, time_text(best))
    return result


def comparisons(diagram: Diagram) -> dict[str, dict[str, tuple[str, float]]]:
    """Return, by peer and error, this project's fastest method and its time over the peer's.

    Times are those of the curves at that error; errors that either does not reach are left out.
    """
    found: dict[str, dict[str, tuple[str, float]]] = {}
    by_name = {n: [p for p in diagram.points if p.program == n] for n in names(diagram.points)}
    own = [n for n in by_name if n in METHODS and n != "auto" and not n.startswith("scipy:")]
    for peer in (n for n in COMPARED if n in by_name):
        for error in ERRORS:
            theirs = time_at(by_name[peer], error)
            times = {n: time_at(by_name[n], error) for n in own}
            best = min(times, key=lambda n: times[n], default="")
            if best and max(theirs, times[best]) < math.inf:
                found.setdefault(peer, {})[f"{error:.0e}"] = (best, times[best] / theirs)
    return found


def comparison_lines(diagram: Diagram) -> list[str]:
    """Return `comparisons` as text, a line a peer."""
    return [
        f"fastest here over {peer}: "
        + ", ".join(f"{ratio:.2g} at {e} ({name})" for e, (name, ratio) in rows.items())
        for peer, rows in comparisons(diagram).items()
    ]


def time_text(point: Point | None) -> str:
    """Return the least time of a point, and by how much its median exceeds it where that is much."""
    if point is None:
        return "-"
    more = point.median / point.seconds - 1
    return _seconds(point.seconds) + (f" +{100 * more:.0f}%" if more > SPREAD else "")


def _seconds(seconds: float) -> str:
    units = ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"))
    size, unit = next(((s, u) for s, u in units if seconds >= s), (1e-9, "ns"))
    return f"{seconds / size:.3g} {unit}"


def notes(diagram: Diagram) -> list[str]:
    """Return a line a program that was not measured at all, or not to the finest tolerance."""
    return [f"{a.program}: not from rtol {a.rtol:.0e}: {a.reason}" for a in diagram.absent]


def data(diagram: Diagram, about: Mapping[str, Any]) -> str:
    """Return all that was measured as JSON; ``about``: what stands beside it (machine, date, ...)."""
    case, reference = diagram.case, diagram.reference
    found = {
        "schema": SCHEMA,
        "problem": {
            "name": case.name,
            "title": case.title,
            "start": dict(case.start),
            "parameters": dict(case.parameters),
            "inputs": dict(case.inputs),
            "end": case.end,
            "stiff": case.stiff,
        },
        "reference": {
            "how": reference.how,
            "error": reference.error,
            "end": [repr(float(x)) for x in reference.high],
            "scale": [float(x) for x in reference.scale],
        },
        "plan": asdict(diagram.plan),
        "points": [asdict(p) for p in diagram.points],
        "absent": [asdict(a) for a in diagram.absent],
        "comparisons": comparisons(diagram),
        **about,
    }
    return json.dumps(found, indent=1) + "\n"
