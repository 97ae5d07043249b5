"""Moments of inertia: signs, inequalities, points, axes, solids."""

import numpy as np
import sympy as sp

from eom.mass.inertia import inertia_of_second_moments, principal_conditions
from eom.mass.principal import definiteness, principal_axes
from eom.mass.properties import MassProperties
from eom.mass.solids import SOLIDS, inertia, mass_properties
from tests.statements.table import same, says

POINTMASSES = "notebooks/lecture-002-particles-to-euler.ipynb"
MEASURED = "docs/howto/measured-inertia.md"
CONVENTIONS = "docs/explanation/conventions.md"


def cloud(seed, count=7):
    """Return masses and places of a body of points, its centre of mass at the origin."""
    draw = np.random.default_rng(seed)
    m, r = draw.uniform(0.1, 2, count), draw.normal(size=(count, 3))
    return m, r - m @ r / m.sum()


def about(m, r, point=(0, 0, 0)):
    """Return the inertia matrix about a point, as the sum of m (r.r 1 - r r^T)."""
    d = r - np.asarray(point)
    return sum(a * (x @ x * np.eye(3) - np.outer(x, x)) for a, x in zip(m, d, strict=True))


def cross(v):
    """Return the skew matrix of a cross product."""
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


@says(
    POINTMASSES,
    "away from the centre of mass no moment of inertia is smaller. The one about the line from there to "
    "$O_B$ is the same, those across it are larger by $m r^2$.",
)
@says("derive inertia-properties J-parallel-axes", "the parallel-axis theorem")
@says(POINTMASSES, r"$\mathbf r^\times\mathbf r^\times$ has no positive eigenvalue")
def moments_about_other_points_are_not_smaller():
    m, r = cloud(1)
    d = np.array([0.4, -1.1, 0.7])
    centre, moved = about(m, r), about(m, r, d)
    np.testing.assert_allclose(moved, centre - m.sum() * cross(d) @ cross(d))
    assert np.linalg.eigvalsh(cross(d) @ cross(d)).max() < 1e-12
    towards = d / np.linalg.norm(d)
    across = np.cross(towards, [1, 0, 0]) / np.linalg.norm(np.cross(towards, [1, 0, 0]))
    assert np.isclose(towards @ moved @ towards, towards @ centre @ towards)
    assert np.isclose(across @ (moved - centre) @ across, m.sum() * d @ d)
    assert np.linalg.eigvalsh(moved - centre).min() > -1e-12


@says(
    POINTMASSES,
    "That it is symmetric, and positive definite unless all mass lies on one line through the reference "
    "point, follows from the integral.",
)
@says(
    "derive inertia-properties semi-definite",
    "zero only where all mass lies on the line of x through O",
)
@says("derive inertia-properties thin-rod", "along a thin rod through O the matrix is singular")
@says(
    "derive inertia-properties symmetric",
    "symmetric, as each term of the integrand is its own transpose",
)
def inertia_is_definite_but_for_a_rod_through_the_point():
    m, r = cloud(2)
    np.testing.assert_allclose(about(m, r), about(m, r).T)
    assert np.linalg.eigvalsh(about(m, r)).min() > 0.1
    along = np.array([1.0, 2.0, -2.0]) / 3
    rod = np.outer(r[:, 0], along)
    assert abs(np.linalg.eigvalsh(about(m, rod)).min()) < 1e-12
    np.testing.assert_allclose(about(m, rod) @ along, 0, atol=1e-12)
    aside = about(m, rod, (0.0, 0.3, 0.0))
    assert np.linalg.eigvalsh(aside).min() > 0.01
    assert definiteness(about(m, rod).tolist()).kind == "positive semi-definite"


@says(MEASURED, "A moment about one axis cannot exceed the sum of the other two.")
@says(
    MEASURED,
    "If a measured matrix fails here by a little, the errors of the three moments add up to at least as much",
)
@says("derive inertia-properties triangle-1", "the two others less one moment is a sum of squares")
@says(
    "eom.mass.inertia.principal_conditions",
    "These are the second moments of mass themselves, times two.",
)
@says(
    "notebooks/lecture-002-particles-to-euler.ipynb",
    "No principal moment exceeds the sum of the other two.",
)
def the_triangle_inequality():
    a, b, c = sp.symbols("a b c", positive=True)
    moments = inertia_of_second_moments(sp.diag(a, b, c)).diagonal()
    assert same(list(principal_conditions(moments)), [2 * a, 2 * b, 2 * c])
    for seed in range(5):
        m, r = cloud(seed)
        low, middle, high = np.linalg.eigvalsh(about(m, r))
        assert high < low + middle
    # true moments obey it, so that a measured excess e needs errors whose sizes add up to e
    draw, true = np.random.default_rng(3), np.array([1.0, 1.0, 2.0])
    for error in draw.normal(scale=0.1, size=(200, 3)):
        x, y, z = true + error
        assert np.abs(error).sum() >= z - x - y - 1e-12


@says(CONVENTIONS, r"$$ J_{12} = -\int r_1 r_2\,\mathrm dm $$")
@says(CONVENTIONS, "Its entries beside the diagonal are *minus* the integrals")
@says("README.md", "off-diagonal entries of an inertia matrix are minus the products of inertia")
def products_of_inertia_have_a_minus_sign():
    m, r = cloud(4)
    w = np.array([0.3, -0.8, 1.1])
    momentum = sum(a * np.cross(x, np.cross(w, x)) for a, x in zip(m, r, strict=True))
    S = sum(a * np.outer(x, x) for a, x in zip(m, r, strict=True))
    J = np.array(inertia_of_second_moments(sp.Matrix(S)).tolist(), dtype=float)
    np.testing.assert_allclose(J @ w, momentum)
    np.testing.assert_allclose(J[0, 1], -(m * r[:, 0] * r[:, 1]).sum())


@says("eom.mass.properties.MassProperties.shifted", "S' = S - c r^T - r c^T + m r r^T")
def second_moments_about_another_point():
    m, r = cloud(5)
    r = r + np.array([0.2, 0.1, -0.4])
    body = MassProperties(m.sum(), sp.Matrix(m @ r), sp.Matrix((m[:, None] * r).T @ r))
    point = np.array([0.5, -0.2, 0.3])
    moved = body.shifted(point.tolist())
    expected = (m[:, None] * (r - point)).T @ (r - point)
    np.testing.assert_allclose(np.array(moved.second_moments.tolist(), dtype=float), expected)


@says(
    "derive inertia-properties rows",
    "unit eigenvectors in right-handed order are the rows of the rotation matrix",
)
@says(
    "derive inertia-properties eigenvector-1",
    "a principal axis is an eigenvector, the moment its eigenvalue",
)
@says("eom.mass.principal", "C J C^T = diag(moments)")
@says("derive euler-equations J-principal", "in principal axes the inertia matrix is diagonal")
def principal_axes_are_rows_of_eigenvectors():
    m, r = cloud(6)
    J = about(m, r)
    found = principal_axes(J.tolist())
    C = np.array(found.C.tolist(), dtype=float)
    np.testing.assert_allclose(C @ J @ C.T, np.diag([float(x) for x in found.moments]), atol=1e-12)
    assert np.isclose(np.linalg.det(C), 1)
    for moment, axis in zip(found.moments, C, strict=True):
        np.testing.assert_allclose(J @ axis, float(moment) * axis, atol=1e-12)


@says("eom.mass.solids", "Every axis of symmetry is b3.")
@says(POINTMASSES, "`eom` integrates it for 26 solids")
@says(MEASURED, "`eom list` shows 26")
def axes_of_symmetry_are_the_third():
    assert len(SOLIDS) == 26
    symmetric = 0
    for name in SOLIDS:
        J = inertia(name)
        equal = [sp.simplify(J[a, a] - J[b, b]) == 0 for a, b in ((0, 1), (0, 2), (1, 2))]
        round_about_3 = equal[0] and J[0, 1] == 0
        symmetric += round_about_3
        assert round_about_3 or not any(equal), name
    assert symmetric >= 12


@says(
    "derive rigid-body-momentum J-tilde",
    "the product of two skew matrices is [r]_B [r]_B^T less [r]_B^T [r]_B times the unit matrix: minus the integrand",
)
@says("derive rigid-body-momentum h-inertia-parted", "r x (omega x r) = omega (r.r) - r (r.omega)")
def products_of_tildes():
    r, w = sp.Matrix(sp.symbols("r1:4", real=True)), sp.Matrix(sp.symbols("w1:4", real=True))
    tilde = sp.Matrix([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
    assert same(tilde * tilde, r * r.T - r.dot(r) * sp.eye(3))
    assert same(r.cross(w.cross(r)), w * r.dot(r) - r * r.dot(w))


@says(
    "eom.mass.properties.MassProperties",
    "Sums and differences are about the same point, in the same axes.",
)
@says("docs/howto/measured-inertia.md", "In Python bodies add and subtract, move and turn.")
def bodies_add_and_subtract():
    outer, inner = (mass_properties("box").of_mass(k) for k in (8, 1))
    sizes = {s: 2 * s for s in outer.second_moments.free_symbols}
    whole = MassProperties(8, (0, 0, 0), outer.second_moments.xreplace(sizes))
    rest = whole - inner
    assert rest.mass == 7
    assert same(rest.inertia + inner.inertia, whole.inertia)
    assert (
        definiteness(rest.inertia.subs(dict.fromkeys(sizes, 1)).tolist()).kind
        == "positive definite"
    )


@says("derive rigid-body-momentum first-moment-zero", "r starts at the centre of mass")
@says("derive kinetic-energy T-koenig", "the middle term vanishes")
@says("derive kinetic-energy T-half", "one half comes out of the integral")
def energy_is_that_of_the_centre_and_that_about_it():
    m, r = cloud(7)
    w, velocity = np.array([0.4, 1.0, -0.6]), np.array([2.0, -1.0, 0.5])
    v = velocity + np.cross(w, r)
    whole = 0.5 * m @ (v**2).sum(axis=1)
    np.testing.assert_allclose(m @ r, 0, atol=1e-12)
    assert np.isclose(whole, 0.5 * m.sum() * velocity @ velocity + 0.5 * w @ about(m, r) @ w)
    aside = r + np.array([1.0, 0, 0])  # about another point the middle term is there
    v = velocity + np.cross(w, aside)
    parts = 0.5 * m.sum() * velocity @ velocity + 0.5 * w @ about(m, aside) @ w
    assert not np.isclose(0.5 * m @ (v**2).sum(axis=1), parts)


@says(
    "derive kinetic-energy power",
    "the energy changes at the power of force and torque; internal forces do no work",
)
def rigid_internal_forces_do_no_work():
    m, r = cloud(8)
    draw = np.random.default_rng(8)
    w, velocity = draw.normal(size=3), draw.normal(size=3)
    v = velocity + np.cross(w, r)
    tension = draw.normal(size=(len(m), len(m)))
    tension = tension + tension.T
    internal = np.array(
        [sum(tension[i, j] * (r[i] - r[j]) for j in range(len(m))) for i in range(len(m))]
    )
    assert abs((internal * v).sum()) < 1e-10
    outside = draw.normal(size=(len(m), 3))
    power = outside.sum(axis=0) @ velocity + np.cross(r, outside).sum(axis=0) @ w
    assert np.isclose((outside * v).sum(), power)


@says("derive inertia-properties J-rotated", "the integral is minus the matrix in A")
def inertia_in_turned_axes():
    m, r = cloud(9)
    C = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))[0]
    np.testing.assert_allclose(about(m, r @ C.T), C @ about(m, r) @ C.T, atol=1e-12)
