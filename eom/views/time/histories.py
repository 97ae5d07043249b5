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
UNLIKE = 20.0
"""Ratio of sizes from which on quantities of one unit have panels of their own."""
STILL = 1e-7
"""Share of a size below which nothing moves: where errors of the integration are."""
MOST_CORNERS = 8
"""Places at which a curve may jump or turn sharply, as at impacts, and have points enough."""
COARSE = 0.05
"""How far a line may be from its curve between two points, as a share of the curve's range."""
MOST_POINTS = 200_001
"""Points that are asked for at most where nobody says how many."""
A_STEP = 8
"""Points of a step of an integrator: its steps are as long as the fastest motion lets them be."""
FLOOR, ROUNDING = 1e-17, 1e-13
"""Ends of the scale of drift, at least."""
TIME = Axis("$t$ [s]")


@dataclass(frozen=True)
class _Group:
    """Curves of one unit and of like sizes, by name."""

    unit: str
    names: tuple[str, ...]


def quantities(system: System) -> tuple[Quantity, ...]:
    """Return what a result of a system holds: its states and outputs, with their units.

    Parameters
    ----------
    system : System
        Any.

    Returns
    -------
    tuple of Quantity
        What a result of it holds: states and outputs, with their units.

    Examples
    --------
    >>> import eom
    >>> [q.unit for q in quantities(eom.free_rigid_body())][:3]
    ['rad/s', 'rad/s', 'rad/s']
    """
    return (*system.states, *(d.quantity for d in system.outputs))


def histories(
    result: Result, known: Iterable[Quantity], names: Iterable[str] = (), title: str = ""
) -> Picture:
    """Return states and outputs of a run over time (s), quantities of one unit together.

    Parameters
    ----------
    result : Result
        Of `codegen.simulate`.
    known : iterable of Quantity
        The quantities of `quantities`, for their units.
    names : iterable of str, optional
        Which to draw, in panels of eight curves at most, those apart whose sizes are unlike;
        without them all, but eight a unit, and the caption says how many are left out.
    title : str, optional
        Above the picture.

    Returns
    -------
    Picture
        States and outputs over time (s). The lowest panel has the drift of the invariants, value
        less first value, on a logarithmic scale; it says whether drift is relative (over the size
        of the terms that the invariant is made of) or absolute (in its unit, where all terms are
        zero).

    Raises
    ------
    InputError
        For unknown names, for fewer than two times, and for a quantity without numbers.

    Notes
    -----
    Where lines have too few points for what moves fastest the picture's ``notice`` says so. Values
    that are no numbers leave gaps.

    Examples
    --------
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
    panels = [
        _panel(result, part)
        for group in shown
        for own in _alike(result, group)
        for part in _parts(own)
    ]
    if not panels:
        raise InputError("no quantity to draw", where="histories", hint="name states or outputs")
    notes = [*_left_out(groups, shown), *_gaps(result, shown)]
    if result.drift:
        panels.append(_drifts(result, notes))
    return check(
        Picture(
            tuple((p,) for p in _timed(panels, result)),
            short(title),
            " ".join(notes),
            notice=_too_coarse(result, [n for group in shown for n in group.names]),
        )
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

    Parameters
    ----------
    scene : Scene or TreeScene
        Of any model.
    seconds : float, optional
        End of the stored times, ``seconds`` (s), by default the scene's.
    points : int, optional
        Number of the stored times, by default the scene's.

    Returns
    -------
    Picture
        What the scene asks for; of all states, eight a unit, where it names nothing. Axes as of
        `histories`.

    Raises
    ------
    InputError
        As of `histories`, and as `codegen.simulate` does.

    Examples
    --------
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


def _alike(result: Result, group: _Group) -> list[_Group]:
    """Return the curves of a group in groups of like sizes, each in the order of its first curve.

    From the largest down a group ends where one is less than a share of its largest; zeros, and what is
    zero but for errors, are with the smallest that are not.
    """
    sizes = {n: _magnitude(result[n]) for n in group.names}
    least = STILL * max(sizes.values())
    found: list[list[str]] = []
    largest = 0.0
    for n in sorted(group.names, key=lambda n: -sizes[n]):
        if not found or least < sizes[n] < largest / UNLIKE:
            found.append([])
            largest = sizes[n]
        found[-1].append(n)
    ordered = ([n for n in group.names if n in own] for own in found)
    by_first = sorted(ordered, key=lambda own: group.names.index(own[0]))
    return [_Group(group.unit, tuple(own)) for own in by_first]


def _magnitude(values: Floats) -> float:
    known = np.abs(np.asarray(values, dtype=np.float64))
    return float(np.max(known, where=np.isfinite(known), initial=0.0))


def _too_coarse(result: Result, names: Iterable[str]) -> str:
    """Return a notice of curves with too few points, nothing where all have enough."""
    lost = [n for n in names if _is_coarse(np.asarray(result[n], dtype=np.float64))]
    count = f"{len(result.t):,} points"
    if lost:
        whose = f"{', '.join(lost[:3])}{', ...' if len(lost) > 3 else ''}"
        return f"{count} are too few for {whose}: between them the motion is otherwise; more by --points"
    if result.steps > len(result.t):
        took = f"the integrator took {result.steps:,} steps"
        return f"{count} are drawn, and {took}: fast motion between points is not seen; more by --points"
    return ""


def _is_coarse(values: Floats) -> bool:
    """Return whether lines between points stray: as far as those through every other point show.

    Of a smooth curve these stray four times as far.
    """
    if len(values) < 3:
        return False
    last = len(values) - (len(values) + 1) % 2
    left, right, middle = values[0 : last - 2 : 2], values[2:last:2], values[1 : last - 1 : 2]
    strays = np.abs(middle - 0.5 * (left + right))
    known = values[np.isfinite(values)]
    span = float(np.ptp(known)) if len(known) else 0.0
    rough = np.count_nonzero(strays > 4 * COARSE * span)
    return bool(span > 1e-9 * _magnitude(values) and rough > MOST_CORNERS)


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
    return Panel(tuple(items), (Axis(), Axis(words, limits=_limits(items))))


def _limits(items: Sequence[Item]) -> tuple[float, float] | None:
    """Return the limits of a panel in which nothing moves but by errors, which are not to fill it."""
    values = np.concatenate([i.points[:, 1] for i in items if isinstance(i, Curve)])
    low, high, size = float(np.nanmin(values)), float(np.nanmax(values)), _magnitude(values)
    return (low - 0.1 * size, high + 0.1 * size) if size > 0 and high - low < STILL * size else None


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

    ``seconds``, ``points``: end and number of the stored times, by default the scene's own, and more where
    these are too few for what moves fastest. Raises as derivation and `codegen.simulate` do.
    """
    plan = scene.integration
    end = seconds or plan.t_end
    result = integrated(scene, np.linspace(0.0, end, points or plan.points))
    if points is None:
        wanted = min(MOST_POINTS, A_STEP * result.steps + 1)
        if wanted > len(result.t):
            result = integrated(scene, np.linspace(0.0, end, wanted))
        while len(result.t) < MOST_POINTS and any(map(_is_coarse, result.y)):
            more = min(MOST_POINTS, 4 * len(result.t))
            result = integrated(scene, np.linspace(0.0, end, more))
    return result, scene.derive()


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
