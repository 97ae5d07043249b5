"""The angular momentum of a free body as the body sees it: a path on a sphere, between the separatrices.

Without loss of energy the path is a polhode; with loss it leads from the axis of the least moment to
that of the greatest (Hughes, Spacecraft Attitude Dynamics, 1986, ch. 5).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from eom.errors import InputError
from eom.views.draw.lettering import plain
from eom.views.draw.meshes import ellipsoid
from eom.views.draw.picture import Axis, Curve, Floats, Item, Marks, Panel, Picture, check

AROUND = 241
"""Points of a circle."""
SPREAD = 1e-3
"""How much the length of h may vary, relative."""


def momentum_path(moments: ArrayLike, h: ArrayLike, title: str = "") -> Picture:
    """Return the path of the tip of h in the body, on the sphere of its length.

    ``moments``: principal moments, of all that turns together at the end (kg m^2); ``h``: components
    along the principal axes (N m s), shape (N, 3). Circles are the separatrix: there the energy is that of
    spin about the intermediate axis; with two equal moments there is none. Raises `InputError` for other
    shapes, for fewer than two places, and where the length of h is not constant. Source: Hughes,
    Spacecraft Attitude Dynamics (1986), ch. 5.

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
    return check(Picture(((panel,),), plain(title), caption))


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

    There h_least^2 (1/I_least - 1/I) = h_greatest^2 (1/I - 1/I_greatest). None where two moments are equal.
    """
    least, middle, greatest = np.argsort(moments, kind="stable")
    low, mid, high = 1 / moments[[least, middle, greatest]]
    if mid in {low, high}:
        return ()
    angle = np.linspace(0.0, 2 * np.pi, AROUND)
    found = []
    for sign in (1.0, -1.0):
        across = np.zeros(3)
        across[least], across[greatest] = np.sqrt(mid - high), sign * np.sqrt(low - mid)
        along = np.zeros(3)
        along[middle] = 1.0
        unit = across / np.linalg.norm(across)
        found.append(np.outer(np.cos(angle), unit) + np.outer(np.sin(angle), along))
    return tuple(found)
