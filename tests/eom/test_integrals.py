"""Antiderivatives differentiate back to the integrand; what has no closed form is refused."""

from __future__ import annotations

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.exact.identity import equal
from eom.exact.integrals import MAX_DEGREE, antiderivative, definite
from tests.draws import examples

x, a, b = (sp.Symbol(n, positive=True) for n in "xab")
phase = sp.Symbol("phase", real=True)
small = st.integers(0, 4)


@pytest.fixture
def no_search(monkeypatch):
    """The rules alone: SymPy's integrator is out of reach."""

    def refuse(*_):
        raise AssertionError("sp.integrate was called")

    monkeypatch.setattr(sp, "integrate", refuse)


@examples(60)
@given(n=small, p=small, q=small, w=st.integers(-3, 3), v=st.sampled_from([0, 1, 2, a]))
def test_antiderivative_differentiates_back(n, p, q, w, v):
    f = a * x**n * sp.sin(w * x + phase) ** p * sp.cos(v * x) ** q + b * x**2 - 3
    F = antiderivative(f, x)
    if F is None:  # w + k a, which may be zero
        assert v == a
        assert p
        assert q
    else:
        assert equal(F.diff(x), f)


@pytest.mark.parametrize(
    "f",
    [
        sp.S.Zero,
        sp.S.One,
        a,
        (a + b * x) ** 5,
        x**3 * sp.sin(x) ** 3 * sp.cos(x) ** 2,
        sp.sin(x) * sp.sin(2 * x) * sp.cos(3 * x + 1),
        sp.sin(a) * x,
        x**7 * sp.cos(a * x),
        sp.sin(x) ** 12,
    ],
)
def test_integrands_within_the_rules(f, no_search):
    assert equal(antiderivative(f, x).diff(x), f)


@pytest.mark.parametrize(
    "f",
    [
        1 / x,
        sp.sqrt(x),
        sp.exp(x),
        sp.sin(x**2),
        1 / sp.cos(x),
        sp.tan(x),
        sp.sin(sp.cos(x)),
        x**a,
        1 / (a + x),
        sp.cos(a * x) * sp.cos(b * x),
        sp.cos(x) ** (MAX_DEGREE + 1),
    ],
)
def test_integrands_outside_the_rules(f):
    assert antiderivative(f, x) is None


@examples(40)
@given(n=small, p=small, q=small, low=st.integers(-3, 3), width=st.integers(0, 4))
def test_definite_integral_against_quadrature(n, p, q, low, width):
    from scipy.integrate import quad

    f = x**n * sp.sin(x) ** p * sp.cos(x) ** q
    found = definite(f, (x, sp.Integer(low), sp.Integer(low + width)))
    numeric = sp.lambdify(x, f, "math")
    expected = quad(numeric, low, low + width, epsabs=1e-13, epsrel=1e-13, limit=200)[0]
    assert float(found) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_constant_factors_stay_as_they_are():
    factor = (a + b) ** 9
    assert definite(factor * x, (x, sp.S.Zero, sp.S.One)) == factor / 2


def test_limits_may_be_expressions(no_search):
    assert sp.expand(definite(x * a, (x, b, a)) - a * (a**2 - b**2) / 2) == 0
    assert definite(sp.S.Zero, (x, b, a)) == 0


def test_search_helps_where_the_rules_do_not_reach():
    assert definite(1 / x, (x, sp.S.One, a)) == sp.log(a)
    assert sp.expand(definite(x * sp.exp(x) + x, (x, sp.S.Zero, sp.S.One))) == sp.Rational(3, 2)


def test_integral_without_closed_form_is_refused():
    with pytest.raises(InputError, match="no closed form") as caught:
        definite(sp.sin(sp.sin(x)), (x, sp.S.Zero, sp.S.One))
    assert "x from 0 to 1" in caught.value.where
    assert "mesh" in caught.value.hint


def test_infinite_integral_is_refused():
    with pytest.raises(InputError, match="not finite"):
        definite(1 / x, (x, sp.S.Zero, sp.S.One))
