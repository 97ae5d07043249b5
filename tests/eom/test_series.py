"""Power series over a field: its laws, and known functions to fifty digits by mpmath."""

import random
from fractions import Fraction

import mpmath as mp
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.exact import series
from eom.exact.series import Series
from eom.fields import Field, Singular
from tests.draws import examples

LENGTH = 6
FIELDS = (Field(0), Field(), Field(1009))
fields = st.sampled_from(FIELDS)
fractions = st.fractions(-20, 20, max_denominator=9)


def of(field, values):
    return Series(field, tuple(field.of(v.numerator, v.denominator) for v in values))


def some(size=LENGTH):
    return st.lists(fractions, min_size=size, max_size=size)


@st.composite
def several(draw, count):
    field = draw(fields)
    return [of(field, draw(some())) for _ in range(count)]


@given(several(3))
def test_series_form_a_commutative_ring(abc):
    a, b, c = abc
    assert a + b == b + a
    assert a * b == b * a
    assert (a * b) * c == a * (b * c)
    assert a * (b + c) == a * b + a * c
    assert (a - a).is_zero
    assert a.scaled(3) == a + a + a


@given(several(2))
def test_the_product_rule(ab):
    a, b = ab
    assert (a * b).derivative() == a.derivative() * b + a * b.derivative()
    assert len((a * b).derivative().coefficients) == LENGTH - 1


@given(several(1))
def test_a_series_times_its_reciprocal_is_one(one):
    (a,) = one
    if a.coefficients[0] == 0:
        with pytest.raises(Singular):
            a.reciprocal()
    else:
        assert a * a.reciprocal() == series.constant(a.field, 1, LENGTH)


@given(some(), some())
def test_rationals_and_primes_agree(p, q):
    """A rational result, reduced modulo the prime, is the result modulo the prime."""
    plain, modular = FIELDS[:2]

    def both(rule):
        exact, reduced = (rule(of(f, p), of(f, q)) for f in (plain, modular))
        assert of(modular, exact.coefficients) == reduced

    both(lambda a, b: a * b - b.derivative())
    if q[0]:
        both(lambda a, b: a * b.reciprocal())


def test_an_operation_keeps_the_coefficients_that_are_known():
    field = FIELDS[0]
    long, short = of(field, [Fraction(1)] * 5), of(field, [Fraction(2)] * 3)
    for result in (long + short, long * short, short - long):
        assert len(result.coefficients) == 3
    with pytest.raises(InputError, match="more derivatives"):
        _ = series.constant(field, 1, 1).derivative().is_zero


@pytest.mark.parametrize("field", FIELDS)
def test_zero_has_no_inverse(field):
    with pytest.raises(Singular):
        field.inverse(0)
    assert field.reduce(field.of(3, 4) * 4) == 3
    assert field.reduce(field.inverse(7) * 7) == 1


def test_a_fraction_without_a_value_is_singular_in_every_field():
    for field in FIELDS:
        with pytest.raises(Singular):
            field.of(1, 0)


@pytest.mark.parametrize("field", FIELDS)
def test_random_elements_are_not_zero_and_repeat_with_the_seed(field):
    drawn = [field.draw(random.Random(5)) for _ in range(3)]
    assert len(set(drawn)) == 1
    generator = random.Random(1)
    assert all(field.draw(generator) != 0 for _ in range(300))


@examples(25)
@given(some(4), fractions)
def test_sine_and_cosine_against_mpmath(angle, tau):
    """Starting from tan(half the angle) = tau; the series of sin and cos of start + angle(t)."""
    field = FIELDS[0]
    sine, cosine = 2 * tau / (1 + tau**2), (1 - tau**2) / (1 + tau**2)
    s, c = series.sine_cosine(of(field, angle), sine, cosine)
    with mp.workdps(50):
        start = mp.atan2(
            mp.mpf(sine.numerator) / sine.denominator, mp.mpf(cosine.numerator) / cosine.denominator
        )
        rest = [mp.mpf(a.numerator) / a.denominator for a in angle[1:]]

        def at(t):
            return start + sum(a * t**k for k, a in enumerate(rest, 1))

        for found, function in ((s, mp.sin), (c, mp.cos)):
            expected = mp.taylor(lambda t, f=function: f(at(t)), 0, 3)
            for a, b in zip(found.coefficients, expected, strict=True):
                assert mp.almosteq(mp.mpf(a.numerator) / a.denominator, b, 1e-30, 1e-30)


def identity(field, length=LENGTH):
    return tuple(
        tuple(series.constant(field, int(i == j), length) for j in range(3)) for i in range(3)
    )


def vectors(count):
    return several(3 * count).map(lambda s: [tuple(s[3 * k : 3 * k + 3]) for k in range(count)])


@examples(30)
@given(vectors(1))
def test_cayley_gives_right_handed_orthonormal_rotations_about_the_vector(one):
    (s,) = one
    try:
        C = series.cayley(s)
    except Singular:
        return
    assert series.product(C, series.transpose(C)) == identity(C[0][0].field)
    assert series.cross(C[0], C[1]) == C[2]
    assert series.apply(C, s) == s


def test_cayley_of_a_right_angle_turns_the_frame_not_the_vector():
    """Gibbs vector (0, 0, 1): x is (0, -1, 0) in a frame that is a quarter turn ahead."""
    field = FIELDS[0]
    axis = tuple(series.constant(field, k, 2) for k in (0, 0, 1))
    x = tuple(series.constant(field, k, 2) for k in (1, 0, 0))
    turned = series.apply(series.cayley(axis), x)
    assert [c.coefficients[0] for c in turned] == [0, -1, 0]


@examples(30)
@given(vectors(3))
def test_identities_of_vectors_and_matrices(abc):
    a, b, c = abc
    field = a[0].field
    assert series.apply(series.skew(a), b) == series.cross(a, b)
    assert series.dot(a, series.cross(b, c)) == series.dot(series.cross(a, b), c)
    m = (a, b, c)
    try:
        inverse = series.inverse(m)
    except Singular:
        assert series.dot(a, series.cross(b, c)).coefficients[0] == 0
        return
    assert series.product(m, inverse) == series.product(inverse, m) == identity(field)


@examples(20)
@given(vectors(1))
def test_angular_velocity_obeys_poisson(one):
    (s,) = one
    try:
        C = series.cayley(s)
    except Singular:
        return
    w = series.angular_velocity(C)
    rate = series.each(Series.derivative, C)
    turned = series.product(series.skew(w), C)
    assert rate == series.each(lambda e: -e, turned)


def test_spin_momentum_is_that_about_the_moving_centre():
    """Two masses m, m at +-(cos t, sin t, 0) on a centre that moves: 2 m about axis 3."""
    field = FIELDS[0]
    t = of(field, [Fraction(0), Fraction(1), *[Fraction(0)] * 3])
    s, c = series.sine_cosine(t, 0, 1)
    path = tuple(
        of(field, [Fraction(k), Fraction(2), Fraction(k)] + [Fraction(0)] * 2) for k in range(3)
    )
    arm = (c, s, s - s)
    places = [series.add(path, arm), series.subtract(path, arm)]
    masses = [series.constant(field, 3, 5)] * 2
    assert series.centre(masses, places) == path
    h = series.spin_momentum(masses, places)
    assert [x.coefficients for x in h] == [(0,) * 4, (0,) * 4, (6, 0, 0, 0)]
