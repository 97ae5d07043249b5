"""The herpolhode, and Poinsot's construction: the ellipsoid of inertia rolls on the invariable plane.

Vectors are along e1, e2, e3, where e3 is along the angular momentum H and e1 along the part of omega
across H at t = 0. The tip of omega stays in the plane at the distance 2 T/H from the centre
(Goldstein, Poole, Safko, Classical Mechanics, 2002, sect. 5.6); all lengths are in rad/s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from codegen.closed.polhode import context, number
from eom.errors import InputError
from eom.mechanics.freebody import herpolhode as exact_herpolhode
from eom.views.animation.tracks import matrices
from eom.views.body.free import FreeBody, moving, polhode_points
from eom.views.body.polhodes import OWN, energy_axes
from eom.views.draw.formulas import plain
from eom.views.draw.meshes import ellipsoid, grid_faces
from eom.views.draw.picture import (
    Arrow,
    Axis,
    Curve,
    Floats,
    Item,
    Marks,
    Panel,
    Picture,
    Surface,
    points,
)

PERIODS = 3.0
"""Periods of the angular velocity that are drawn where no time is asked for."""
FADES = 9.0
"""Time constants of the separatrix before and after its middle that are drawn."""
NEAR = 0.12
"""Sine of an angle between arrows whose letters would meet."""
PER_TURN, FEWEST, MOST = 120, 1200, 24000
"""Points of a herpolhode a turn of the body, at least, at most."""


@dataclass(frozen=True, eq=False)
class Traced:
    """Omega over time: ``body`` (N, 3) along the principal axes, ``space`` (N, 3) along e1, e2, e3.

    ``frame``: (3, 3), the rows e1, e2, e3 in the frame in which attitude is measured; ``first``: the
    rotation (3, 3) from e1, e2, e3 to the principal axes at t = 0; ``t`` (N,) s.
    """

    t: Floats
    body: Floats
    space: Floats
    frame: Floats
    first: Floats


def traced(
    body: FreeBody,
    seconds: float | None = None,
    points: int | None = None,
    periods: float = PERIODS,
) -> Traced:
    """Return omega of a free body over time, in closed form.

    ``seconds``: from t = 0 on; by default some periods, one turn where two moments are equal, and on
    the separatrix from where it leaves the intermediate axis to where it comes back to it.
    """
    start, end = _span(body, seconds, periods)
    fastest = body.momentum / min(body.moments) * (end - start) / (2 * np.pi)
    count = points or int(np.clip(PER_TURN * fastest, FEWEST, MOST))
    t = np.linspace(start, end, count)
    omega, q = body.motion(np.append(t, 0.0))
    C = matrices(q.T)
    in_space = np.einsum("nki,kn->ni", C, omega)
    momentum = C[-1].T @ np.multiply(body.moments, body.omega)
    frame = _frame(momentum, in_space[-1], C[-1])
    space = in_space[:-1] @ frame.T
    return Traced(t, omega.T[:-1], space, frame, C[-1] @ frame.T)


def _frame(momentum: Floats, omega: Floats, C: Floats) -> Floats:
    """Return e1, e2, e3 as rows; where omega is along H, e1 is across H and a body axis."""
    third = momentum / np.linalg.norm(momentum)
    across = omega - (omega @ third) * third
    if np.linalg.norm(across) <= 1e-12 * np.linalg.norm(omega):
        axis = C[int(np.argmin(np.abs(C @ third)))]
        across = axis - (axis @ third) * third
    first = across / np.linalg.norm(across)
    return np.stack([first, np.cross(third, first), third])


def _span(body: FreeBody, seconds: float | None, periods: float) -> tuple[float, float]:
    if seconds is not None:
        return 0.0, seconds
    motion = body.motion
    if motion.kind == "symmetric":
        low, mid, high = sorted(body.moments)
        return 0.0, 2 * np.pi * (low if low == mid else high) / body.momentum
    if motion.kind == "separatrix":
        return _around(body)
    return 0.0, periods * motion.period if motion.period else 1.0


def _around(body: FreeBody) -> tuple[float, float]:
    """Return the times between which the motion on the separatrix is away from the intermediate axis.

    w3 = a3 sech(p (t - t0)), p^2 = d32 C/(I1 I2 I3), and w2 has the sign of t - t0.
    """
    exact = body.polhode
    own = context()
    (_, d32, d31), (I1, I2, I3) = exact.differences, exact.moments
    rate = float(own.sqrt(number(own, d32 * exact.C / (I1 * I2 * I3))))
    a3 = own.sqrt(number(own, exact.C / (I3 * d31)))
    ratio = float(a3 / number(own, exact.omega[2])) if exact.omega[2] else np.inf
    if not np.isfinite(ratio):
        return 0.0, FADES / rate
    passed = (
        float(np.arccosh(max(ratio, 1.0))) / rate * exact.sense * np.sign(float(exact.omega[1]))
    )
    return -passed - FADES / rate, -passed + FADES / rate


def herpolhode(body: FreeBody, seconds: float | None = None, points: int | None = None) -> Picture:
    """Return Poinsot's construction at t = 0 beside the herpolhode, seen along H.

    Parameters
    ----------
    body : FreeBody
        Moments, and where it starts.
    seconds : float, optional
        Of the path, from t = 0 on (s). By default some periods of the angular velocity, one turn
        where two moments are equal, and on the separatrix from where omega leaves the intermediate
        axis to where it comes back.
    points : int, optional
        Of the path, as many as needed unless given.

    Returns
    -------
    Picture
        Axes: omega (rad/s), the third along H. The circles have the exact radii of
        `eom.mechanics.freebody`.

    Raises
    ------
    InputError
        For a body at rest, for moments that no body has, and for a time that is not positive.

    References
    ----------
    Goldstein, Classical Mechanics (2002), sect. 5.6.

    Examples
    --------
    >>> from eom.views.body.free import FreeBody
    >>> handle = FreeBody((1.5e-4, 4.0e-4, 5.2e-4), (0.05, 10.0, 0.05))
    >>> herpolhode(handle, seconds=3.0).caption.split(", ")[-1]
    't = 0 to 3 s.'
    """
    body.turning("herpolhode")
    path = traced(body, _positive(seconds), points)
    caption = (
        "Left: the ellipsoid of inertia rolls without slip on the invariable plane, which it touches "
        "at the tip of the angular velocity; the polhode rolls on the herpolhode. Right: the herpolhode "
        f"seen along the angular momentum, t = {path.t[0]:.4g} to {path.t[-1]:.4g} s."
    )
    return Picture(((_construction(body, path), _plane(body, path)),), plain(body.title), caption)


def _positive(seconds: float | None) -> float | None:
    if seconds is not None and not seconds > 0:
        raise InputError("no time to draw", got=seconds, expected="more than 0 seconds")
    return seconds


def _construction(body: FreeBody, path: Traced) -> Panel:
    """Return the ellipsoid at t = 0 on its plane, seen from e3 below: H points up."""
    turn = path.first  # takes e to principal axes; a row vector times it goes back
    surface = ellipsoid(energy_axes(body), "grey", 0.35, "ellipsoid of inertia")
    solid = Surface(
        surface.vertices @ turn, surface.faces, surface.colour, surface.opacity, surface.label
    )
    exact = body.polhode
    curve = polhode_points(exact) @ turn
    omega = np.array(body.omega) @ turn
    foot = np.array([0.0, 0.0, 2 * body.energy / body.momentum])
    items: list[Item] = [_sheet(body, path, foot[2]), solid]
    if moving(exact):
        items += [
            Curve(curve, "blue", 2.0, label="polhode"),
            Curve(path.space, "green", 1.5, label="herpolhode"),
        ]
    centre = np.zeros(3)
    items += [
        Arrow(centre, clear_of(omega, foot) * 1.3 * foot, "black", 1.8, r"$\mathbf{H}$"),
        Arrow(centre, omega, OWN, 2.0, r"$\mathbf{\omega}$"),
    ]
    axes = tuple(Axis(rf"$\mathbf{{e}}_{k}$ [rad/s]") for k in (1, 2, 3))
    return Panel(tuple(items), axes, "Poinsot's construction", equal=True, bare=True)


def clear_of(omega: Floats, momentum: Floats) -> float:
    """Return how much longer the arrow of H is drawn, so that its letter is clear of that of omega."""
    sine = np.linalg.norm(np.cross(omega, momentum))
    return 1.2 if sine < NEAR * np.linalg.norm(omega) * np.linalg.norm(momentum) else 1.0


def _sheet(body: FreeBody, path: Traced, height: float) -> Surface:
    reach = 1.15 * max(float(np.abs(path.space[:, :2]).max()), float(np.median(energy_axes(body))))
    s = np.linspace(0.0, 2 * np.pi, 73)
    radii = np.linspace(0.0, 1.0, 7)[:, None]
    flat = np.stack([radii * np.cos(s), radii * np.sin(s)], -1).reshape(-1, 2) * reach
    vertices = np.column_stack([flat, np.full(len(flat), height)])
    return Surface(vertices, grid_faces(len(radii), len(s)), "yellow", 0.25, "invariable plane")


def _plane(body: FreeBody, path: Traced) -> Panel:
    found = exact_herpolhode(body.moments, body.omega)
    inner, outer = float(found.inner), float(found.outer)
    s = np.linspace(0.0, 2 * np.pi, 361)
    circle = points(np.cos(s), np.sin(s))
    items: list[Item] = []
    for radius, words in ((outer, "greatest distance"), (inner, "least distance")):
        if radius > 1e-9 * body.momentum / max(body.moments):
            items.append(
                Curve(radius * circle, "grey", 1.0, "dashed", f"{words} {radius:.4g} rad/s")
            )
    flat = path.space[:, :2]
    if moving(body.polhode):
        items.append(Curve(flat, "green", 1.2, label="herpolhode"))
    at = int(np.argmin(np.abs(path.t)))
    items += [
        Marks(flat[[at]], OWN, 6.0, r"$\omega$ at $t = 0$"),
        Marks(np.zeros((1, 2)), "black", 3.5, "foot of $H$"),
    ]
    axes = tuple(Axis(rf"$\omega$ along $\mathbf{{e}}_{k}$ [rad/s]") for k in (1, 2))
    return Panel(tuple(items), axes, "in the invariable plane", equal=True)
