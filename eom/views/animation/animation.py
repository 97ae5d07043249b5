"""A simulated scene as an animation: frozen data that pages and slides are made from.

Times are equally far apart and so close that attitudes between two of them follow by interpolation on the
great circle (`STEP`). All components are in the frame A that attitude is measured in, or the ground's.

Motions that are no scenes, as animations: closed forms, a gyrostat, another program's attitude.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from eom.errors import InputError, unknown_name
from eom.opening import AnyScene
from eom.views.animation.acting import STYLES
from eom.views.animation.bodies import Bodies, bodies_of, tracks_of, with_attitude
from eom.views.animation.figures import Figure, Figures, Shape, equivalent
from eom.views.animation.tracks import (
    LARGEST_STEP,
    STEP,
    Floats,
    Track,
    Tracks,
    continuous,
    matrices,
    turned,
)

if TYPE_CHECKING:
    from codegen import Result

COARSE = 301
"""Stored times at least."""
BUDGET = 700_000
"""Bytes of all samples: the page that holds them stays below 2 MB."""
BYTES_OF_BODY, BYTES_OF_VECTOR = 40, 12
SHORT, LONG, AIM = 2.0, 40.0, 20.0
"""A motion that takes between the first two (s) is shown as it is; others about as long as the third."""
MOST_READOUTS = 8
GROUND_GAP = 0.03
AROUND_ONE = 1.2
"""What is seen around a single body, by its extent: its vectors need room."""
SAMPLES = 100
"""Times at which the space that the motion takes is measured."""
FAR = 5.0
"""A motion that takes more room than what moves, so many times, has a camera that follows a body."""
SPACE_AXES = (r"$\mathbf{a}_1$", r"$\mathbf{a}_2$", r"$\mathbf{a}_3$")
ORBIT_AXES = (f"{SPACE_AXES[0]} radial", f"{SPACE_AXES[1]} along", f"{SPACE_AXES[2]} normal")
STAYS = "none"
"""The word for a camera that follows nothing."""

OMEGA, H, TAU = r"$\omega$", "$H$", r"$\tau$"

Integrate = Callable[[AnyScene], "Result"]


@dataclass(frozen=True, eq=False)
class Arrows:
    """A vector over time: ``values`` in ``unit``, and ``places`` it starts from (m), shape (N, 3).

    Components are in A. Vectors of one ``kind`` are hidden and shown together, those of one unit have one
    scale; ``text``, with formulas between dollar signs, stands at the tip; ``colour``: a name of
    `eom.views.draw.picture.COLOURS`.
    """

    kind: str
    text: str
    unit: str
    colour: str
    values: Floats
    places: Floats
    body: int = -1
    """The body that it belongs to, -1 where it is of all."""
    words: str = ""
    """What it is, where the text does not say it."""


@dataclass(frozen=True, eq=False)
class Readout:
    """A number over time, ``values`` (N,) in ``unit``, that stands beside the picture."""

    name: str
    unit: str
    values: Floats


@dataclass(frozen=True, eq=False)
class View:
    """A ball that holds the motion, and from where it is seen; components in A.

    ``centre`` (3,) and ``radius`` of the ball (m); ``up``: a unit vector; ``camera``: azimuth and elevation
    of where it stands (degrees); ``ground``: height of the ground along ``up`` (m), None without one.
    ``follow``: the number of a body with which the ball goes, and the camera, or -1; ``centre`` is then
    where the body is at the start.
    """

    centre: Floats
    radius: float
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)
    camera: tuple[float, float] = (35.0, 20.0)
    ground: float | None = None
    follow: int = -1


@dataclass(frozen=True, eq=False)
class Animation:
    """What moves, and how it is shown.

    ``words``: below the title; ``tracks``, ``figures``: where the bodies are, and what they look like;
    ``arrows``: vectors, ``readouts``: numbers over time; ``view``: from where it is seen; ``speed``:
    seconds of the motion that a second shows; ``axes``: names of the axes of A; ``notes``: below it.
    """

    title: str
    words: str
    tracks: Tracks
    figures: Figures
    arrows: tuple[Arrows, ...]
    readouts: tuple[Readout, ...]
    view: View
    speed: float
    axes: tuple[str, str, str] = SPACE_AXES
    notes: tuple[str, ...] = ()

    @property
    def times(self) -> Floats:
        """The stored times (s), equally far apart, shape (N,)."""
        return self.tracks.times


def animation_of(
    scene: AnyScene,
    integrate: Integrate,
    *,
    seconds: float | None = None,
    speed: float | None = None,
    robot: dict[str, tuple[Shape, ...]] | None = None,
    follow: str | None = None,
) -> Animation:
    """Return the animation of a scene that ``integrate`` simulates, with attitude where the scene has none.

    Parameters
    ----------
    scene : Scene or TreeScene
        Of any model; vectors get components in A, the frame that attitude is measured in, or the
        ground's.
    integrate : Integrate
        From a scene to its `codegen.Result`; the scene is given attitude where it has none.
    seconds : float, optional
        Of the motion (s), else to the scene's end.
    speed : float, optional
        Seconds of it that are shown in one, else so that it takes a fair time.
    robot : dict of str to tuple of Shape, optional
        Shapes of bodies by name (`eom.views.animation.figures`).
    follow : str, optional
        The body that the camera goes with, or ``none``; if left out, the one that the rest stays
        nearest to, if the motion goes far (`FAR`).

    Returns
    -------
    Animation
        For `eom.views.animation.animation_page.page`.

    Raises
    ------
    InputError
        For an unknown body, for a time or speed that is not positive, for a motion that ends before
        it can be shown, and for one that turns so fast that its samples would not fit into a page
        of 2 MB.

    Examples
    --------
    >>> import eom
    >>> from eom.views.time.histories import run
    >>> made = animation_of(eom.load_scene("t-handle"), lambda scene: run(scene)[0], seconds=2.0)
    >>> [(arrow.kind, arrow.unit) for arrow in made.arrows], float(made.times[-1])
    ([('omega', 'rad/s'), ('momentum', 'N m s')], 2.0)
    """
    for name, given in (("seconds", seconds), ("speed", speed)):
        if given is not None and not (math.isfinite(given) and given > 0):
            raise InputError("not a positive number", where=name, got=given)
    prepared = with_attitude(scene, COARSE, seconds)
    told: dict[str, Any] = {"speed": speed, "robot": robot, "follow": follow}
    return sampled(prepared, integrate, asked=scene.requested, **told)


def sampled(
    prepared: AnyScene,
    integrate: Integrate,
    *,
    speed: float | None = None,
    robot: dict[str, tuple[Shape, ...]] | None = None,
    asked: tuple[str, ...] = (),
    follow: str | None = None,
) -> Animation:
    """Return the animation of a scene of `with_attitude`, simulated again where it needs more samples.

    ``asked``: names of states and outputs whose values are shown. Raises as `animation_of`.
    """
    prepared = _with_points(prepared, max(COARSE, prepared.integration.points))
    tracks, result = _tracks(prepared, integrate)
    count = _needed(tracks, prepared)
    if count > len(tracks.times):
        planned = abs(float(prepared.integration.t_end))
        share = planned / abs(float(tracks.times[-1] - tracks.times[0]))
        prepared = _with_points(prepared, math.ceil(count * share))
        tracks, result = _tracks(prepared, integrate)
    told: dict[str, Any] = {"speed": speed, "robot": robot, "follow": follow}
    return shown(prepared, tracks, result, asked=asked, **told)


def _with_points(scene: AnyScene, points: int) -> AnyScene:
    """Return a scene with other stored times; what was derived of it is kept."""
    plan = scene.integration.model_copy(update={"points": points})
    return scene.model_copy(update={"integration": plan})


def _tracks(scene: AnyScene, integrate: Integrate) -> tuple[Tracks, Result]:
    """Return the motion up to the last of the equally spaced times that was reached."""
    result = integrate(scene)
    plan = scene.integration
    step = plan.t_end / (plan.points - 1)
    due = np.arange(len(result.t)) * step
    kept = int(np.count_nonzero(np.abs(result.t - due) <= 1e-6 * abs(step)))
    if kept < 2:
        raise InputError("the motion ends before it can be shown", got=result.message)
    cut = {n: v[:kept] for n, v in result.outputs.items()}
    result = replace(result, t=result.t[:kept], y=result.y[:, :kept], outputs=cut)
    return tracks_of(scene, result), result


def _needed(tracks: Tracks, scene: AnyScene) -> int:
    """Return how many times are stored. Raises `InputError` where bodies need too many.

    Rotors that would need too many are shown turning slower (`eom.views.animation.posture.slowed`).
    """
    spans = np.abs(tracks.times - tracks.times[0])
    turned = _reached([b for b in tracks.bodies if not b.slower], spans)
    vectors = len(tracks.bodies) + 2 + MOST_READOUTS / 3 + 2 * len(tracks.acting)
    most = int(BUDGET / (BYTES_OF_BODY * len(tracks.bodies) + BYTES_OF_VECTOR * vectors))
    if turned[-1] > LARGEST_STEP * most:
        possible = float(spans[turned <= 0.95 * LARGEST_STEP * most][-1])
        raise InputError(
            "too many turns for one animation",
            where=scene.name,
            got=f"{turned[-1] / (2 * math.pi):.0f} turns in {spans[-1]:g} s",
            expected=f"at most {LARGEST_STEP * most / (2 * math.pi):.0f}",
            hint=f"--t-end {possible:.3g}",
        )
    whole = _reached(tracks.bodies, spans)
    turns = float((whole if whole[-1] <= LARGEST_STEP * most else turned)[-1])
    return max(COARSE, min(most, math.ceil(turns / STEP) + 1))


def _reached(tracks: Sequence[Track], spans: Floats) -> Floats:
    """Return how far the fastest of bodies turns at most (rad), shape (N,), in spans from the start."""
    rates = np.max([np.linalg.norm(b.omega, axis=1) for b in tracks], axis=0)
    return np.asarray(np.maximum.accumulate(rates) * spans)


def shown(
    scene: AnyScene,
    tracks: Tracks,
    result: Result,
    *,
    speed: float | None = None,
    robot: dict[str, tuple[Shape, ...]] | None = None,
    asked: tuple[str, ...] = (),
    follow: str | None = None,
) -> Animation:
    """Return the animation of a motion that was simulated (`eom.views.animation.bodies.tracks_of`)."""
    bodies = bodies_of(scene)
    figures = bodies.figures(robot or {})
    span = abs(float(tracks.times[-1] - tracks.times[0]))
    return Animation(
        title=scene.title or scene.name,
        words=scene.description,
        tracks=tracks,
        figures=figures,
        arrows=tuple(arrows_of(tracks)),
        readouts=tuple(_readouts(scene, result, asked))[:MOST_READOUTS],
        view=_view(bodies, tracks, figures, follow),
        speed=speed or speed_of(span),
        axes=ORBIT_AXES if bodies.orbit else SPACE_AXES,
        notes=(*_notes(bodies, result, figures), *_slower(tracks)),
    )


def speed_of(span: float) -> float:
    """Return 1 for a motion of fair length, else the nearest of ..., 0.5, 1, 2, 5, 10, 20, ..."""
    if SHORT <= span <= LONG:
        return 1.0
    wanted = span / AIM
    power = 10.0 ** math.floor(math.log10(wanted))
    return float(min((n * power for n in (1, 2, 5, 10)), key=lambda s: abs(math.log(s / wanted))))


def arrows_of(tracks: Tracks) -> Iterator[Arrows]:
    """Yield the vectors of a motion: omega of each body, momentum, and torque where it acts."""
    for k, body in enumerate(tracks.bodies):
        yield Arrows("omega", OMEGA, *STYLES["omega"][:2], body.omega, body.positions, k)
    yield Arrows("momentum", H, *STYLES["momentum"][:2], tracks.momentum, tracks.centre)
    if tracks.torque is not None and np.any(tracks.torque):
        yield Arrows("torque", TAU, *STYLES["torque"][:2], tracks.torque, tracks.centre)
    for load in tracks.acting:
        told = load.values, load.places
        yield Arrows(load.kind, load.letter, *STYLES[load.kind][:2], *told, words=load.name)


SHARES = {"rad/s": 0.95, "N m s": 0.8, "N m": 0.65, "N": 0.5}
"""Length of the longest vector of each unit, as a share of what there is room for."""


def scales_of(animation: Animation) -> dict[str, float]:
    """Return the length (m) of one of each unit of vectors, at which the longest fit the picture."""
    largest: dict[str, float] = {}
    for arrow in animation.arrows:
        size = float(np.linalg.norm(arrow.values, axis=1).max())
        largest[arrow.unit] = max(size, largest.get(arrow.unit, 0.0))
    room = animation.view.radius * (1.0 if len(animation.tracks.bodies) == 1 else 0.8)
    return {unit: SHARES[unit] * room / size for unit, size in largest.items() if size > 0}


def _readouts(scene: AnyScene, result: Result, asked: tuple[str, ...]) -> Iterator[Readout]:
    system = scene.derive()
    quantities = (*system.states, *(d.quantity for d in system.outputs))
    units = {q.name: "" if q.unit == "1" else q.unit for q in quantities}
    for name in asked:
        if name in result.names or name in result.outputs:
            yield Readout(name, units.get(name, ""), np.asarray(result[name]))


def _notes(bodies: Bodies, result: Result, figures: Figures) -> Iterator[str]:
    if result.status not in {0, 2}:
        yield result.message
    if bodies.orbit:
        yield "Space frame: a₁ points away from the Earth, a₂ along the orbit, a₃ normal to it."
    for figure in figures.bodies:
        if figure.words:
            label = "Drawn" if len(figures.bodies) == 1 else figure.name
            yield f"{label}: {figure.words}"


def _slower(tracks: Tracks) -> Iterator[str]:
    """Yield which rotors turn slower than they do, one line a factor."""
    factors = sorted({b.slower for b in tracks.bodies if b.slower > 1})
    for factor in factors:
        names = ", ".join(b.name for b in tracks.bodies if b.slower == factor)
        yield f"{names}: shown turning {factor:.0f} times slower, too fast to be seen otherwise"


# -- the view --------------------------------------------------------------------------------------


def view_of(tracks: Tracks, figures: Figures, follow: str | None = None) -> View:
    """Return the view of a motion without gravity; it follows a body where the motion goes far.

    ``follow``: the body's name, or `STAYS`. Raises `InputError` for others.
    """
    names = [track.name for track in tracks.bodies]
    if follow is not None:
        if follow not in {*names, STAYS}:
            raise unknown_name("body", follow, [*names, STAYS], "follow")
        return _room(tracks, figures, names.index(follow) if follow in names else -1)
    whole = _room(tracks, figures, -1)
    near = min(
        (_room(tracks, figures, k) for k in range(len(tracks.bodies))), key=lambda v: v.radius
    )
    return near if whole.radius > FAR * near.radius else whole


def _room(tracks: Tracks, figures: Figures, follow: int) -> View:
    """Return the ball that holds the motion, or that goes with a body and holds it at all times."""
    points = np.concatenate([*_places(tracks, figures)], axis=1)
    if follow >= 0:
        centre, ways = (
            tracks.bodies[follow].positions[0],
            tracks.bodies[follow].positions[_some(tracks)],
        )
    else:
        still = len(tracks.bodies) == 1 and not np.any(tracks.bodies[0].positions)
        ends = points.min(axis=(0, 1)), points.max(axis=(0, 1))
        centre = ways = np.zeros(3) if still else (ends[0] + ends[1]) / 2
    radius = float(np.linalg.norm(points - ways.reshape(-1, 1, 3), axis=2).max())
    return View(centre, radius * (AROUND_ONE if len(tracks.bodies) == 1 else 1), follow=follow)


def _view(bodies: Bodies, tracks: Tracks, figures: Figures, follow: str | None) -> View:
    """Return the view of a scene: under gravity there are up, down and a ground."""
    view, gravity = view_of(tracks, figures, follow), bodies.gravity
    if gravity is None:
        return view
    up = -gravity / np.linalg.norm(gravity)
    floor = bodies.floor
    if floor is None:
        lowest = min(float((p @ up).min()) for p in _places(tracks, figures))
        stands = [float((s.mesh.vertices @ up).min()) for s in figures.ground]
        floor = min([lowest - GROUND_GAP * view.radius, *stands])
    a, b, c = (float(x) for x in up)
    return replace(view, up=(a, b, c), camera=_camera(tracks, up), ground=floor)


def _places(tracks: Tracks, figures: Figures) -> Iterator[Floats]:
    """Yield where the vertices of the bodies are at some of the times, shape (times, vertices, 3)."""
    some = _some(tracks)
    for track, figure in zip(tracks.bodies, figures.bodies, strict=True):
        yield track.positions[some, None]
        if figure.shapes:
            vertices = np.concatenate([s.mesh.vertices for s in figure.shapes])[::7]
            turned = np.einsum("nij,vi->nvj", matrices(track.quaternions[some]), vertices)
            yield track.positions[some, None] + turned


def _some(tracks: Tracks) -> slice:
    return slice(None, None, max(1, len(tracks.times) // SAMPLES))


def at(track: Track, point: Any) -> Floats:
    """Return where a point of a body is (m), shape (N, 3); ``point`` from its origin, in its axes."""
    moved = np.einsum("nij,i->nj", matrices(track.quaternions), np.asarray(point, dtype=np.float64))
    return np.asarray(track.positions + moved)


def level(up: Floats) -> tuple[Floats, Floats]:
    """Return level unit vectors: nearest to a1, or to a2 if that is up, and across it."""
    across = np.eye(3)[0] - up[0] * up
    if across @ across < 0.1:
        across = np.eye(3)[1] - up[1] * up
    across /= np.linalg.norm(across)
    return across, np.cross(up, across)


def _camera(tracks: Tracks, up: Floats) -> tuple[float, float]:
    """Return azimuth and elevation (degrees): in front of a plane motion, above any other.

    Azimuth is measured from the horizontal direction nearest to a1 (or a2 if that is up).
    """
    rates = np.concatenate([b.omega for b in tracks.bodies])
    _, sizes, directions = np.linalg.svd(rates, full_matrices=False)
    normal = directions[0]
    if sizes[1] > 1e-6 * max(sizes[0], 1e-300) or abs(normal @ up) > 0.1:
        return 35.0, 20.0
    across, along = level(up)
    azimuth = math.degrees(math.atan2(float(normal @ along), float(normal @ across)))
    azimuth = azimuth - 180 if azimuth > 45 else azimuth
    azimuth = azimuth + 180 if azimuth < -135 else azimuth
    return azimuth + 18, 10.0


def animation_of_motion(
    title: str,
    times: ArrayLike,
    quaternions: ArrayLike,
    omega: ArrayLike,
    inertia: ArrayLike,
    *,
    mass: float | None = None,
    momentum: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    speed: float | None = None,
) -> Animation:
    """Return the animation of one body about a point that stays.

    Parameters
    ----------
    title : str
        The heading of the page.
    times : array
        In seconds, shape (N,), equally far apart.
    quaternions : array
        Of C_BA, scalar first, shape (N, 4).
    omega : array
        Angular velocity (rad/s), components in the body frame B, shape (N, 3).
    inertia : array
        J (kg m^2): three principal moments or a matrix.
    mass : float, optional
        In kg; if known, the uniform body that is drawn has it.
    momentum : array, optional
        Angular momentum (N m s), as ``omega``, by default J omega.
    torque : array, optional
        In N m, as ``omega``, by default none.
    speed : float, optional
        Seconds of the motion that are shown in one.

    Returns
    -------
    Animation
        For `eom.views.animation.animation_page.page`; the body turns about a point that stays.

    Raises
    ------
    InputError
        For arrays that do not fit, quaternions that are none, times that are not equally far apart
        or so far that the body turns by more than 2 radians between two.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0.0, 4.0, 41)
    >>> q = np.stack([np.cos(t / 2), 0 * t, 0 * t, np.sin(t / 2)], axis=1)  # 1 rad/s about b3
    >>> omega = np.broadcast_to((0.0, 0.0, 1.0), (41, 3))
    >>> made = animation_of_motion("A steady turn", t, q, omega, (1.0, 2.0, 3.0), mass=4.0)
    >>> made.figures.bodies[0].words
    'box of equal inertia (a 2.45 m, b 1.73 m, c 0.122 m, thickened)'
    """
    t = np.asarray(times, dtype=np.float64)
    rows = {"quaternions": (quaternions, 4), "omega": (omega, 3),
            "momentum": (momentum, 3), "torque": (torque, 3)}  # fmt: skip
    given = {n: _rows(n, v, (len(t), width)) for n, (v, width) in rows.items() if v is not None}
    w, q = given["omega"], _unit(given["quaternions"])
    _check_times(t, w)
    J = np.asarray(inertia, dtype=np.float64)
    J = np.diag(J) if J.ndim == 1 else J
    h = given.get("momentum", w @ J.T)
    still = np.zeros((len(t), 3))
    track = Track(title, still, q, turned(q, w))
    m = turned(q, given["torque"]) if "torque" in given else None
    tracks = Tracks(t, (track,), turned(q, h), still, m)
    body = equivalent(J, mass)
    unknown = "" if mass else "; its size is not known"
    tip = 1.15 * body.mesh.extent * np.eye(3)[2]
    figures = Figures((Figure(title, (Shape(body.mesh),), body.words + unknown, tip=tip),))
    return Animation(
        title=title,
        words="",
        tracks=tracks,
        figures=figures,
        arrows=tuple(arrows_of(tracks)),
        readouts=(),
        view=view_of(tracks, figures),
        speed=speed or speed_of(float(t[-1] - t[0])),
        notes=(f"Drawn: {figures.bodies[0].words}",),
    )


def _rows(name: str, values: ArrayLike, shape: tuple[int, int]) -> Floats:
    found = np.asarray(values, dtype=np.float64)
    if found.shape != shape or not np.isfinite(found).all():
        got = f"shape {found.shape}" if found.shape != shape else "numbers that are not finite"
        raise InputError("an array does not fit", where=name, got=got, expected=f"shape {shape}")
    return found


def _unit(q: Floats) -> Floats:
    norms = np.linalg.norm(q, axis=1)
    if np.abs(norms - 1).max() > 1e-3:
        got = f"norms from {norms.min():.6g} to {norms.max():.6g}"
        raise InputError("quaternions do not have unit norm", where="quaternions", got=got)
    return continuous(q)


def _check_times(t: Floats, omega: Floats) -> None:
    steps = np.diff(t)
    if t.ndim != 1 or len(t) < 2 or not (steps > 0).all() or np.ptp(steps) > 1e-6 * steps[0]:
        raise InputError("times are not equally far apart", where="times",
                         expected="shape (N,), N > 1")  # fmt: skip
    turn = float(np.linalg.norm(omega, axis=1).max() * steps[0])
    if turn > LARGEST_STEP:
        got, expected = f"{turn:.3g} radians", f"at most {LARGEST_STEP:g}"
        raise InputError(
            "too large a turn between two times", where="times", got=got, expected=expected
        )
    most = int(BUDGET / (BYTES_OF_BODY + 3 * BYTES_OF_VECTOR))
    if len(t) > most:
        raise InputError(
            "too many times for one page", where="times", got=len(t), expected=f"at most {most}"
        )
