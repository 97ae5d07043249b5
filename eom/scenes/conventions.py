"""One attitude and inertia in the conventions of different books.

The house's own, `HOUSE`: C takes components in the reference axes to those in the body's; angles turn
about body axes; quaternions have the scalar first; products of inertia stand in the inertia matrix
with a minus sign. Reference axes are east, north, up; body axes forward, left, up. Numbers are floats;
angles are in radians.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import sympy as sp

from eom.errors import InputError, near_matches, typed, unknown_name
from eom.kinematics.coordinates import SEQUENCES, attitude, quaternion_of_sequence
from eom.rotations import (
    ALMOST,
    Matrix,
    Quaternion,
    Row,
    angles_of_matrix,
    determinant,
    dot,
    matrix_of,
    matrix_of_quaternion,
    product,
    quaternion_of_matrix,
    transpose,
)
from eom.scenes.description import inertia_values, of_norm_one, principal_values
from eom.scenes.start import pick, states

if TYPE_CHECKING:
    from eom.scenes.scene import Scene

CHOICES: dict[str, dict[str, str]] = {
    "direction": {
        "passive": "the matrix takes components in the reference axes to components in the body's",
        "active": "the matrix takes components in the body's axes to components in the reference axes",
    },
    "order": {
        "body": "each angle turns about an axis of the body, as turned so far",
        "space": "each angle turns about an axis that stays where it is",
    },
    "scalar": {
        "first": "quaternions have the scalar part first",
        "last": "quaternions have the scalar part last",
    },
    "products": {
        "minus": "entries beside the diagonal of the inertia matrix are minus the integrals of x y dm",
        "plus": "entries beside the diagonal of the inertia matrix are the integrals of x y dm",
    },
}
"""What may be chosen, and what it means."""

REFERENCE_AXES = {"e": (1, 0, 0), "n": (0, 1, 0), "u": (0, 0, 1)}
BODY_AXES = {"f": (1, 0, 0), "l": (0, 1, 0), "u": (0, 0, 1)}
OPPOSITE = {"w": "e", "s": "n", "d": "u", "b": "f", "r": "l"}


def axes(letters: str, known: Mapping[str, Sequence[float]], what: str) -> Matrix:
    """Return the matrix that takes components in the house's axes to those in the axes by letters."""
    rows = []
    for letter in letters:
        unit = known.get(OPPOSITE.get(letter, letter), ())
        rows.append(tuple((-1.0 if letter in OPPOSITE else 1.0) * x for x in unit))
    if len(rows) != 3 or not all(rows) or determinant(rows) != 1:
        opposite = [o for o, letter in OPPOSITE.items() if letter in known]
        raise InputError(
            "no right-handed system of axes",
            where=what,
            got=repr(letters),
            expected=f"three of the letters {', '.join([*known, *opposite])}, right-handed",
        )
    return matrix_of(rows)


@dataclass(frozen=True)
class Convention:
    """How attitudes and inertias are written: a row of each of `CHOICES`, and two systems of axes.

    Parameters
    ----------
    direction : str, default "passive"
        ``passive`` (C takes components in the reference axes to those in the body's) or ``active``
        (its transpose).
    order : str, default "body"
        Whether angles turn about axes of the ``body``, or of ``space``.
    scalar : str, default "first"
        ``first`` or ``last`` in quaternions.
    products : str, default "minus"
        Of inertia, ``minus`` or ``plus`` the integrals beside the diagonal.
    reference : str, default "enu"
        Three of the letters e, w, n, s, u, d (east, ..., down), right-handed.
    body : str, default "flu"
        Three of f, b, l, r, u, d (forward, ..., down), right-handed.
    sequence : str, default "3-2-1"
        Of the angles.

    Raises
    ------
    InputError
        For others.
    """

    direction: str = "passive"
    order: str = "body"
    scalar: str = "first"
    products: str = "minus"
    reference: str = "enu"
    body: str = "flu"
    sequence: str = "3-2-1"

    def __post_init__(self) -> None:
        for name, allowed in CHOICES.items():
            if getattr(self, name) not in allowed:
                raise unknown_name(name, getattr(self, name), allowed, "convention")
        axes(self.reference, REFERENCE_AXES, "reference axes")
        axes(self.body, BODY_AXES, "body axes")
        if self.sequence not in SEQUENCES:
            raise unknown_name("rotation sequence", self.sequence, SEQUENCES, "convention")

    def words(self) -> tuple[str, ...]:
        """Return what it means, a sentence each."""
        return tuple(meanings[getattr(self, name)] for name, meanings in CHOICES.items())


HOUSE = Convention()

BOOKS: dict[str, tuple[str, Convention]] = {
    "eom": ("this project", HOUSE),
    "hughes": ("Hughes, Spacecraft Attitude Dynamics", Convention(scalar="last")),
    "schaub-junkins": ("Schaub, Junkins, Analytical Mechanics of Space Systems", HOUSE),
    "goldstein": ("Goldstein, Classical Mechanics", Convention(sequence="3-1-3")),
    "kane": (
        "Kane, Likins, Levinson, Spacecraft Dynamics",
        Convention(direction="active", scalar="last"),
    ),
    "wertz": (
        "Wertz, Spacecraft Attitude Determination and Control",
        Convention(scalar="last", sequence="3-1-3"),
    ),
    "markley-crassidis": (
        "Markley, Crassidis, Fundamentals of Spacecraft Attitude Determination",
        Convention(scalar="last"),
    ),
    "diebel": ("Diebel, Representing Attitude", Convention(sequence="1-2-3")),
    "aircraft": ("north, east, down; yaw, pitch, roll", Convention(reference="ned", body="frd")),
    "siciliano": ("Siciliano et al., Robotics", Convention(direction="active")),
    "ros": (
        "Robot Operating System: roll, pitch, yaw about fixed axes",
        Convention(direction="active", order="space", scalar="last", sequence="1-2-3"),
    ),
    "scipy": (
        "scipy.spatial.transform.Rotation, capital letters",
        Convention(direction="active", scalar="last"),
    ),
}
"""Conventions by name, each with the book or program that it is of."""


@typed
def book(name: str) -> Convention:
    """Return the convention of a book or program, by its ``name`` in `BOOKS`.

    Parameters
    ----------
    name : str
        A key of `BOOKS`.

    Returns
    -------
    Convention
        Which way its rotations go, in which order and about which axes they are counted.

    Raises
    ------
    InputError
        For other names.

    Examples
    --------
    >>> book("hughes").scalar
    'last'
    """
    if name not in BOOKS:
        raise unknown_name("convention", name, BOOKS)
    return BOOKS[name][1]


@dataclass(frozen=True)
class Stated:
    """An attitude, an inertia and an angular velocity as a book has them.

    Parameters
    ----------
    convention : Convention
        In which all is told.
    matrix : sequence of sequence of floats
        (3, 3).
    quaternion : four numbers
        Of unit norm.
    angles : three numbers
        In radians, of the convention's sequence.
    inertia : sequence of sequence of floats, optional
        ``inertia`` in kg m^2, (3, 3), in the body's axes; None where it was not given.
    omega : three numbers, optional
        In rad/s, in the body's axes; None where it was not given.
    """

    convention: Convention
    matrix: Matrix
    quaternion: Quaternion
    angles: Row
    inertia: Matrix | None = None
    omega: Row | None = None


def attitude_of_matrix(rows: Sequence[Sequence[float]], convention: Convention = HOUSE) -> Matrix:
    """Return C, in the house's convention, of a matrix in another.

    Parameters
    ----------
    rows : sequence of sequence of floats
        Three of three numbers, which have no unit.
    convention : Convention, optional
        What the matrix does, and between which axes; the house's unless given.

    Returns
    -------
    list of list of floats
        C, as rows; it takes components in the reference axes (east, north, up) to components in the
        body's (forward, left, up).

    Raises
    ------
    InputError
        For what is no rotation, to 1e-9.

    Examples
    --------
    >>> attitude_of_matrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]], book("siciliano"))[0]  # active
    (0.0, 1.0, 0.0)
    """
    if [len(row) for row in rows] != [3, 3, 3]:
        raise InputError("a matrix has three rows of three", where="matrix")
    given = matrix_of(rows)
    gram = product(given, transpose(given))
    off = max(abs(gram[i][k] - (i == k)) for i in range(3) for k in range(3))
    if not off <= ALMOST:
        raise InputError(
            "the matrix is no rotation",
            where="matrix",
            got=f"rows whose scalar products are off by {off:.3g}",
            expected="orthonormal rows",
        )
    if determinant(given) < 0:
        raise InputError(
            "the matrix is no rotation", where="matrix", got="determinant -1, a reflection",
            expected="determinant 1",
        )  # fmt: skip
    passive = transpose(given) if convention.direction == "active" else given
    return _in_axes(passive, convention, back=True)


def attitude_of_quaternion(q: Sequence[float], convention: Convention = HOUSE) -> Matrix:
    """Return C, in the house's convention, of a unit quaternion.

    Parameters
    ----------
    q : sequence of floats
        Four numbers of a unit quaternion, scalar first or last as the convention says.
    convention : Convention, optional
        The order of components, and what the rotation does; the house's unless given.

    Returns
    -------
    list of list of floats
        C as of `attitude_of_matrix`.

    Raises
    ------
    InputError
        For a norm that is not 1, to 1e-9 or to the rounding of its decimals.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), sect. 2.2; Shuster, J. Astronaut. Sci. 41 (1993)
    439.

    Examples
    --------
    >>> attitude_of_quaternion((0, 0, 1, 0), book("hughes"))[0]  # half a turn about axis 3
    (-1.0, 0.0, 0.0)
    """
    if len(q) != 4:
        raise InputError("a quaternion has four components", where="quaternion", got=len(q))
    unit = of_norm_one(q, "quaternion")
    s, *v = (unit[3], *unit[:3]) if convention.scalar == "last" else unit
    return _in_axes(matrix_of_quaternion([s, *v]), convention, back=True)


def attitude_of_angles(angles: Sequence[float], convention: Convention = HOUSE) -> Matrix:
    """Return C, in the house's convention, of three ``angles`` (rad) of the convention's sequence.

    Parameters
    ----------
    angles : sequence of floats
        Three ``angles`` (rad) of the convention's sequence, in its order.
    convention : Convention, optional
        Whether the angles turn about axes of the body or of space; the house's unless given.

    Returns
    -------
    list of list of floats
        C as of `attitude_of_matrix`.

    Raises
    ------
    InputError
        For other than three finite angles.

    Notes
    -----
    With the house's convention the angles turn about axes of the body.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), ch. 2.

    Examples
    --------
    >>> [round(x, 6) for x in attitude_of_angles((0.1, 0, 0))[0]]  # about axis 3
    [0.995004, 0.099833, 0.0]
    """
    if len(angles) != 3 or not all(map(math.isfinite, angles)):
        raise InputError("three finite angles are needed", where="angles", got=list(angles))
    sequence, about_body = convention.sequence, list(angles)
    if convention.order == "space":
        sequence, about_body = sequence[::-1], about_body[::-1]
    C = matrix_of_quaternion(quaternion_of_sequence(sequence, about_body))
    return _in_axes(C, convention, back=True)


def attitude_at_start(scene: Scene) -> Matrix:
    """Return C, in the house's convention, of a scene at t = 0.

    The spin angle of a spinner, on which nothing depends, is taken as zero unless it is given. Raises
    `InputError` where the scene has no attitude.
    """
    name = "3-1-2" if scene.model == "spinner" else scene.coordinates
    if name == "none":
        raise InputError(
            "the scene has no attitude",
            where=scene.name,
            hint='set attitude = "quaternion", or angles',
        )
    spin = {"phi": 0.0} if scene.model == "spinner" else {}
    known = spin | states(scene, scene.full_system)
    written = attitude(name)
    values = pick(known, [c.name for c in written.coordinates], "initial value", "[initial]")
    numbers = {c.symbol: sp.Float(values[c.name]) for c in written.coordinates}
    C = written.matrix.xreplace(numbers)
    return matrix_of([[float(x) for x in C.row(i)] for i in range(3)])


def of_scene(scene: Scene, convention: Convention) -> Stated:
    """Return a scene's attitude at t = 0, its inertia and its angular velocity in a convention.

    Parameters
    ----------
    scene : Scene
        With an attitude, and with initial values.
    convention : Convention
        In which its attitude is told.

    Returns
    -------
    Stated
        At t = 0. The inertia is about the point that the scene's equations are about; units and
        axes as of `Stated`.

    Raises
    ------
    InputError
        For a scene without attitude, and for missing or impossible initial values.

    Examples
    --------
    >>> from eom.scenes.scene import Scene
    >>> of_scene(Scene.ready("bicycle-wheel"), book("hughes")).angles[0]
    0.0
    """
    known = states(scene, scene.full_system)
    full = inertia_values(scene)
    if full is None:
        moments = principal_values(scene)
        full = matrix_of([[v * (i == k) for k in range(3)] for i, v in enumerate(moments)])
    omega = [known.get(f"omega_{k}") for k in (1, 2, 3)]
    whole = [w for w in omega if w is not None]
    return state(attitude_at_start(scene), convention, full, whole if len(whole) == 3 else None)


def _in_axes(C: Matrix, convention: Convention, *, back: bool = False) -> Matrix:
    """Return C between the convention's axes, or, ``back``, between the house's."""
    reference = axes(convention.reference, REFERENCE_AXES, "reference axes")
    body = axes(convention.body, BODY_AXES, "body axes")
    if back:
        reference, body = transpose(reference), transpose(body)
    return product(product(body, C), transpose(reference))


def state(
    C: Matrix,
    convention: Convention,
    inertia: Matrix | None = None,
    omega: Sequence[float] | None = None,
) -> Stated:
    """Return an attitude, and what is given beside it, from the house's convention in another.

    Parameters
    ----------
    C : sequence of sequence of floats
        (3, 3), as of `attitude_of_matrix`.
    convention : Convention
        In which it is told.
    inertia : sequence of sequence of floats, optional
        (3, 3), kg m^2, off-diagonal entries minus the products of inertia, in the body's axes
        (forward, left, up).
    omega : sequence of floats, optional
        (3,), rad/s, in the body's axes, too.

    Returns
    -------
    Stated
        Matrix, quaternion and angles of the convention, and what is given beside them.

    Raises
    ------
    InputError
        For a matrix that is no rotation.

    Notes
    -----
    Turning about fixed axes is turning about body axes in the opposite order.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), ch. 2; Shuster, J. Astronaut. Sci. 41 (1993) 439.

    Examples
    --------
    >>> state(attitude_of_angles((0, 0, 1)), book("ros")).angles  # roll, pitch, yaw
    (1.0, 0.0, 0.0)
    """
    own = _in_axes(C, convention)
    sequence = convention.sequence
    if convention.order == "space":
        angles: Sequence[float] = angles_of_matrix(own, sequence[::-1])[::-1]
    else:
        angles = angles_of_matrix(own, sequence)
    s, *v = quaternion_of_matrix(own)
    a, b, c, d = (*v, s) if convention.scalar == "last" else (s, *v)
    return Stated(
        convention,
        transpose(own) if convention.direction == "active" else own,
        (a, b, c, d),
        (angles[0], angles[1], angles[2]),
        None if inertia is None else _inertia(inertia, convention),
        None if omega is None else _turned(omega, convention),
    )


def _inertia(J: Matrix, convention: Convention) -> Matrix:
    body = axes(convention.body, BODY_AXES, "body axes")
    turned = product(product(body, J), transpose(body))
    sign = -1 if convention.products == "plus" else 1
    return matrix_of(
        [[x if i == k else sign * x for k, x in enumerate(r)] for i, r in enumerate(turned)]
    )


def _turned(omega: Sequence[float], convention: Convention) -> Row:
    body = axes(convention.body, BODY_AXES, "body axes")
    x, y, z = (dot(row, omega) for row in body)
    return x, y, z


@typed
def changed(convention: Convention, choices: Mapping[str, str]) -> Convention:
    """Return a convention with some of its fields chosen anew: ``choices``, words by field.

    Parameters
    ----------
    convention : Convention
        What is changed.
    choices : mapping of str to str
        Words by the fields of `Convention`.

    Returns
    -------
    Convention
        The convention with these fields chosen anew.

    Raises
    ------
    InputError
        For unknown fields, and as `Convention` for unknown words.

    Examples
    --------
    >>> changed(book("hughes"), {"scalar": "first"}) == changed(HOUSE, {})
    True
    """
    known = [f.name for f in fields(Convention)]
    for name in choices:
        if name not in known:
            raise InputError(
                f"unknown choice {name!r}", where="convention", expected=", ".join(known),
                hint=near_matches(name, known),
            )  # fmt: skip
    return replace(convention, **dict(choices))
