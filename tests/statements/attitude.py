"""Rotations: matrices, sequences, quaternions, angular velocity."""

import math

import numpy as np
import sympy as sp

from eom.kinematics.coordinates import SEQUENCES, attitude, elementary, quaternion_of_sequence
from eom.kinematics.frames import vector
from eom.rotations import (
    angles_of_matrix,
    cosines,
    matrix_of_quaternion,
    quaternion_product,
)
from tests.statements.table import same, says

CONVENTIONS = "docs/explanation/conventions.md"
ANGLES = (0.4, -0.7, 1.1)


def turned(axis, angle):
    """Return the active rotation of vectors about an axis (Rodrigues)."""
    k = np.eye(3)[axis - 1]
    skew = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + math.sin(angle) * skew + (1 - math.cos(angle)) * skew @ skew


def matrix(name, angles=ANGLES):
    """Return C_BA of a sequence by numbers."""
    made = attitude(name)
    values = dict(zip((q.symbol for q in made.coordinates), angles, strict=True))
    return np.array(made.matrix.subs(values).evalf().tolist(), dtype=float)


@says(CONVENTIONS, "Its rows are the axes of B, written in A.")
@says(CONVENTIONS, "This is the *passive* matrix, or direction cosine matrix.")
@says("eom.kinematics.frames.Rotation", "its rows are the unit vectors of B, written in A")
def rows_are_the_axes_of_the_body():
    for axis in (1, 2, 3):
        C = np.array(elementary(axis, 0.6).evalf().tolist(), dtype=float)
        axes = turned(axis, 0.6)  # as columns: the axes of A, turned
        np.testing.assert_allclose(C, axes.T, atol=1e-15)


@says(
    CONVENTIONS,
    "A sequence such as 3-2-1 turns about the body's own axes, as turned so far, the first number first",
)
@says(
    CONVENTIONS,
    "Turning about axes that stay fixed in space, in the same order, gives something else: it is turning "
    "about body axes in the opposite order.",
)
@says("README.md", "rotation sequences turn about body axes, the first angle first")
def sequences_turn_about_body_axes():
    for name in SEQUENCES:
        axes = [int(n) for n in name.split("-")]
        body = np.eye(3)
        for axis, angle in zip(axes, ANGLES, strict=True):
            body = body @ turned(axis, angle)  # about its own axis
        np.testing.assert_allclose(matrix(name), body.T, atol=1e-14)
        space = np.eye(3)
        for axis, angle in zip(axes, ANGLES, strict=True):
            space = turned(axis, angle) @ space
        assert not np.allclose(space, body)
        back = np.eye(3)
        for axis, angle in zip(reversed(axes), reversed(ANGLES), strict=True):
            back = back @ turned(axis, angle)
        np.testing.assert_allclose(space, back, atol=1e-14)


@says(CONVENTIONS, "An elementary matrix has its minus sign in the lower row for axis 3")
@says(
    CONVENTIONS,
    "with the minus sign below the diagonal: a quaternion and the sequence with the same angle are the same attitude",
)
@says(CONVENTIONS, "$q$ and $-q$ are the same attitude, too.")
def quaternions_and_elementary_matrices_agree():
    a = sp.Symbol("a", positive=True)
    assert elementary(3, a)[1, 0] == -sp.sin(a)
    for axis in (1, 2, 3):
        q = (math.cos(0.3), *(math.sin(0.3) * (k == axis) for k in (1, 2, 3)))
        C = np.array(elementary(axis, 0.6).evalf().tolist(), dtype=float)
        np.testing.assert_allclose(matrix_of_quaternion(q), C, atol=1e-15)
        np.testing.assert_allclose(matrix_of_quaternion([-x for x in q]), C, atol=1e-15)


@says(
    CONVENTIONS,
    r"if $p$ is followed by $q$, about axes of the body as turned so far, the attitude is $p\,q$",
)
@says(CONVENTIONS, r"$$ C(p\,q) = C(q)\,C(p) $$")
@says(
    CONVENTIONS,
    "In a product of quaternions the first turn stands on the left, in a product of matrices on the right",
)
@says(
    "eom.rotations.quaternion_product",
    "the turn p is followed by the turn q",
)
@says(
    "eom.kinematics.coordinates.RotationSequence.of_quaternion",
    "q_0 + i q_i = cos(theta/2) exp(i (psi + phi)/2)",
)
def products_of_quaternions_are_turns_in_their_order():
    p, q = (
        (math.cos(a / 2), *(math.sin(a / 2) * (k == axis) for k in (1, 2, 3)))
        for a, axis in ((0.5, 3), (0.8, 1))
    )
    first, then = (np.array(matrix_of_quaternion(x)) for x in (p, q))
    np.testing.assert_allclose(matrix_of_quaternion(quaternion_product(p, q)), then @ first)
    assert not np.allclose(first @ then, then @ first)
    psi, theta, phi = ANGLES
    for name in SEQUENCES:
        found = quaternion_of_sequence(name, ANGLES)
        np.testing.assert_allclose(matrix_of_quaternion(found), matrix(name), atol=1e-14)
        if name[0] == name[-1]:
            value = complex(found[0], found[int(name[0])])
            wanted = math.cos(theta / 2) * np.exp(0.5j * (psi + phi))
            assert abs(abs(value * np.conj(wanted)) - abs(wanted) ** 2) < 1e-12


@says(CONVENTIONS, r"Because $\omega$ is in components of the body, it stands on the right")
@says(
    CONVENTIONS, r"With $\omega$ in components of the reference frame it would stand on the left."
)
@says(CONVENTIONS, r"$\dot q_0 = -\tfrac12(q_1\omega_1 + q_2\omega_2 + q_3\omega_3)$")
@says(
    CONVENTIONS,
    r"$\dot q_1 = \tfrac12(q_0\omega_1 + q_2\omega_3 - q_3\omega_2)$ with 1, 2, 3 going around",
)
@says(
    "eom.kinematics.coordinates.UnitQuaternion.rates",
    "half the quaternion product of q with (0, omega): an infinitesimal further turn",
)
def rates_of_a_quaternion():
    q = np.array([0.5, -0.1, 0.7, 0.5]) / np.linalg.norm([0.5, -0.1, 0.7, 0.5])
    w, h = np.array([0.4, -1.1, 0.8]), 1e-6
    size = np.linalg.norm(w)
    step = (
        math.cos(size * h / 2),
        *(math.sin(size * h / 2) * w / size),
    )  # a little turn, in the body
    later = np.array(quaternion_product(q, step))
    rate = (later - q) / h
    made = attitude("quaternion")
    put = dict(zip((c.symbol for c in made.coordinates), q, strict=True))
    found = [float(sp.sympify(r).subs(put)) for r in made.rates(vector("B", w.tolist()))]
    np.testing.assert_allclose(found, rate, atol=1e-5)
    np.testing.assert_allclose(found[0], -(q[1:] @ w) / 2)
    for a, b, c in ((1, 2, 3), (2, 3, 1), (3, 1, 2)):
        np.testing.assert_allclose(
            found[a], (q[0] * w[a - 1] + q[b] * w[c - 1] - q[c] * w[b - 1]) / 2
        )
    C = np.array(matrix_of_quaternion(q))
    np.testing.assert_allclose(np.array(quaternion_product((0, *(C.T @ w)), q)) / 2, found)
    # the matrix turns as omega says
    change = (np.array(matrix_of_quaternion(later)) - C) / h
    skew = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    np.testing.assert_allclose(change, -skew @ C, atol=1e-5)


@says(
    CONVENTIONS,
    r"$$ \dot C_{BA} = -\tilde\omega\,C_{BA}, \qquad \tilde\omega = \begin{bmatrix} 0 & -\omega_3 & \omega_2 \\ \omega_3 & 0 & -\omega_1 \\ -\omega_2 & \omega_1 & 0 \end{bmatrix} $$",
)
@says("derive transport-theorem poisson", "the meaning of the angular velocity omega of B in I")
@says("derive transport-theorem addition", "as v is any vector, angular velocities add")
@says(
    "derive transport-theorem reverse", "so the reverse rotation has the opposite angular velocity"
)
def angular_velocities():
    t = sp.Symbol("t", real=True)
    a, b = sp.Function("a")(t), sp.Function("b")(t)

    def omega(C):
        """Return the angular velocity of B in A in B, from -C' C^T."""
        S = sp.simplify(-C.diff(t) * C.T)
        return sp.Matrix([S[2, 1], S[0, 2], S[1, 0]])

    first, second = elementary(3, a), elementary(1, b)
    both = second * first
    assert same(omega(first), [0, 0, a.diff(t)])
    assert same(omega(both), omega(second) + second * omega(first))
    assert same(omega(both.T), -both.T * omega(both))
    made = attitude("3-2-1")
    angles = [q.symbol for q in made.coordinates]
    at, speeds = dict(zip(angles, ANGLES, strict=True)), (0.3, -1.2, 0.8)
    C = np.array(made.matrix.subs(at).evalf().tolist(), dtype=float)
    rate = sum((made.matrix.diff(q) * v for q, v in zip(angles, speeds, strict=True)), sp.zeros(3))
    S = -np.array(rate.subs(at).evalf().tolist(), dtype=float) @ C.T
    np.testing.assert_allclose(S, -S.T, atol=1e-14)
    w = vector("B", (S[2, 1], S[0, 2], S[1, 0]))
    found = [float(r.subs(at)) for r in made.rates(w)]
    np.testing.assert_allclose(found, speeds)


@says(
    "eom.kinematics.coordinates.RotationSequence.rates",
    "the determinant of the three axes is plus or minus the sine or cosine of the second angle",
)
@says(
    CONVENTIONS,
    r"Sequences whose first and last axes are the same are singular where $\theta$ is a multiple of $\pi$, the others a quarter turn beside.",
)
@says(
    CONVENTIONS,
    "There the first and the last turn are about the same line, and only their sum or difference is known.",
)
@says(
    "docs/howto/analysis.md", "Euler's angles are singular where a top is upright; gimbals are not."
)
def where_sequences_are_singular():
    for name in SEQUENCES:
        made = attitude(name)
        theta = made.coordinates[1].symbol
        i, j, k = (int(n) - 1 for n in name.split("-"))
        unit = [sp.eye(3).col(n) for n in (i, j, k)]
        axes = [elementary(j + 1, theta) * unit[0], unit[1], unit[2]]
        determinant = sp.simplify(sp.Matrix.hstack(*axes).det())
        assert determinant in {s * f(theta) for s in (1, -1) for f in (sp.sin, sp.cos)}
        upright = determinant.subs(theta, 0)
        assert (upright == 0) is (name[0] == name[-1])
        there = 0.0 if name[0] == name[-1] else math.pi / 2
        same_line = (matrix(name, (0.3 + s * 0.5, there, 0.4 - 0.5)) for s in (1, -1))
        known = [np.allclose(C, matrix(name, (0.3, there, 0.4)), atol=1e-12) for C in same_line]
        assert sum(known) == 1


@says("derive tilde-identities turned-tilde", "a cross product may be formed in either frame")
@says(
    "derive tilde-identities tilde-of-cross",
    "the skew matrix of a cross product: both sides have the same entries",
)
@says("derive tilde-identities skew", "skew-symmetric: both sides have the same entries")
def tildes():
    a, b = sp.Matrix(sp.symbols("a1:4")), sp.Matrix(sp.symbols("b1:4"))

    def tilde(v):
        return sp.Matrix([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])

    assert same(tilde(a) * b, a.cross(b))
    assert same(tilde(a).T, -tilde(a))
    assert same(tilde(a.cross(b)), tilde(a) * tilde(b) - tilde(b) * tilde(a))
    C = elementary(3, sp.Symbol("x")) * elementary(1, sp.Symbol("y"))
    assert same(C * tilde(a) * C.T, tilde(C * a))


@says("eom.rotations.cosines", "C of a quaternion, times its squared norm")
def cosines_of_any_quaternion():
    q = np.array([0.3, -1.2, 0.8, 0.5])
    C = np.array(cosines(q))
    np.testing.assert_allclose(C @ C.T, (q @ q) ** 2 * np.eye(3), atol=1e-12)


METHODS = "docs/howto/methods.md"


@says(
    METHODS,
    "*The second angle* is between -90 and 90 degrees, of a sequence such as 3-1-3 between 0 and 180",
)
@says(
    "eom.kinematics.coordinates.RotationSequence.of_quaternion",
    "The second is between -pi/2 and pi/2, of a sequence whose first and third axes are the same between 0 and pi.",
)
def the_range_of_the_second_angle():
    draw = np.random.default_rng(5)
    for name in SEQUENCES:
        for _ in range(20):
            q = draw.normal(size=4)
            C = np.array(matrix_of_quaternion(q / np.linalg.norm(q)))
            found = angles_of_matrix(tuple(map(tuple, C.tolist())), name)
            again = matrix_of_quaternion(quaternion_of_sequence(name, found))
            np.testing.assert_allclose(again, C, atol=1e-12)
            low = 0 if name[0] == name[-1] else -math.pi / 2
            assert low <= found[1] <= low + math.pi


@says(
    METHODS,
    "Passing beside it both change by half a turn in a short time; straight through, they jump.",
)
def angles_change_by_half_a_turn_beside_a_singular_configuration():
    """A body that pitches up through the vertical, yawed a little aside."""
    found = []
    for pitch in np.linspace(1.3, 1.85, 2001):
        C = matrix_of_quaternion(quaternion_product(quaternion_of_sequence("3-2-1", (0.0, pitch, 0.0)),
                                                    quaternion_of_sequence("3-2-1", (0.01, 0.0, 0.0))))  # fmt: skip
        found.append(angles_of_matrix(C, "3-2-1"))
    psi, theta, phi = np.unwrap(np.array(found), axis=0).T
    for angle in (psi, phi):
        assert abs(abs(angle[-1] - angle[0]) - math.pi) < 0.1
    close = np.abs(theta - math.pi / 2) < 0.05
    assert np.ptp(psi[close]) > 2.5
    assert close.mean() < 0.25


@says(METHODS, "Seconds since 1970 are about 1.7e9, and doubles there are 2.4e-7 s apart.")
@says(
    "docs/howto/events.md", "The oscillator below is above 0.99999 for 9 ms in each turn of 6.3 s"
)
def small_numbers_of_time():
    assert abs(np.spacing(1.7e9) - 2.4e-7) < 0.05e-7
    assert abs(2 * math.acos(0.99999) - 9e-3) < 0.5e-3
    assert abs(2 * math.pi - 6.3) < 0.05
