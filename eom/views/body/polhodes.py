"""Ellipsoids of constant energy and momentum in the space of omega, and the polhodes on them.

Both are the surfaces of `eom.mechanics.freebody`: omega . J omega = 2 T and |J omega| = H, with semi-axes
sqrt(2 T/I) and H/I. A polhode is where they meet (Hughes, Spacecraft Attitude Dynamics, 1986, ch. 4;
Goldstein, Poole, Safko, 2002, sect. 5.6).
"""

from __future__ import annotations

import numpy as np

from eom.views.body.free import (
    CLASSES,
    FreeBody,
    class_of,
    family,
    moving,
    polhode_of,
    polhode_points,
    separatrix,
)
from eom.views.draw.formulas import plain
from eom.views.draw.meshes import ellipsoid
from eom.views.draw.picture import Arrow, Axis, Curve, Floats, Item, Marks, Panel, Picture, Words

EACH = 4
"""Polhodes of each class, on each of its two sides."""
OWN = "red"
"""Colour of the polhode of the motion itself."""
LONGEST = 6.0
"""Ratio of the axes of an ellipsoid up to which all axes of the picture have the same scale."""


def energy_axes(body: FreeBody) -> Floats:
    """Return the semi-axes of the ellipsoid of energy, rad/s."""
    return np.sqrt(2 * body.energy / np.array(body.moments))


def momentum_axes(body: FreeBody) -> Floats:
    """Return the semi-axes of the ellipsoid of momentum, rad/s."""
    return body.momentum / np.array(body.moments)


def polhodes(body: FreeBody) -> Picture:
    """Return the ellipsoids of momentum and energy, each with polhodes of all classes and the separatrix.

    ``body``: moments, and where it starts; axes: omega (rad/s) along the principal axes. On the left all
    motions have the momentum of this one and different energies; on the right its energy and different
    momenta. The motion's own polhode is drawn thick, with a dot where it starts.
    Source: Hughes, Spacecraft Attitude Dynamics (1986), ch. 4. Raises `InputError` for a body at rest and
    for moments that no body has.

    >>> from eom.views.body.free import FreeBody
    >>> handle = FreeBody((1.5e-4, 4.0e-4, 5.2e-4), (0.05, 10.0, 0.05))
    >>> [panel.title for panel in polhodes(handle).rows[0]]
    ['same momentum $H$', 'same energy $T$']
    """
    body.turning("polhode")
    left = _family_panel(body, momentum_axes(body), "same momentum $H$")
    right = _family_panel(body, energy_axes(body), "same energy $T$")
    caption = (
        "Paths of the angular velocity in the body (polhodes), on the ellipsoid of constant angular "
        f"momentum (left) and of constant kinetic energy (right). {_told(body)}"
    )
    return Picture(((left, right),), plain(body.title), caption)


def ellipsoids(body: FreeBody) -> Picture:
    """Return the ellipsoids of momentum and energy of one motion, and its polhode, where they meet.

    ``body``, axes (rad/s), source and errors as of `polhodes`.

    >>> from eom.views.body.free import FreeBody
    >>> handle = FreeBody((1.5e-4, 4.0e-4, 5.2e-4), (0.05, 10.0, 0.05))
    >>> ellipsoids(handle).caption.split(". ")[0]
    'The polhode is where both ellipsoids meet'
    """
    body.turning("polhode")
    items: list[Item] = [
        ellipsoid(momentum_axes(body), "sky", 0.35, "momentum ellipsoid"),
        ellipsoid(energy_axes(body), "grey", 0.35, "energy ellipsoid"),
        *_own(body),
        *_letters(body, np.maximum(momentum_axes(body), energy_axes(body))),
    ]
    panel = _panel(body, items, "", np.maximum(momentum_axes(body), energy_axes(body)))
    caption = f"The polhode is where both ellipsoids meet. {_told(body)}"
    return Picture(((panel,),), plain(body.title), caption)


def _family_panel(body: FreeBody, semi_axes: Floats, title: str) -> Panel:
    mid = int(np.argsort(body.moments, kind="stable")[1])
    items: list[Item] = [ellipsoid(semi_axes, "grey", 0.3)]
    for one in family(body.moments, semi_axes, EACH):
        look = CLASSES[class_of(one)]
        curve = polhode_points(one)
        items += [Curve(side * curve, look.colour, 1.1, label=look.words) for side in (1, -1)]
    for curve in separatrix(body.moments, float(semi_axes[mid])):
        items.append(Curve(curve, CLASSES[0].colour, 1.6, label=CLASSES[0].words))
    items += [*_resting(body, semi_axes), *_own(body), *_letters(body, semi_axes)]
    return _panel(body, items, title, semi_axes)


def _panel(body: FreeBody, items: list[Item], title: str, semi_axes: Floats) -> Panel:
    axes = tuple(Axis(words) for words in body.axes_words)
    return Panel(tuple(items), axes, title, equal=_equal(semi_axes))


def _equal(semi_axes: Floats) -> bool:
    return bool(semi_axes.max() <= LONGEST * semi_axes.min())


def _resting(body: FreeBody, semi_axes: Floats) -> list[Item]:
    """Return what consists of single points: rates that stay as they are, beside the axes."""
    order = np.argsort(body.moments, kind="stable")
    low, mid, high = (body.moments[k] for k in order)
    if low == high or mid not in {low, high}:
        return []
    i, j = (int(k) for k in (order[:2] if low == mid else order[1:]))
    s = np.linspace(0.0, 2 * np.pi, 181)
    circle = np.zeros((len(s), 3))
    circle[:, i], circle[:, j] = semi_axes[i] * np.cos(s), semi_axes[j] * np.sin(s)
    return [Curve(circle, "black", 1.2, "dotted", "steady spin, each point by itself")]


def _own(body: FreeBody) -> list[Item]:
    exact = polhode_of(body.moments, body.omega)
    start = Marks(
        np.array([body.omega]), OWN, 7.0, "" if moving(exact) else f"this motion: {_kind(body)}"
    )
    if not moving(exact):
        return [start]
    return [Curve(polhode_points(exact), OWN, 3.0, label=f"this motion: {_kind(body)}"), start]


def _kind(body: FreeBody) -> str:
    exact = polhode_of(body.moments, body.omega)
    return CLASSES[class_of(exact)].words if moving(exact) else "constant angular velocity"


def _told(body: FreeBody) -> str:
    a, b, c = body.moments
    return (
        f"This motion: {_kind(body)}; moments of inertia {a:.4g}, {b:.4g}, {c:.4g} kg m^2, "
        f"T = {body.energy:.4g} J, H = {body.momentum:.4g} N m s."
    )


def _letters(body: FreeBody, semi_axes: Floats) -> list[Item]:
    """Return the axes of the body from from a surface on; letters alone on unequal scales."""
    places, names = np.diag(semi_axes), [body.axis(k) for k in (1, 2, 3)]
    if not _equal(semi_axes):
        return [Words(1.15 * place, name) for place, name in zip(places, names, strict=True)]
    ends = np.diag(semi_axes + 0.2 * semi_axes.max())
    rows = zip(places, ends, names, strict=True)
    return [Arrow(start, end, "black", 1.2, name) for start, end, name in rows]
