"""The solids of the catalogue against published tables, cubature, each other and bad input."""

from __future__ import annotations

import math
import random
from functools import cache

import numpy as np
import pytest
import sympy as sp
from sympy.core.cache import clear_cache

from eom.errors import InputError
from eom.exact.identity import equal
from eom.mass import solids
from eom.mass.inertia import check_matrix, check_principal_moments
from eom.mass.regions import check, properties
from eom.mass.solids import CENTRE, SOLIDS, check_sizes, inertia, mass_properties, principal_moments
from eom.scenes.scene import Scene
from eom.scenes.start import constants
from tests.clock import calls
from tests.eom.rows import every, only

m, a, b, c, r, h, r1, r2, H, B, T, R, q = (
    sp.Symbol(n, positive=True)
    for n in "mass a b c radius length inner_radius outer_radius height base_radius top_radius "
    "ring_radius tube_radius".split()
)


def diagonal(*moments):
    return sp.diag(*moments)


def symmetric(i, j, *moments, off):
    J = sp.diag(*moments)
    J[i, j] = J[j, i] = off
    return J


thick = 2 * m * (r2**5 - r1**5) / (5 * (r2**3 - r1**3))
across = m * (3 * (r1**2 + r2**2) + h**2) / 12

lifted = 16 / (9 * sp.pi**2)  # the square of 4 r / (3 pi), from the base to the centroid

# Meriam, Kraige, Bolton, Engineering Mechanics: Dynamics, tables D/3 and D/4, about the centre of
# mass; pyramid, prism and hollow sphere: Beer, Johnston, Vector Mechanics, appendix; composition.
EXPECTED = {
    "box": diagonal(m * (b**2 + c**2) / 12, m * (a**2 + c**2) / 12, m * (a**2 + b**2) / 12),
    "cylinder": diagonal(*(m * (3 * r**2 + h**2) / 12,) * 2, m * r**2 / 2),
    "hollow cylinder": diagonal(across, across, m * (r1**2 + r2**2) / 2),
    "elliptical cylinder": diagonal(
        m * (3 * b**2 + h**2) / 12, m * (3 * a**2 + h**2) / 12, m * (a**2 + b**2) / 4
    ),
    "cylindrical shell": diagonal(*(m * (6 * r**2 + h**2) / 12,) * 2, m * r**2),
    "cone": diagonal(*(3 * m * (4 * r**2 + H**2) / 80,) * 2, 3 * m * r**2 / 10),
    "conical shell": diagonal(*(m * (r**2 / 4 + H**2 / 18),) * 2, m * r**2 / 2),
    "sphere": diagonal(*(2 * m * r**2 / 5,) * 3),
    "hollow sphere": diagonal(thick, thick, thick),
    "spherical shell": diagonal(*(2 * m * r**2 / 3,) * 3),
    "hemisphere": diagonal(*(83 * m * r**2 / 320,) * 2, 2 * m * r**2 / 5),
    "hemispherical shell": diagonal(*(5 * m * r**2 / 12,) * 2, 2 * m * r**2 / 3),
    "ellipsoid": diagonal(m * (b**2 + c**2) / 5, m * (a**2 + c**2) / 5, m * (a**2 + b**2) / 5),
    "torus": diagonal(*(m * (4 * R**2 + 5 * q**2) / 8,) * 2, m * (R**2 + 3 * q**2 / 4)),
    "rod": diagonal(*(m * h**2 / 12,) * 2, 0),
    "ring": diagonal(*(m * r**2 / 2,) * 2, m * r**2),
    "disc": diagonal(m * r**2 / 4, m * r**2 / 4, m * r**2 / 2),
    "annulus": diagonal(*(m * (r1**2 + r2**2) / 4,) * 2, m * (r1**2 + r2**2) / 2),
    "semicircular disc": diagonal(
        m * r**2 * (sp.Rational(1, 4) - lifted),
        m * r**2 / 4,
        m * r**2 * (sp.Rational(1, 2) - lifted),
    ),
    "elliptical disc": diagonal(m * b**2 / 4, m * a**2 / 4, m * (a**2 + b**2) / 4),
    "rectangular plate": diagonal(m * b**2 / 12, m * a**2 / 12, m * (a**2 + b**2) / 12),
    "triangular plate": symmetric(
        0, 1, m * b**2 / 18, m * a**2 / 18, m * (a**2 + b**2) / 18, off=m * a * b / 36
    ),
    "triangular prism": symmetric(
        *(0, 1, m * (2 * b**2 + 3 * h**2) / 36, m * (2 * a**2 + 3 * h**2) / 36),
        m * (a**2 + b**2) / 18,
        off=m * a * b / 36,
    ),
    "pyramid": diagonal(
        m * (4 * b**2 + 3 * H**2) / 80, m * (4 * a**2 + 3 * H**2) / 80, m * (a**2 + b**2) / 20
    ),
    "tetrahedron": sp.Matrix(
        [
            [3 * m * (b**2 + c**2) / 80, m * a * b / 80, m * a * c / 80],
            [m * a * b / 80, 3 * m * (a**2 + c**2) / 80, m * b * c / 80],
            [m * a * c / 80, m * b * c / 80, 3 * m * (a**2 + b**2) / 80],
        ]
    ),
    # A difference of two cones; tested below.
    "frustum": None,
}

# The same tables, about other points, and the distance of the centre of mass from them.
ABOUT = {
    ("cone", "apex"): (3 * m * r**2 / 20 + 3 * m * H**2 / 5, 3 * H / 4),
    ("cone", "base"): (3 * m * r**2 / 20 + m * H**2 / 10, -H / 4),
    ("conical shell", "apex"): (m * r**2 / 4 + m * H**2 / 2, 2 * H / 3),
    ("conical shell", "base"): (m * r**2 / 4 + m * H**2 / 6, -H / 3),
    ("cylinder", "base"): (m * r**2 / 4 + m * h**2 / 3, h / 2),
    ("cylindrical shell", "base"): (m * r**2 / 2 + m * h**2 / 3, h / 2),
    ("hemisphere", "base"): (2 * m * r**2 / 5, 3 * r / 8),
    ("hemispherical shell", "base"): (2 * m * r**2 / 3, r / 2),
    ("rod", "end"): (m * h**2 / 3, h / 2),
    ("triangular plate", "corner"): (m * b**2 / 6, 0),
    ("tetrahedron", "corner"): (m * (b**2 + c**2) / 10, c / 4),
    ("sphere", "pole"): (7 * m * r**2 / 5, -r),
    ("box", "corner"): (m * (b**2 + c**2) / 3, c / 2),
    ("pyramid", "base"): (m * (b**2 + 2 * H**2) / 20, H / 4),
    ("pyramid", "apex"): (m * (b**2 + 12 * H**2) / 20, -3 * H / 4),
    ("frustum", "base"): (None, H * (B**2 + 2 * B * T + 3 * T**2) / (4 * (B**2 + B * T + T**2))),
    ("disc", "rim"): (m * r**2 / 4, 0),
}
EVERY_POINT = [(name, p) for name, solid in SOLIDS.items() for p in (CENTRE, *solid.points)]


def test_every_solid_has_an_expected_formula():
    assert set(EXPECTED) == set(SOLIDS)


@pytest.mark.parametrize("name", [n for n, J in EXPECTED.items() if J is not None])
def test_inertia_is_the_published_one(name):
    found = inertia(name)
    assert all(equal(e, f) for e, f in zip(found, EXPECTED[name], strict=True))
    if found.is_diagonal():
        assert principal_moments(name) == (found[0, 0], found[1, 1], found[2, 2])


@pytest.mark.parametrize(("name", "point"), ABOUT)
def test_other_points_are_the_published_ones(name, point):
    J11, distance = ABOUT[name, point]
    body = mass_properties(name, point)
    assert equal(body.centre[2], distance)
    assert J11 is None or equal(body.inertia[0, 0], J11)


def test_sizes_are_the_only_symbols():
    for name, point in EVERY_POINT:
        symbols = mass_properties(name, point).inertia.free_symbols
        assert {s.name for s in symbols} == {"mass", *SOLIDS[name].sizes}, (name, point)


@pytest.mark.parametrize("name", SOLIDS)
def test_centre_of_mass_is_the_origin_of_central_moments(name):
    body = mass_properties(name)
    assert list(body.first_moment) == [0, 0, 0]
    assert body.inertia == body.about_centre == solids.central_inertia(name)


# cubature


def random_sizes(name, seed):
    """Sizes from 0.2 to 5 m that meet the conditions of the solid."""
    generator = random.Random(f"{name} {seed}")
    sizes = {n: generator.uniform(0.2, 5.0) for n in SOLIDS[name].sizes}
    for small, large in SOLIDS[name].smaller:
        sizes[small], sizes[large] = sorted((sizes[small], sizes[large]))
    return sizes


@cache
def compiled(name):
    region, sizes = SOLIDS[name].region, [sp.Symbol(n, positive=True) for n in SOLIDS[name].sizes]
    outer = [[p for p, _, _ in region.bounds[k + 1 :]] for k in range(region.dimension)]
    limits = [
        sp.lambdify([*later, *sizes], bound[1:], "numpy")
        for bound, later in zip(region.bounds, outer, strict=True)
    ]
    return sp.lambdify([*region.parameters, *sizes], region.position, "numpy"), limits


def points_and_weights(name, sizes, count=20):
    """Parameters (columns) and weights by Gauss and Legendre's rule, outermost first."""
    _, limits = compiled(name)
    nodes, weights = np.polynomial.legendre.leggauss(count)
    points, total = np.zeros((0, 1)), np.ones(1)
    for limit in reversed(limits):
        low, high = (np.broadcast_to(e, total.shape) for e in limit(*points, *sizes.values()))
        half = (high - low) / 2
        new = low[:, None] + half[:, None] * (nodes + 1)
        points = np.vstack([new.reshape(1, -1), np.repeat(points, count, axis=1)])
        total = (total[:, None] * half[:, None] * weights).ravel()
    return points, total


def by_cubature(name, sizes):
    """Mass, first and second moments at unit density.

    The element is that of the positions, differentiated numerically by complex steps.
    """
    position, _ = compiled(name)
    points, weights = points_and_weights(name, sizes)

    def place(values):
        rows = position(*values, *sizes.values())
        return np.array([np.broadcast_to(row, weights.shape) for row in rows])

    steps = 1e-30j * np.eye(len(points))
    columns = [place(points + step[:, None]).imag / 1e-30 for step in steps]
    jacobian = np.stack(columns, axis=1).transpose(2, 0, 1)
    gram = np.linalg.det(jacobian.transpose(0, 2, 1) @ jacobian)
    dm = weights * np.sqrt(np.maximum(gram, 0))
    r = place(points)
    return dm.sum(), r @ dm, (r * dm) @ r.T


def cubature_error(name, seed):
    """Greatest error of the second moments about the origin, relative to their trace."""
    sizes = random_sizes(name, seed)
    values = {sp.Symbol(n, positive=True): v for n, v in sizes.items()}
    _, _, second = by_cubature(name, sizes)
    found = np.array(properties_of(name).second_moments.subs(values), dtype=float)
    return float(np.abs(found - second).max() / np.trace(second))


@pytest.mark.parametrize("seed", only(range(3), 0))
@pytest.mark.parametrize(("name", "point"), EVERY_POINT)
def test_closed_forms_against_cubature(name, point, seed):
    sizes = random_sizes(name, seed)
    values = {sp.Symbol(n, positive=True): v for n, v in sizes.items()}
    volume, first, second = by_cubature(name, sizes)
    origin = (
        first / volume
        if point == CENTRE
        else np.array([float(sp.sympify(p).subs(values)) for p in SOLIDS[name].points[point]])
    )
    assert float(properties_of(name).mass.subs(values)) == pytest.approx(volume, rel=1e-10)
    density = 2.5 / volume
    c = density * (first - volume * origin)
    cross = np.outer(first, origin)
    S = density * (second - cross - cross.T + volume * np.outer(origin, origin))
    body = mass_properties(name, point)
    values[m] = 2.5
    found_c = np.array(body.first_moment.subs(values), dtype=float).ravel()
    found_J = np.array(body.inertia.subs(values), dtype=float)
    J = np.trace(S) * np.eye(3) - S
    length = max(sizes.values())
    assert found_c == pytest.approx(c, rel=1e-10, abs=1e-10 * length)
    assert found_J == pytest.approx(J, rel=1e-10, abs=1e-10 * np.trace(J))


@cache
def properties_of(name):
    return properties(SOLIDS[name].region)


@pytest.mark.parametrize("name", every(3, SOLIDS))
def test_every_region_passes_its_own_check(name):
    check(SOLIDS[name].region, random_sizes(name, 7))


def test_every_solid_is_a_possible_body():
    """But for a rod along itself; the error of another one would name it."""
    for name, point in EVERY_POINT:
        if (name, point) in {("rod", CENTRE), ("rod", "end")}:
            continue
        values = {sp.Symbol(n, positive=True): v for n, v in random_sizes(name, 3).items()}
        J = inertia(name, point).subs({**values, m: 2.0})
        check_matrix([[float(e) for e in J.row(i)] for i in range(3)], name)


# limits, sums and holes


def about(name, **sizes):
    """Moments of mass at unit density about the origin of the region's coordinates."""
    renamed = {sp.Symbol(n, positive=True): v for n, v in sizes.items()}
    body = properties_of(name)
    return type(body)(
        body.mass.subs(renamed, simultaneous=True),
        body.first_moment.subs(renamed, simultaneous=True),
        body.second_moments.subs(renamed, simultaneous=True),
    )


def same(one, two):
    entries = [
        (one.mass, two.mass),
        *zip(one.first_moment, two.first_moment, strict=True),
        *zip(one.second_moments, two.second_moments, strict=True),
    ]
    return all(equal(left, right) for left, right in entries)


def test_frustum_is_a_cone_less_its_tip():
    """Base at the top here: cones hang from their apex."""
    depth = H * T / (B - T)
    turned = sp.diag(1, -1, -1)
    whole = about("cone", radius=B, height=H + depth).rotated(turned).shifted((0, 0, -H - depth))
    tip = about("cone", radius=T, height=depth).rotated(turned).shifted((0, 0, -H - depth))
    assert same(whole - tip.shifted((0, 0, 0)), about("frustum"))


def test_frustum_of_equal_radii_is_a_cylinder_and_one_without_top_a_cone():
    cylinder = about("cylinder", radius=B, length=H).shifted((0, 0, -H / 2))
    assert same(about("frustum", top_radius=B), cylinder)
    cone = about("cone", radius=B, height=H).rotated(sp.diag(1, -1, -1)).shifted((0, 0, -H))
    assert same(about("frustum", top_radius=sp.S.Zero), cone)


def test_hollow_bodies_are_differences():
    assert same(about("sphere", radius=r2) - about("sphere", radius=r1), about("hollow sphere"))
    bored = about("cylinder", radius=r2) - about("cylinder", radius=r1)
    assert same(bored, about("hollow cylinder"))


def test_two_halves_are_a_whole():
    half = about("hemisphere")
    assert same(half + half.rotated(sp.diag(1, -1, -1)), about("sphere"))
    shell = about("hemispherical shell")
    assert same(shell + shell.rotated(sp.diag(1, -1, -1)), about("spherical shell"))
    plate = about("triangular plate").shifted((a / 2, b / 2, 0))
    assert same(plate + plate.rotated(sp.diag(-1, -1, 1)), about("rectangular plate"))
    prism = about("triangular prism", length=c).shifted((a / 2, b / 2, 0))
    assert same(prism + prism.rotated(sp.diag(-1, -1, 1)), about("box"))


def limit(name, **sizes):
    renamed = {sp.Symbol(n, positive=True): v for n, v in sizes.items()}
    return [e.subs(renamed) for e in principal_moments(name)]


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (("cylinder", {"length": 0}), ("disc", {})),
        (("ellipsoid", {"a": r, "b": r, "c": r}), ("sphere", {})),
        (("elliptical cylinder", {"a": r, "b": r}), ("cylinder", {})),
        (("hollow cylinder", {"inner_radius": 0, "outer_radius": r}), ("cylinder", {})),
        (("hollow cylinder", {"inner_radius": r, "outer_radius": r}), ("cylindrical shell", {})),
        (("hollow sphere", {"inner_radius": 0, "outer_radius": r}), ("sphere", {})),
        (("hollow sphere", {"inner_radius": r, "outer_radius": r}), ("spherical shell", {})),
        (("cylindrical shell", {"length": 0}), ("ring", {})),
        (("torus", {"tube_radius": 0, "ring_radius": r}), ("ring", {})),
        (("cylinder", {"radius": 0}), ("rod", {})),
        (("box", {"a": 0, "b": 0, "c": h}), ("rod", {})),
        (("box", {"c": 0}), ("rectangular plate", {})),
        (("cone", {"height": 0}), ("frustum", {"top_radius": 0, "base_radius": r, "height": 0})),
        (("conical shell", {"height": 0}), ("disc", {})),
    ],
)
def test_limits_join_the_solids(one, two):
    pairs = zip(limit(one[0], **one[1]), limit(two[0], **two[1]), strict=True)
    assert all(equal(left, right) for left, right in pairs)


VOLUMES = {
    "sphere": 4 * sp.pi * r**3 / 3,
    "cylinder": sp.pi * r**2 * h,
    "cone": sp.pi * r**2 * H / 3,
    "conical shell": sp.pi * r * sp.sqrt(r**2 + H**2),
    "box": a * b * c,
    "disc": sp.pi * r**2,
    "torus": 2 * sp.pi**2 * R * q**2,
    "ellipsoid": 4 * sp.pi * a * b * c / 3,
    "tetrahedron": a * b * c / 6,
    "pyramid": a * b * H / 3,
    "ring": 2 * sp.pi * r,
    "rod": h,
    "spherical shell": 4 * sp.pi * r**2,
}


@pytest.mark.parametrize("name", VOLUMES)
def test_volumes_areas_and_lengths(name):
    assert equal(SOLIDS[name].region.moment(1), VOLUMES[name])


# time


@pytest.mark.parametrize("name", every(4, SOLIDS))
def test_inertia_from_cold_is_quick(name, monkeypatch):
    """About 0.2 s at most; SymPy's integrator is out of reach."""
    monkeypatch.setattr(sp, "integrate", None)
    region = SOLIDS[name].region
    for kept in ("element", "_mass_element"):
        region.__dict__.pop(kept, None)
    solids._about_origin.cache_clear()
    solids.central_inertia.cache_clear()
    clear_cache()
    assert calls(inertia, name) < 800_000


# bad input


def test_unknown_solid_comes_with_near_matches():
    for function in (principal_moments, inertia, mass_properties):
        with pytest.raises(InputError, match="cilinder") as caught:
            function("cilinder")
        assert "cylinder" in caught.value.hint


def test_unknown_point_comes_with_the_known_ones():
    with pytest.raises(InputError, match="unknown point 'apx'") as caught:
        inertia("cone", "apx")
    assert "apex" in caught.value.hint
    with pytest.raises(InputError, match="unknown point"):
        inertia("sphere", "apex")


@pytest.mark.parametrize("name", ["tetrahedron", "triangular plate", "triangular prism"])
def test_no_principal_moments_along_other_axes(name):
    with pytest.raises(InputError, match="no principal axes") as caught:
        principal_moments(name)
    assert "inertia" in caught.value.hint


SIZES = {
    "too few": ("cylinder", {"radius": 1.0}, "sizes of a cylinder"),
    "others": ("cylinder", {"radius": 1.0, "height": 1.0}, "sizes of a cylinder"),
    "too many": ("sphere", {"radius": 1.0, "length": 1.0}, "sizes of a sphere"),
    "zero": ("sphere", {"radius": 0.0}, "radius is not positive"),
    "negative": ("sphere", {"radius": -1.0}, "radius is not positive"),
    "not a number": ("sphere", {"radius": math.nan}, "radius is not positive"),
    "infinite": ("sphere", {"radius": math.inf}, "radius is not positive"),
    "no wall": (
        "hollow sphere",
        {"inner_radius": 1.0, "outer_radius": 1.0},
        "inner radius is not less than outer radius",
    ),
    "inside out": (
        "hollow cylinder",
        {"inner_radius": 2.0, "outer_radius": 1.0, "length": 1.0},
        "inner radius is not less than outer radius",
    ),
    "spindle": (
        "torus",
        {"ring_radius": 1.0, "tube_radius": 1.5},
        "tube radius is not less than ring radius",
    ),
    "unknown": ("blob", {}, "unknown solid"),
}


@pytest.mark.parametrize(("name", "sizes", "what"), SIZES.values(), ids=SIZES)
def test_impossible_sizes_are_refused(name, sizes, what):
    with pytest.raises(InputError, match=what) as caught:
        check_sizes(name, sizes, "[body] size")
    assert caught.value.where == "[body] size"


# scenes


@pytest.mark.parametrize("name", every(4, [n for n in SOLIDS if n != "rod"]))
def test_every_solid_is_the_body_of_a_scene(name):
    sizes = random_sizes(name, 1)
    scene = Scene(body={"solid": name, "mass": 2.5, "size": sizes}, outputs=["omega_1", "T"])
    assert scene.derive().rates
    values = constants(scene)
    numbers = {sp.Symbol(n, positive=True): v for n, v in {**sizes, "mass": 2.5}.items()}
    J = np.array(inertia(name).subs(numbers), dtype=float)
    if "J12" in values:
        assert [values[f"J{i}{j}"] for i in (1, 2, 3) for j in range(i, 4)] == pytest.approx(
            [J[i, j] for i in range(3) for j in range(i, 3)]
        )
    else:
        assert values["I1"] == pytest.approx(J[0, 0])
        check_principal_moments(np.diag(J), name)


def test_scene_of_a_solid_with_full_inertia_equals_that_of_its_matrix():
    sizes = {"a": 1.0, "b": 2.0, "c": 3.0}
    numbers = {sp.Symbol(n, positive=True): v for n, v in {**sizes, "mass": 2.0}.items()}
    matrix = [[float(e) for e in row] for row in inertia("tetrahedron").subs(numbers).tolist()]
    start = {"omega_1": 1, "omega_2": 2, "omega_3": 3}
    one = Scene(body={"solid": "tetrahedron", "mass": 2.0, "size": sizes}, initial=start)
    two = Scene(body={"matrix": matrix}, initial=start)
    assert one.derive().rates == two.derive().rates
    assert one.parameter_values() == pytest.approx(two.parameter_values())


@pytest.mark.parametrize(
    ("body", "model", "what", "where"),
    [
        (
            {"solid": "torus", "mass": 1, "size": {"ring_radius": 1, "tube_radius": 2}},
            "rigid body",
            "tube radius is not less",
            "[body] size",
        ),
        (
            {"solid": "tetrahedron", "mass": 1, "size": {"a": 1, "b": 1, "c": 1}},
            "spinner",
            "symmetric about its axle",
            "[body] solid",
        ),
        (
            {"solid": "rod", "mass": 1, "size": {"length": 1}},
            "rigid body",
            "no moment of inertia about its own axis",
            "[body] solid",
        ),
    ],
)
def test_scenes_refuse_impossible_solids(body, model, what, where):
    with pytest.raises(InputError, match=what) as caught:
        Scene(body=body, model=model)
    assert caught.value.where == where


def test_cone_as_a_spinner_has_its_axis_along_the_axle():
    cone = {"solid": "cone", "mass": 3.0, "size": {"radius": 0.2, "height": 0.1}}
    values = Scene(model="spinner", body=cone, initial={"C": 1}).parameter_values()
    assert values["I2"] == pytest.approx(3 * 3 * 0.2**2 / 10)
    assert values["I1"] == pytest.approx(3 * 3 * (4 * 0.2**2 + 0.1**2) / 80)
