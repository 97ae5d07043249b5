"""Regions given by bounds and densities, and the laws that mass properties obey."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.exact.identity import equal
from eom.kinematics.frames import Rotation
from eom.mass.properties import MassProperties
from eom.mass.regions import Region, X, check, properties, reduce_circles, simplex
from tests.draws import examples

x, y, z = X
u, v, w, t = (sp.Symbol(n, real=True) for n in "uvwt")
a, b, r, h = (sp.Symbol(n, positive=True) for n in "abrh")
TURN = (t, 0, 2 * sp.pi)
BALL = (r * u * sp.sin(v) * sp.cos(t), r * u * sp.sin(v) * sp.sin(t), r * u * sp.cos(v))


def ball(density=1):
    return Region(BALL, ((u, 0, 1), (v, 0, sp.pi), TURN), density)


def box(sides, density=1):
    return Region(
        (u, v, w), tuple((p, 0, s) for p, s in zip((u, v, w), sides, strict=True)), density
    )


def numbers(body):
    return [float(e) for e in (body.mass, *body.first_moment, *body.second_moments)]


# regions


def test_dimensions_elements_and_sizes():
    rod = Region((0, 3 * u, 4 * u), ((u, 0, a),))
    assert (rod.dimension, rod.element, rod.sizes) == (1, 5, (a,))
    shell = Region(tuple(c.subs(u, 1) for c in BALL), ((v, 0, sp.pi), TURN))
    assert (shell.dimension, shell.element) == (2, r**2 * sp.sin(v))
    assert ball().element == r**3 * u**2 * sp.sin(v)
    cone = Region((u * sp.cos(t), u * sp.sin(t), h * u / r), ((u, 0, r), TURN))
    assert equal(cone.element**2, u**2 * (1 + h**2 / r**2))


@pytest.mark.parametrize("order", [(0, 1, 2), (1, 0, 2), (2, 1, 0), (1, 2, 0)])
def test_order_of_integration_does_not_matter(order):
    bounds = ((u, 0, 1), (v, 0, sp.pi), TURN)
    body = properties(Region(BALL, tuple(bounds[k] for k in order)))
    assert body.mass == 4 * sp.pi * r**3 / 3
    assert body.about_centre == sp.eye(3) * 8 * sp.pi * r**5 / 15


def test_limits_may_depend_on_outer_parameters():
    wedge = Region((u, v, w), ((u, 0, a * (1 - v)), (v, 0, 1), (w, 0, b)))
    assert properties(wedge).mass == a * b / 2
    assert list(properties(wedge).centre) == [a / 3, sp.Rational(1, 3), b / 2]


@pytest.mark.parametrize("density", [1, x**2 + y * z + 3, (x + 2) ** 3, 2 - z / 2, a * x**2])
def test_polynomial_densities_against_cubature(density):
    sides = (1, sp.Rational(3, 2), 2)
    body = properties(box(sides, density))
    nodes, weights = np.polynomial.legendre.leggauss(8)
    grids = [(float(s) * (nodes + 1) / 2, float(s) * weights / 2) for s in sides]
    rho = sp.lambdify((*X, a), density, "math")
    total = np.zeros(5)
    for i, j, k in np.ndindex(8, 8, 8):
        p = [g[0][n] for g, n in zip(grids, (i, j, k), strict=True)]
        dm = rho(*p, 1.3) * math.prod(g[1][n] for g, n in zip(grids, (i, j, k), strict=True))
        total += dm * np.array([1, p[0], p[2], p[0] ** 2 + p[1] ** 2, -p[0] * p[2]])
    c, J = body.first_moment, body.inertia
    found = [float(e.subs(a, 1.3)) for e in (body.mass, c[0], c[2], J[2, 2], J[0, 2])]
    assert found == pytest.approx(total, rel=1e-11)


def test_density_of_a_ball_that_grows_outwards():
    """I = 2/3 integral of r^2 dm: rho = r^2 gives 8 pi R^7 / 21."""
    body = properties(ball(x**2 + y**2 + z**2))
    assert body.mass == 4 * sp.pi * r**5 / 5
    assert body.inertia == sp.eye(3) * 8 * sp.pi * r**7 / 21


def test_surface_outside_the_rules_is_searched():
    """Paraboloid z = u^2/2 up to u = 1: area 2 pi/3 (2 sqrt 2 - 1) (Bronstein, 8.2.2)."""
    bowl = Region((u * sp.cos(t), u * sp.sin(t), u**2 / 2), (TURN, (u, 0, 1)))
    assert float(bowl.moment(1)) == pytest.approx(2 * math.pi / 3 * (2 * math.sqrt(2) - 1))


def test_region_of_numbers_with_a_density():
    drum = Region(
        (u * sp.cos(t), u * sp.sin(t), 0.5 * w), (TURN, (u, 0, 1.5), (w, 0, 1)), 2 + 4 * z
    )
    body = properties(drum)
    assert body.mass == sp.pi * sp.Rational(9, 4) * sp.Rational(3, 2)
    assert list(body.centre) == [0, 0, sp.Rational(5, 18)]
    assert list((body - properties(drum).of_mass(1)).centre) == list(body.centre)


def test_decimals_are_read_as_written():
    body = properties(box((0.1, 0.2, 0.3)))
    assert body.mass == sp.Rational(6, 1000)


def test_circles_are_reduced_to_the_shortest_form():
    s, c = sp.sin(t), sp.cos(t)
    assert reduce_circles(a**2 * s**2 + a**2 * c**2) == a**2
    assert reduce_circles(a * s**2) == a * s**2
    assert reduce_circles(s**3 * c**2 + s**5) == s**3
    assert reduce_circles((s**2 + c**2) ** 3 - 1) == 0


def test_simplices():
    assert properties(simplex((0, 0, 0), (3, 4, 0))).mass == 5
    triangle = properties(simplex((0, 0, 1), (2, 0, 1), (0, 2, 1)))
    assert list(triangle.centre) == [sp.Rational(2, 3), sp.Rational(2, 3), 1]
    corners = ((1, 0, 0), (0, 2, 0), (0, 0, 3), (1, 1, 1))
    body = properties(simplex(*corners))
    edges = np.array(corners[1:]) - np.array(corners[0])
    assert float(body.mass) == pytest.approx(abs(np.linalg.det(edges)) / 6)
    assert list(body.centre) == [sp.Rational(sum(c), 4) for c in zip(*corners, strict=True)]


# bad regions

IMPOSSIBLE = {
    "two coordinates": lambda: Region((u, v), ((u, 0, 1),)),
    "no bounds": lambda: Region((0, 0, 0), ()),
    "four bounds": lambda: Region((u, v, w), tuple((p, 0, 1) for p in (u, v, w, t))),
    "a parameter twice": lambda: Region((u, u, 0), ((u, 0, 1), (u, 0, 1))),
    "a parameter that is a number": lambda: Region((u, 0, 0), ((1, 0, 1),)),
    "two limits short": lambda: Region((u, 0, 0), ((u, 0),)),
    "infinite limit": lambda: Region((u, 0, 0), ((u, 0, sp.oo),)),
    "infinite float": lambda: Region((u, 0, 0), ((u, -math.inf, 0),)),
    "not a number": lambda: Region((u, 0, 0), ((u, 0, math.nan),)),
    "limits of an inner parameter": lambda: Region((u, v, 0), ((u, 0, 1), (v, 0, u))),
    "density over a parameter": lambda: Region((u, 0, 0), ((u, 0, 1),), u),
    "text": lambda: Region(("u", 0, 0), ((u, 0, 1),)),
    "five corners": lambda: simplex(*[(0, 0, k) for k in range(5)]),
    "flat corner": lambda: simplex((0, 0), (1, 1)),
}


@pytest.mark.parametrize("build", IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_impossible_regions_are_refused(build):
    with pytest.raises(InputError):
        build()


BAD = {
    "reversed": (box((1, -2, 1)), "bounds of v are reversed", "from 0 to -2"),
    "reversed later": (
        Region((u, v, 0), ((u, 0, 1 - v), (v, 0, 2))),
        "bounds of u are reversed",
        "from 0 to",
    ),
    "no width": (box((1, 0, 1)), "no volume", "equal"),
    "flat map": (Region((u, v, u + v), ((u, 0, 1), (v, 0, 1), (w, 0, 1))), "no volume", ""),
    "flat triangle": (simplex((0, 0, 0), (1, 1, 0), (2, 2, 0)), "no area", ""),
    "no length": (simplex((1, 1, 0), (1, 1, 0)), "no length", ""),
    "inside out": (Region((u**2, v, w), ((u, -1, 2), (v, 0, 1), (w, 0, 1))), "inside out", ""),
    "zenith all round": (
        Region(tuple(c.subs(r, 1) for c in BALL), ((u, 0, 1), (v, 0, 2 * sp.pi), TURN)),
        "inside out",
        "",
    ),
    "two turns": (
        Region((u * sp.cos(t), u * sp.sin(t), 0), ((u, 0, 1), (t, 0, 4 * sp.pi))),
        "covers a place twice",
        "t = ",
    ),
    "negative density": (box((1, 1, 1), 1 - 2 * x * y), "density is negative", "= -1"),
    "negative in a corner": (box((1, 1, 1), 2.9 - x - y - z), "density is negative", "= -0.1"),
    "no mass": (box((1, 1, 1), 0), "density is zero", ""),
    "imaginary density": (box((1, 1, 1), sp.sqrt(x - 2)), "not a finite real number", "I"),
    "infinite density": (box((1, 1, 1), 1 / x), "not a finite real number", ""),
}


@pytest.mark.parametrize(("region", "what", "got"), BAD.values(), ids=BAD)
def test_bad_regions_are_refused_by_name_and_place(region, what, got):
    with pytest.raises(InputError, match=what) as caught:
        properties(region)
    assert got in caught.value.got
    assert caught.value.where


def test_place_of_a_negative_density_is_reported():
    with pytest.raises(InputError) as caught:
        check(box((a, 1, 1), 1 - x), {"a": 3.0})
    assert caught.value.where.startswith("x = 3, y = ")


def test_sizes_are_checked():
    region = box((a, b, 1))
    check(region, {"a": 1.0, "b": 2})
    for sizes, what in (
        ({"a": 1.0}, "missing size: b"),
        ({"a": 1.0, "b": 1.0, "c": 1.0}, "unknown size 'c'"),
        ({"a": -1.0, "b": 1.0}, "impossible size"),
        ({"a": math.nan, "b": 1.0}, "impossible size"),
    ):
        with pytest.raises(InputError, match=what):
            check(region, sizes)


def test_orientation_that_depends_on_sizes_is_reported():
    c = sp.Symbol("c", real=True)
    region = Region((c * u, v, w), ((u, 0, 1), (v, 0, 1), (w, 0, 1)))
    check(region, {"c": 2.0})
    with pytest.raises(InputError, match="orientation"):
        check(region, {"c": -2.0})


def test_good_regions_pass():
    check(ball(), {"r": 0.3})
    check(ball(1 + x / 2), {"r": 0.3})
    check(box((1e-6, 1, 1e3)), {})


# laws of mass properties

number = st.integers(-5, 5).map(lambda n: sp.Rational(n, 2))
side = st.integers(1, 5).map(lambda n: sp.Rational(n, 3))
triple = st.tuples(number, number, number)
sides = st.tuples(side, side, side)
law = examples(25)


def brick(lengths, corner):
    """Exact moments of a box by its edges; independent of regions."""
    volume = math.prod(lengths)
    centre = sp.Matrix([c + s / 2 for c, s in zip(corner, lengths, strict=True)])
    own = sp.diag(*(volume * s**2 / 12 for s in lengths))
    return MassProperties(volume, volume * centre, own + volume * centre * centre.T)


@law
@given(lengths=sides, corner=triple)
def test_regions_of_shifted_boxes(lengths, corner):
    region = Region(
        tuple(p + c for p, c in zip((u, v, w), corner, strict=True)),
        tuple((p, 0, s) for p, s in zip((u, v, w), lengths, strict=True)),
    )
    assert properties(region) == brick(lengths, corner)


@law
@given(lengths=sides, corner=triple, r1=triple, r2=triple)
def test_shifts_add_and_keep_the_centre(lengths, corner, r1, r2):
    body = brick(lengths, corner)
    both = [p + q for p, q in zip(r1, r2, strict=True)]
    assert body.shifted(r1).shifted(r2) == body.shifted(both)
    assert body.shifted(r1).about_centre == body.about_centre
    assert body.shifted(r1) == brick(lengths, [c - s for c, s in zip(corner, r1, strict=True)])


@law
@given(lengths=sides, corner=triple, r1=triple)
def test_parallel_axes_theorem(lengths, corner, r1):
    """J_O = I_C + m (|c|^2 1 - c c^T) (lecture 000; Kane, Levinson, Dynamics, 3.5)."""
    body = brick(lengths, corner).shifted(r1)
    c = body.centre
    assert body.inertia == body.about_centre + body.mass * (c.dot(c) * sp.eye(3) - c * c.T)


ROTATIONS = [
    sp.Matrix([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
    sp.Matrix([[2, 2, -1], [-1, 2, 2], [2, -1, 2]]) / 3,
    sp.Matrix([[3, 4, 0], [-4, 3, 0], [0, 0, 5]]) / 5,
]


@law
@given(lengths=sides, corner=triple, k=st.sampled_from(range(3)), j=st.sampled_from(range(3)))
def test_rotations_chain_and_keep_the_invariants(lengths, corner, k, j):
    body, C, D = brick(lengths, corner), ROTATIONS[k], ROTATIONS[j]
    turned = body.rotated(C)
    assert turned.rotated(D) == body.rotated(D * C)
    assert turned.inertia == C * body.inertia * C.T
    assert turned.about_centre.trace() == body.about_centre.trace()
    assert turned.centre == C * body.centre
    assert body.rotated(Rotation("B", "A", C)) == turned


@law
@given(lengths=sides, corner=triple, cut=st.integers(1, 4))
def test_parts_make_the_whole_and_holes_undo_them(lengths, corner, cut):
    first = lengths[0] * cut / 5
    one = brick((first, *lengths[1:]), corner)
    two = brick((lengths[0] - first, *lengths[1:]), (corner[0] + first, *corner[1:]))
    whole = brick(lengths, corner)
    assert one + two == whole == two + one
    assert whole - one == two


@law
@given(lengths=sides, corner=triple, factor=side)
def test_scaling_the_mass(lengths, corner, factor):
    body = brick(lengths, corner)
    scaled = body.of_mass(body.mass * factor)
    assert scaled.centre == body.centre
    assert scaled.inertia == body.inertia * factor


def test_hole_of_a_sphere_in_a_sphere_tends_to_the_thin_shell():
    outer = properties(ball())
    for thin in (1e-3, 1e-4):
        inner = properties(Region(tuple(c.subs(r, r * (1 - thin)) for c in BALL), ball().bounds))
        shell = (outer - inner).of_mass(1)
        error = float(shell.inertia[0, 0] / r**2) / (2 / 3) - 1
        assert error == pytest.approx(-thin, rel=0.01)


def test_symbolic_rotation_by_an_angle():
    C = sp.Matrix([[sp.cos(t), sp.sin(t), 0], [-sp.sin(t), sp.cos(t), 0], [0, 0, 1]])
    body = properties(box((a, a, b))).rotated(C)
    assert equal(body.inertia.trace(), properties(box((a, a, b))).inertia.trace())


def test_properties_with_floats():
    body = MassProperties(2.0, (0.2, 0.0, 1.0), sp.diag(1.0, 2.0, 3.0).tolist())
    moved = body.shifted((0.1, 0.0, 0.5))
    assert numbers(moved)[:4] == pytest.approx([2.0, 0.0, 0.0, 0.0], abs=1e-15)
    assert numbers(body.of_mass(1.0))[0] == 1.0
    s = math.sin(0.3)
    C = sp.Matrix([[math.cos(0.3), s, 0], [-s, math.cos(0.3), 0], [0, 0, 1]])
    assert float(body.rotated(C).inertia.trace()) == pytest.approx(12.0)


REFUSED = {
    "infinite": (lambda: MassProperties(math.inf, (0, 0, 0), sp.eye(3)), "not finite"),
    "not a number": (lambda: MassProperties(1, (0, math.nan, 0), sp.eye(3)), "not finite"),
    "no mass": (lambda: MassProperties(0, (0, 0, 0), sp.eye(3)), "mass is not positive"),
    "too far out": (lambda: MassProperties(1, (9, 0, 0), sp.eye(3)), "no body has"),
    "not definite": (
        lambda: MassProperties(1, (0, 0, 0), sp.Matrix([[1, 2, 0], [2, 1, 0], [0, 0, 1]])),
        "no body has",
    ),
    "heavy hole": (lambda: brick((1, 1, 1), (0, 0, 0)) - brick((2, 1, 1), (0, 0, 0)), "mass"),
    "hole outside": (lambda: brick((2, 2, 2), (0, 0, 0)) - brick((1, 1, 1), (9, 0, 0)), "no body"),
    "negative mass": (lambda: brick((1, 1, 1), (0, 0, 0)).of_mass(-1), "mass is not positive"),
    "short step": (lambda: brick((1, 1, 1), (0, 0, 0)).shifted((1, 2)), "three components"),
    "text step": (lambda: brick((1, 1, 1), (0, 0, 0)).shifted(("a", "b", "c")), "not a number"),
    "stretch": (lambda: brick((1, 1, 1), (0, 0, 0)).rotated(2 * sp.eye(3)), "no rotation"),
    "mirror": (lambda: brick((1, 1, 1), (0, 0, 0)).rotated(sp.diag(1, 1, -1)), "no rotation"),
    "flat": (lambda: brick((1, 1, 1), (0, 0, 0)).rotated(sp.eye(2)), "3 by 3"),
}


@pytest.mark.parametrize(("build", "what"), REFUSED.values(), ids=REFUSED)
def test_impossible_mass_properties_are_refused(build, what):
    with pytest.raises(InputError, match=what):
        build()
