"""Moments of inertia of the solids against published tables and numerical integration."""

from __future__ import annotations

import math

import pytest
import sympy as sp
from scipy.integrate import tplquad

from eom import solids
from eom.errors import InputError
from eom.inertia import check_principal_moments
from eom.solids import SOLIDS, principal_moments

m, a, b, c, r, h, r1, r2 = (
    sp.Symbol(n, positive=True)
    for n in ("mass", "a", "b", "c", "radius", "length", "inner_radius", "outer_radius")
)

# Meriam, Kraige, Bolton, Engineering Mechanics: Dynamics, table D/4 (I3 about the axis b3).
EXPECTED = {
    "box": (m * (b**2 + c**2) / 12, m * (a**2 + c**2) / 12, m * (a**2 + b**2) / 12),
    "cylinder": (m * (3 * r**2 + h**2) / 12, m * (3 * r**2 + h**2) / 12, m * r**2 / 2),
    "hollow cylinder": (
        m * (3 * (r1**2 + r2**2) + h**2) / 12,
        m * (3 * (r1**2 + r2**2) + h**2) / 12,
        m * (r1**2 + r2**2) / 2,
    ),
    "sphere": (2 * m * r**2 / 5,) * 3,
    "ellipsoid": (m * (b**2 + c**2) / 5, m * (a**2 + c**2) / 5, m * (a**2 + b**2) / 5),
    "disc": (m * r**2 / 4, m * r**2 / 4, m * r**2 / 2),
}


def test_every_solid_has_an_expected_formula():
    assert set(EXPECTED) == set(SOLIDS)


@pytest.mark.parametrize("name", SOLIDS)
def test_moments_are_the_published_ones(name):
    for found, expected in zip(principal_moments(name), EXPECTED[name], strict=True):
        assert sp.simplify(found - expected) == 0


@pytest.mark.parametrize("name", SOLIDS)
def test_sizes_are_the_only_symbols(name):
    symbols = set().union(*(e.free_symbols for e in principal_moments(name)))
    assert {s.name for s in symbols} == {"mass", *SOLIDS[name].sizes}


def numeric(name, values):
    numbers = {sp.Symbol(n, positive=True): v for n, v in values.items()}
    return [float(e.subs(numbers)) for e in principal_moments(name)]


def integrated(limits):
    """I1, I2, I3 for unit mass by triple quadrature over z(x, y), y(x), x."""
    volume = tplquad(lambda z, y, x: 1.0, *limits)[0]
    densities = [
        lambda z, y, x: y * y + z * z,
        lambda z, y, x: x * x + z * z,
        lambda z, y, x: x * x + y * y,
    ]
    return [tplquad(f, *limits, epsabs=1e-12, epsrel=1e-12)[0] / volume for f in densities]


def test_box_against_quadrature():
    limits = (-0.5, 0.5, -0.65, 0.65, -0.85, 0.85)
    found = numeric("box", {"mass": 1.0, "a": 1.0, "b": 1.3, "c": 1.7})
    assert found == pytest.approx(integrated(limits), rel=1e-10)


def test_cylinder_against_quadrature_in_polar_coordinates():
    """Axis along the third coordinate; the element is rho d(rho) d(angle) dz."""
    radius, length = 0.7, 1.9
    limits = (-length / 2, length / 2, 0.0, 2 * math.pi, 0.0, radius)
    volume = math.pi * radius**2 * length
    densities = [
        lambda q, t, z: q * ((q * math.sin(t)) ** 2 + z * z),
        lambda q, t, z: q * ((q * math.cos(t)) ** 2 + z * z),
        lambda q, t, z: q**3,
    ]
    expected = [tplquad(f, *limits, epsabs=1e-12, epsrel=1e-12)[0] / volume for f in densities]
    found = numeric("cylinder", {"mass": 1.0, "radius": radius, "length": length})
    assert found == pytest.approx(expected, rel=1e-10)


def test_limits_join_the_solids():
    thin = [e.subs(h, 0) for e in principal_moments("cylinder")]
    assert thin == [sp.expand(e) for e in principal_moments("disc")]
    ball = [sp.expand(e.subs({a: r, b: r, c: r})) for e in principal_moments("ellipsoid")]
    assert ball == list(principal_moments("sphere"))
    full = [sp.expand(e.subs({r1: 0, r2: r})) for e in principal_moments("hollow cylinder")]
    assert full == [sp.expand(e) for e in principal_moments("cylinder")]
    hoop = principal_moments("hollow cylinder")[2].subs(r1, r2)
    assert sp.simplify(hoop - m * r2**2) == 0
    rod = principal_moments("box")[0].subs({b: 0})
    assert sp.simplify(rod - m * c**2 / 12) == 0


@pytest.mark.parametrize("name", SOLIDS)
def test_every_solid_is_a_possible_body(name):
    sizes = {n: 1.0 + 0.3 * k for k, n in enumerate(SOLIDS[name].sizes)}
    check_principal_moments(numeric(name, {"mass": 2.0, **sizes}), name)


def test_volumes():
    one = sp.Integer(1)
    assert sp.simplify(SOLIDS["sphere"].integral(one) - sp.Rational(4, 3) * sp.pi) in {
        0,
        sp.simplify(sp.Rational(4, 3) * sp.pi * (r**3 - 1)),
    }
    assert sp.simplify(SOLIDS["cylinder"].integral(one) - sp.pi * r**2 * h) == 0
    assert SOLIDS["box"].integral(one) == a * b * c
    assert SOLIDS["disc"].integral(one) == sp.pi * r**2


def test_unknown_solid_comes_with_near_matches():
    with pytest.raises(InputError, match="cilinder") as caught:
        solids.principal_moments("cilinder")
    assert "cylinder" in caught.value.hint
