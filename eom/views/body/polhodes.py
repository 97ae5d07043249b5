"""Ellipsoids of constant energy and momentum in the space of omega, and the polhodes on them.

Both are the surfaces of `eom.mechanics.freebody`: omega . J omega = 2 T and |J omega| = H, with semi-axes
sqrt(2 T/I) and H/I. A polhode is where they meet (Hughes, Spacecraft Attitude Dynamics, 1986, ch. 4;
Goldstein, Poole, Safko, 2002, sect. 5.6).

The momentum of a body as the body sees it moves on a sphere, between the separatrices: without loss of
energy on a polhode, with loss from the axis of the least moment to that of the greatest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from eom.errors import InputError
from eom.views.body.free import (
    CLASSES,
    FreeBody,
    class_of,
    family,
    moving,
    polhode_points,
    separatrix,
)
from eom.views.draw.formulas import plain, short
from eom.views.draw.meshes import ellipsoid
from eom.views.draw.picture import (
    Arrow,
    Axis,
    Curve,
    Floats,
    Item,
    Marks,
    Panel,
    Picture,
    Words,
    check,
)

EACH = 4
"""Polhodes of each class, on each of its two sides."""
OWN = "red"
"""Colour of the polhode of the motion itself."""
LONGEST = 6.0
"""Ratio of the axes of an ellipsoid up to which all axes of the picture have the same scale."""
SPREAD = 1e-3
"""How much the length of h may vary, relative."""


def energy_axes(body: FreeBody) -> Floats:
    """Return the semi-axes of the ellipsoid of energy, rad/s."""
    return np.sqrt(2 * body.energy / np.array(body.moments))


def momentum_axes(body: FreeBody) -> Floats:
    """Return the semi-axes of the ellipsoid of momentum, rad/s."""
    return body.momentum / np.array(body.moments)


def polhodes(body: FreeBody) -> Picture:
    """Return the ellipsoids of momentum and energy, each with polhodes of all classes and the separatrix.

    Parameters
    ----------
    body : FreeBody
        Moments, and where it starts.

    Returns
    -------
    Picture
        On the left all motions have the momentum of this one and different energies; on the right
        its energy and different momenta. Axes: omega (rad/s) along the principal axes. The motion's
        own polhode is drawn thick, with a dot where it starts.

    Raises
    ------
    InputError
        For a body at rest and for moments that no body has.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), ch. 4.

    Examples
    --------
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
        f"momentum (left) and of constant kinetic energy (right). {_caption(body)}"
    )
    return Picture(((left, right),), plain(body.title), caption)


def ellipsoids(body: FreeBody) -> Picture:
    """Return the ellipsoids of momentum and energy of one motion, and its polhode, where they meet.

    Parameters
    ----------
    body : FreeBody
        Moments, and where it starts, as of `polhodes`.

    Returns
    -------
    Picture
        Two surfaces and the curve; axes (rad/s), as of `polhodes`.

    Raises
    ------
    InputError
        As of `polhodes`.

    Examples
    --------
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
    caption = f"The polhode is where both ellipsoids meet. {_caption(body)}"
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
    exact = body.polhode
    start = Marks(
        np.array([body.omega]), OWN, 7.0, "" if moving(exact) else f"this motion: {_kind(body)}"
    )
    if not moving(exact):
        return [start]
    return [Curve(polhode_points(exact), OWN, 3.0, label=f"this motion: {_kind(body)}"), start]


def _kind(body: FreeBody) -> str:
    exact = body.polhode
    return CLASSES[class_of(exact)].words if moving(exact) else "constant angular velocity"


def _caption(body: FreeBody) -> str:
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


def momentum_path(moments: ArrayLike, h: ArrayLike, title: str = "") -> Picture:
    """Return the path of the tip of h in the body, on the sphere of its length.

    Parameters
    ----------
    moments : array
        Principal moments, of all that turns together at the end (kg m^2).
    h : array
        Angular momentum, components along the principal axes (N m s), shape (N, 3), of constant
        length.
    title : str, optional
        Above the picture.

    Returns
    -------
    Picture
        The sphere with the path. Circles are the separatrix: there the energy is that of spin about
        the intermediate axis; with two equal moments there is none.

    Raises
    ------
    InputError
        For other shapes, for fewer than two places, and where the length of h is not constant.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), ch. 5.

    Examples
    --------
    >>> import numpy as np
    >>> angle = np.linspace(0.0, 1.0, 11)
    >>> path = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    >>> [axis.words for axis in momentum_path((1.0, 2.0, 3.0), path).rows[0][0].axes]
    ['$h_1$ [N m s]', '$h_2$ [N m s]', '$h_3$ [N m s]']
    """
    own, path, size = _checked(moments, h)
    items: list[Item] = [
        ellipsoid((size, size, size), "grey", 0.25),
        Curve(path, "blue", 1.3, label=r"tip of $\mathbf{h}$ in the body"),
    ]
    for k, circle in enumerate(separatrices(own)):
        items.append(Curve(size * circle, "black", 1.2, label="" if k else "separatrix"))
    items += [Marks(path[:1], "orange", 7.0, "start"), Marks(path[-1:], "red", 7.0, "end")]
    axes = tuple(Axis(f"$h_{k}$ [N m s]") for k in (1, 2, 3))
    caption = (
        "The angular momentum as the body sees it, on the sphere of its length; black circles part the "
        "motions about the axis of the least moment from those about the axis of the greatest."
    )
    panel = Panel(tuple(items), axes, equal=True)
    return check(Picture(((panel,),), short(title), caption))


def _checked(moments: ArrayLike, h: ArrayLike) -> tuple[Floats, Floats, float]:
    """Return moments, path and length of h. Raises `InputError` as `momentum_path`."""
    own, path = np.asarray(moments, dtype=np.float64), np.asarray(h, dtype=np.float64)
    if own.shape != (3,) or path.ndim != 2 or path.shape[1] != 3 or len(path) < 2:
        raise InputError(
            "unusable shapes",
            where="momentum_path",
            got=f"moments {own.shape}, h {path.shape}",
            expected="(3,), and (N, 3) with N of at least 2",
        )
    sizes = np.linalg.norm(path, axis=1)
    if not (np.all(np.isfinite(path)) and 0 < np.max(sizes) <= (1 + SPREAD) * np.min(sizes)):
        got = f"lengths from {np.min(sizes):.6g} to {np.max(sizes):.6g} N m s"
        raise InputError("the length of h is not constant", where="momentum_path", got=got)
    return own, path, float(sizes[0])


def separatrices(moments: Floats) -> tuple[Floats, ...]:
    """Return two great circles, shape (N, 3) each, on which T = H^2/(2 I) with the intermediate moment I.

    They are the momenta on the separatrix of omega. None where two moments are equal.
    """
    middle = np.sort(moments)[1]
    a, b, c = (float(m) for m in moments)
    return tuple(moments * w / middle for w in separatrix((a, b, c), 1.0))
