"""Time histories: states and outputs over time, a panel a unit, and the drift of the invariants below.

The integrated motion of a scene of any model, for pictures of its states and outputs.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eom.errors import InputError
from eom.views.draw.formulas import name, short, unit
from eom.views.draw.picture import Axis, Curve, Dash, Floats, Item, Panel, Picture, check, points
from eom.views.draw.printed import thinned

if TYPE_CHECKING:
    from codegen import Result
    from codegen.runs.pruning import Drift
    from eom.opening import AnyScene
    from eom.quantities import Quantity
    from eom.system import System
    from eom.views.draw.picture import Floats

MOST = 8
"""Curves of one panel."""
COLOURS = ("blue", "red", "green", "orange", "purple", "sky", "black", "grey")
DASHES: tuple[Dash, ...] = ("solid", "dashed")
FLOOR, ROUNDING = 1e-17, 1e-13
"""Ends of the scale of drift, at least."""
TIME = Axis("$t$ [s]")


@dataclass(frozen=True)
class _Group:
    """Curves of one unit, by name."""

    unit: str
    names: tuple[str, ...]


def quantities(system: System) -> tuple[Quantity, ...]:
    """Return what a result of a system holds: its states and outputs, with their units.

    >>> import eom
    >>> [q.unit for q in quantities(eom.free_rigid_body())][:3]
    ['rad/s', 'rad/s', 'rad/s']
    """
    return (*system.states, *(d.quantity for d in system.outputs))


def histories(
    result: Result, known: Iterable[Quantity], names: Iterable[str] = (), title: str = ""
) -> Picture:
    """Return states and outputs of a run over time (s), quantities of one unit together.

    ``result``: of `codegen.simulate`; ``known``: the quantities of `quantities`, for their units.
    ``names``: which to draw, in panels of eight curves at most; without them all, but eight a unit, and
    the caption says how many are left out. The lowest panel has the drift of the invariants, value less
    first value, on a logarithmic scale; it says whether drift is relative (over the size of the terms that
    the invariant is made of) or absolute (in its unit, where all terms are zero). Values that are no
    numbers leave gaps.

    Raises `InputError` for unknown names, for fewer than two times, and for a quantity without numbers.

    >>> import codegen, eom
    >>> system = eom.free_rigid_body()
    >>> start = {"omega_1": 0.1, "omega_2": 2.0, "omega_3": 0.1}
    >>> run = codegen.simulate(codegen.compile(system), start, (0, 9), {"I1": 1.0, "I2": 2.0, "I3": 3.0})
    >>> made = histories(run, quantities(system), ["omega_2"])
    >>> [row[0].axes[1].words for row in made.rows[1:]]  # below omega_2
    ['relative drift']
    """
    if len(result.t) < 2 or not np.all(np.isfinite(result.t)):
        raise InputError(
            "a history needs two times",
            where="histories",
            got=f"{len(result.t)} times",
            hint="the run stopped before its second stored time; see its message",
        )
    asked = tuple(dict.fromkeys(names))
    known = tuple(known)
    units = {q.name: q.unit for q in known}
    groups = _groups(asked or tuple(q.name for q in known if _held(result, q.name)), units)
    shown = groups if asked else [_Group(g.unit, g.names[:MOST]) for g in groups]
    panels = [_panel(result, part) for group in shown for part in _parts(group)]
    if not panels:
        raise InputError("no quantity to draw", where="histories", hint="name states or outputs")
    notes = [*_left_out(groups, shown), *_gaps(result, shown)]
    if result.drift:
        panels.append(_drifts(result, notes))
    return check(
        Picture(tuple((p,) for p in _timed(panels, result)), short(title), " ".join(notes))
    )


def of_result(result: Result, names: Iterable[str] = ()) -> Picture:
    """Return the histories of a result by itself: of ``names``, or of all its states and outputs.

    Units are those that it states. Raises as `histories` does.
    """
    known = _known(result)
    asked = tuple(names)
    for n in asked:
        result[n]  # raises for those that it does not have
    return histories(result, known, asked)


def _known(result: Result) -> list[Quantity]:
    """Return what a result holds: as its system has it, or by names and units where it was read."""
    import sympy as sp

    from eom.quantities import Quantity

    origin: Any = result.origin
    system = origin.compiled.system if origin is not None else None
    own = {q.name: q for q in quantities(system)} if system is not None else {}
    return [
        own.get(n) or Quantity(sp.Symbol(n, real=True), result.units.get(n, ""))
        for n in (*result.names, *result.outputs)
    ]


def histories_of(
    scene: AnyScene, seconds: float | None = None, points: int | None = None
) -> Picture:
    """Return the histories of what a scene asks for; of all states, eight a unit, where it names nothing.

    ``scene``: of any model; ``seconds`` (s), ``points``: end and number of the stored times, by default the
    scene's. Axes and errors as of `histories`; raises as `codegen.simulate` does, too.

    >>> import eom
    >>> histories_of(eom.load_scene("t-handle"), seconds=1.0, points=101).rows[-1][0].axes[0].words
    '$t$ [s]'
    """
    result, system = run(scene, seconds, points)
    known = (*system.state_names, *system.output_names)
    return histories_asked(result, system, [n for n in scene.requested if n in known], scene)


def histories_asked(
    result: Result, system: System, requested: Iterable[str], scene: AnyScene
) -> Picture:
    """Return the histories of a run: all that a scene names, or a readable number of its states."""
    requested = tuple(requested)
    known = [q for q in quantities(system) if q.name in requested]
    names = requested if scene.outputs else ()
    return histories(result, known, names, scene.title or scene.name)


def _held(result: Result, quantity: str) -> bool:
    return quantity in result.names or quantity in result.outputs


def _groups(names: Iterable[str], units: Mapping[str, str]) -> list[_Group]:
    """Return names by unit, units in the order in which they first come."""
    found: dict[str, list[str]] = {}
    for n in names:
        found.setdefault(units.get(n, "") or "1", []).append(n)
    return [_Group(own, tuple(group)) for own, group in found.items()]


def _parts(group: _Group) -> Iterator[_Group]:
    for first in range(0, len(group.names), MOST):
        yield _Group(group.unit, group.names[first : first + MOST])


def _panel(result: Result, group: _Group) -> Panel:
    items: list[Item] = []
    for n, (colour, dash) in zip(group.names, _looks(), strict=False):
        values = np.asarray(result[n], dtype=np.float64)
        if not np.any(np.isfinite(values)):
            raise InputError("no value is a number", where=f"history of {n}", got=result.message)
        line = points(*thinned(result.t, _unwound(values, group.unit)))
        items.append(Curve(line, colour, dash=dash, label=name(n)))
    alone = name(group.names[0]) if len(group.names) == 1 else ""
    words = f"{alone} [{unit(group.unit) or 1}]".strip()
    return Panel(tuple(items), (Axis(), Axis(words)))


def _looks() -> Iterator[tuple[str, Dash]]:
    return ((colour, dash) for dash in DASHES for colour in COLOURS)


def _unwound(values: Floats, unit: str) -> Floats:
    """Break the line of an angle where it is brought back by a turn: all within -pi and pi, and a jump."""
    if unit != "rad" or np.nanmax(np.abs(values)) > math.pi * (1 + 1e-12):
        return values
    broken = values.copy()
    broken[1:][np.abs(np.diff(values)) > 1.5 * math.pi] = np.nan
    return broken


def _drifts(result: Result, notes: list[str]) -> Panel:
    """Return the panel of the invariants whose drift is the largest."""
    order = sorted(result.drift, key=lambda n: -_largest(result.drift[n]))
    shown = [n for n in result.drift if n in order[:MOST]]
    if len(order) > MOST:
        notes.append(f"{len(order) - MOST} more constants of the motion drift less.")
    kinds = {n: result.drift[n].kind for n in shown}
    same = len(set(kinds.values())) == 1
    items: list[Item] = []
    for n, (colour, dash) in zip(shown, _looks(), strict=False):
        label = name(n) if same else f"{name(n)}, {kinds[n]}"
        items.append(Curve(_sizes(result.t, result.drift[n]), colour, 1.2, dash, label))
    top = max([ROUNDING, *filter(math.isfinite, (_largest(result.drift[n]) for n in shown))])
    limits = (FLOOR, 10.0 ** math.ceil(math.log10(top)))
    words = f"{kinds[shown[0]]} drift" if same else "drift"
    notes.append(
        "Below: the size of the drift of each constant of the motion, value less first value."
    )
    return Panel(tuple(items), (Axis(), Axis(words, "log", limits)), height=0.9)


def _sizes(t: Floats, drift: Drift) -> Floats:
    """Return the size of the drift over time, but for zeros, which a logarithmic scale has not.

    What is always zero is drawn at the floor.
    """
    size = np.abs(drift.over_time) / drift.scale
    if not np.any(size):
        return points(t, np.full(len(t), FLOOR))
    return points(*thinned(t[size != 0], size[size != 0]))


def _largest(drift: Drift) -> float:
    return drift.relative if math.isfinite(drift.relative) else math.inf


def _timed(panels: Sequence[Panel], result: Result) -> Iterator[Panel]:
    """Give all panels the same span of time, and the lowest its words."""
    limits = (float(min(result.t)), float(max(result.t)))
    for k, panel in enumerate(panels, 1):
        time = Axis(TIME.words if k == len(panels) else "", limits=limits)
        yield Panel(panel.items, (time, panel.axes[1]), height=panel.height)


def _left_out(groups: Sequence[_Group], shown: Sequence[_Group]) -> Iterator[str]:
    for whole, part in zip(groups, shown, strict=True):
        lost = len(whole.names) - len(part.names)
        if lost:
            yield f"{lost} more in {whole.unit} are drawn where they are named."


def _gaps(result: Result, shown: Sequence[_Group]) -> Iterator[str]:
    for n in (n for group in shown for n in group.names):
        lost = int(np.count_nonzero(~np.isfinite(result[n])))
        if lost:
            yield f"{lost} of {len(result.t)} values of {n} are no numbers."


def run(
    scene: AnyScene, seconds: float | None = None, points: int | None = None
) -> tuple[Result, System]:
    """Integrate a scene as `eom simulate` does; return the run and the system of its states and outputs.

    ``seconds``, ``points``: end and number of the stored times, by default the scene's own. Raises as
    derivation and `codegen.simulate` do.
    """
    plan = scene.integration
    t = np.linspace(0.0, seconds or plan.t_end, points or plan.points)
    return integrated(scene, t), scene.derive()


def integrated(scene: AnyScene, t: Floats) -> Result:
    """Return the run of a scene over the times ``t``, in the scene's own coordinates."""
    import codegen

    plan = scene.integration
    return codegen.simulate(
        codegen.compile(scene.derive()),
        scene.initial_values(),
        (float(t[0]), float(t[-1])),
        scene.parameter_values(),
        plan.method,
        plan.rtol,
        plan.atol,
        t,
        inputs=scene.input_values(),
        max_step=plan.max_step or math.inf,
        max_steps=plan.max_steps,
    )
