"""A torque-free body for pictures: its data from a scene or numbers, and its polhodes, exactly.

Angular velocities are in rad/s, in components along the principal axes, moments in kg m^2. A polhode is
(Whittaker, Analytical Dynamics, 4th ed. (1937), sec. 69; letters as in `codegen.closed.polhode`)

    w1 = a1 cos s,  w2 = a2 sin s,  w3 = a3 sqrt(cos^2 s + m1 sin^2 s),  0 <= s < 2 pi

in the frame P of `codegen.closed.polhode`: a curve that needs no time and no integration. On the separatrix
m1 = 0, and it is two ellipses in planes through p2.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from codegen.closed.exact import free_motion, kind_of
from codegen.closed.polhode import Polhode, context, number, polhode, root
from eom.errors import InputError
from eom.views.animation.bodies import single
from eom.views.body.frame_sketches import elementary
from eom.views.draw.picture import Floats

if TYPE_CHECKING:
    from codegen.closed.exact import FreeMotion
    from eom.opening import AnyScene
    from eom.scenes.scene import Scene

Triple = tuple[float, float, float]
Four = tuple[float, float, float, float]
COUNT = 720
"""Points of a polhode; divisible by four, so that its extremes are among them."""


@dataclass(frozen=True)
class Class:
    """A class of polhodes: what it is in words, and its colour in all pictures."""

    words: str
    colour: str


CLASSES = {
    1: Class("about the axis of greatest moment", "blue"),
    -1: Class("about the axis of least moment", "orange"),
    0: Class("separatrix", "black"),
}
"""Classes by the sign of H^2 - 2 T I, I the intermediate moment."""


@dataclass(frozen=True)
class FreeBody:
    """A torque-free body at t = 0.

    Parameters
    ----------
    moments : three expressions
        The three principal ones, kg m^2.
    omega : three expressions
        Angular velocity along these axes, rad/s.
    attitude : four numbers, optional
        Unit quaternion of the principal axes, scalar first, C_BI as in `codegen.closed.exact`.
    title : str, optional
        Of the scene.
    letter : str, default "b"
        b where the principal axes are those of the body, p where they are not.

    Raises
    ------
    InputError
        For moments that no body has and rates that are not finite, where they are used.
    """

    moments: Triple
    omega: Triple
    attitude: Four = (1.0, 0.0, 0.0, 0.0)
    title: str = field(default="", compare=False)
    letter: str = field(default="b", compare=False)

    @property
    def motion(self) -> FreeMotion:
        """The motion in closed form."""
        return free_motion(self.moments, self.omega, self.attitude)

    @property
    def polhode(self) -> Polhode:
        """The exact data of its polhode; see `codegen.closed.polhode.polhode`."""
        return polhode(self.moments, self.omega)

    @property
    def energy(self) -> float:
        """Kinetic energy T, J."""
        return float(sum(I * w * w for I, w in zip(self.moments, self.omega, strict=True)) / 2)

    @property
    def momentum(self) -> float:
        """Size H of the angular momentum, N m s."""
        return float(np.linalg.norm(np.multiply(self.moments, self.omega)))

    def axis(self, k: int) -> str:
        """Return the letter of an axis.

        Parameters
        ----------
        k : int
            1, 2 or 3.

        Returns
        -------
        str
            A formula.
        """
        return rf"$\mathbf{{{self.letter}}}_{k}$"

    @property
    def axes_words(self) -> tuple[str, str, str]:
        """Words of the axes of the space of omega."""
        a, b, c = (rf"$\omega_{k}$ [rad/s]" for k in (1, 2, 3))
        return a, b, c

    def turning(self, what: str) -> FreeBody:
        """Return the body itself, if it turns.

        Parameters
        ----------
        what : str
            The picture that asks, for messages.

        Returns
        -------
        FreeBody
            The body as it is.

        Raises
        ------
        InputError
            For a body at rest and for moments that no body has.
        """
        if not any(self.motion.body.omega):
            raise InputError(
                f"the body is at rest: it has no {what}",
                where=self.title,
                got="omega = 0",
                expected="an angular velocity",
            )
        return self


def free_body(scene: AnyScene, what: str) -> FreeBody:
    """Return the free body of ``scene``, for a picture of ``what``.

    Parameters
    ----------
    scene : Scene or TreeScene
        Of one body without a torque, with initial rates.
    what : str
        The picture that asks, for messages.

    Returns
    -------
    FreeBody
        Moments, rates and attitude are those of the principal axes, which are the body's own if
        these are principal; units and frames as of `FreeBody`.

    Raises
    ------
    InputError
        Says why there is none: a tree of bodies, a torque, no initial rates, rest.

    Examples
    --------
    >>> import eom
    >>> free_body(eom.load_scene("t-handle"), "polhode").moments
    (0.00015, 0.0004, 0.00052)
    """
    one = single(scene)
    if (reason := not_free(scene)) or one is None:
        raise InputError(f"no {what} of this scene: {reason}", where=scene.title or scene.name)
    body = _spinner(one) if one.model == "spinner" else _rigid(one)
    return body.turning(what)


def not_free(scene: AnyScene) -> str:
    """Return why a scene is no torque-free body; empty if it is one."""
    one = single(scene)
    if one is None:
        return "it is a tree of bodies, and this is about one free body"
    torque = one.torque
    if torque.weight is not None:
        return "a weight turns it, and this is about torque-free motion"
    if torque.gravity_gradient is not None:
        return "gravity turns it, and this is about torque-free motion"
    if any(c not in {0, "0"} for c in torque.components or ()):
        return "a torque acts on it, and this is about torque-free motion"
    return ""


def _rigid(scene: Scene) -> FreeBody:
    from eom.rotations import quaternion_of_matrix
    from eom.scenes.conventions import attitude_at_start
    from eom.scenes.description import inertia_values, principal_values
    from eom.scenes.start import pick, states

    known = states(scene, scene.full_system)
    names = ("omega_1", "omega_2", "omega_3")
    omega = np.array([*pick(known, names, "initial value", "[initial]").values()])
    attitude = np.eye(3) if scene.attitude == "none" else np.array(attitude_at_start(scene))
    matrix = inertia_values(scene)
    if matrix is None:
        return _made(principal_values(scene), omega, quaternion_of_matrix(_rows(attitude)), scene)
    moments, C = principal(np.array(matrix))
    turned = quaternion_of_matrix(_rows(C @ attitude))
    return _made(moments, C @ omega, turned, scene, "p")


def _made(moments: object, omega: Floats, q: Four, scene: Scene, letter: str = "b") -> FreeBody:
    a, b, c = (float(v) for v in np.asarray(moments))
    x, y, z = (float(v) for v in omega)
    return FreeBody((a, b, c), (x, y, z), q, scene.title or scene.name, letter)


def _rows(C: Floats) -> tuple[Triple, Triple, Triple]:
    a, b, c = ((float(x), float(y), float(z)) for x, y, z in C)
    return a, b, c


def principal(J: Floats) -> tuple[Floats, Floats]:
    """Return principal moments by rising size and the rotation C to their axes, C J C^T diagonal."""
    moments, columns = np.linalg.eigh(J)
    C = columns.T * np.where(columns.T[:, [0]] < 0, -1.0, 1.0)
    C[2] = np.cross(C[0], C[1])
    return moments, C


def _spinner(scene: Scene) -> FreeBody:
    """Return the 3-1-2 spinner without torque; its rates are along the frame B before the spin angle."""
    from eom.rotations import quaternion_of_matrix
    from eom.scenes.conventions import attitude_at_start
    from eom.scenes.description import principal_values
    from eom.scenes.start import pick, states

    known = {"phi": 0.0, "psi": 0.0, **states(scene, scene.full_system)}
    names = ("theta", "phi", "theta_dot", "psi_dot", "C")
    theta, phi, tilting, turning, spin = pick(known, names, "initial value", "[initial]").values()
    first, axial = principal_values(scene)[:2]
    in_B = np.array([tilting, spin, turning * np.cos(theta)])
    omega = elementary(2, phi) @ in_B
    attitude = quaternion_of_matrix(attitude_at_start(scene))
    return _made((first, axial, first), omega, attitude, scene)


def class_of(body: Polhode) -> int:
    """Return the sign of H^2 - 2 T I of the intermediate axis, exactly; see `CLASSES`."""
    return body.sense if body.A else 0


def moving(body: Polhode) -> bool:
    """Return whether the angular velocity moves in the body at all."""
    return kind_of(body).name not in {"rest", "spherical", "steady"}


def polhode_points(body: Polhode, count: int = COUNT) -> Floats:
    """Return a polhode as points (count + 1, 3), closed, right to rounding; one point in steady spin.

    On the separatrix it is the branch along which the motion goes, from one end to the other.
    """
    if not moving(body):
        return np.array([[float(w) for w in body.frame.listed(body.omega)]])
    own = context()
    (_, d32, d31), (I1, I2, I3) = body.differences, body.moments
    squares = body.B / (I1 * d31), body.B / (I2 * d32), body.C / (I3 * d31)
    a1, a2, a3 = (float(root(own, s)) for s in squares)
    m1 = float(number(own, d31 * body.A / (d32 * body.C)))
    half = np.pi if body.A else np.pi / 2
    s = np.linspace(-half, half, count + 1)
    cosine, sine = np.cos(s), np.sin(s)
    w = np.stack([a1 * cosine, a2 * sine, a3 * np.sqrt(cosine**2 + m1 * sine**2)])
    return np.asarray(body.frame.to_body(w)).T


def separatrix(moments: Triple, level: float, count: int = COUNT) -> tuple[Floats, ...]:
    """Return the separatrix through (0, ``level``, 0) of the intermediate axis: two closed curves.

    ``level``: rad/s; points (count + 1, 3). None where two moments are equal.
    """
    low, mid, high = np.argsort(moments, kind="stable")
    I1, I2, I3 = (float(moments[k]) for k in (low, mid, high))
    if not I1 < I2 < I3:
        return ()
    s = np.linspace(0.0, 2 * np.pi, count + 1)
    a1 = level * np.sqrt(I2 * (I3 - I2) / (I1 * (I3 - I1)))
    a3 = level * np.sqrt(I2 * (I2 - I1) / (I3 * (I3 - I1)))
    found = []
    for sign in (1.0, -1.0):
        w = np.empty((len(s), 3))
        w[:, low], w[:, mid], w[:, high] = a1 * np.cos(s), level * np.sin(s), sign * a3 * np.cos(s)
        found.append(w)
    return tuple(found)


def family(moments: Triple, semi_axes: Floats, each: int) -> tuple[Polhode, ...]:
    """Return polhodes on an ellipsoid with ``semi_axes`` (rad/s): ``each`` in number of both classes.

    They start on the arcs from the axes of greatest and of least moment to the intermediate one, and
    stand for their mirror images, too. None of a class whose axis is one of two equal moments.
    """
    low, mid, high = (int(k) for k in np.argsort(moments, kind="stable"))
    found = []
    for axis in (high, low):
        if moments[axis] == moments[mid]:
            continue
        for k in range(1, each + 1):
            angle = np.pi / 2 * k / (each + 0.6)
            w = np.zeros(3)
            w[axis], w[mid] = semi_axes[axis] * np.cos(angle), semi_axes[mid] * np.sin(angle)
            found.append(polhode(moments, [float(x) for x in w]))
    return tuple(found)
