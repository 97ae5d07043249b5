"""The isolator of roots in C against mpmath and against polynomials that are made of known roots."""

import ctypes
import itertools
import math
from fractions import Fraction
from functools import cache

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen.loops import crossings
from codegen.native import native

pytestmark = pytest.mark.skipif(not native.compiler(), reason="runs C")
EPSILON = np.finfo(np.float64).eps
FAR, APPROACHED, REPORTED = 0, 1, 2

WRAPPER = """
int isolate(const double *b, double noise, int is_first, int *before, double *at, int *turn) {
    root found[2 * D + 4];
    const int count = roots_of(b, D, noise, is_first, before, found);
    for (int k = 0; k < count; ++k) at[k] = found[k].at, turn[k] = found[k].turn;
    return count;
}
"""


@cache
def library(degree):
    head = f"#include <float.h>\n#include <math.h>\n#define D {degree}\n"
    text = head + crossings._template("roots.c") + crossings._template("touches.c") + WRAPPER
    flags = ("-O2", "-ffp-contract=fast", "-Wall", "-Wextra", "-Werror")
    return native.load(native.compile_library(text, flags), text, flags)


def isolate(b, noise, is_first=False, before=FAR):
    """Places, turns, and how the interval ends."""
    degree = len(b) - 1
    given = (ctypes.c_double * len(b))(*b)
    at, turn = (ctypes.c_double * (2 * degree + 4))(), (ctypes.c_int * (2 * degree + 4))()
    state = ctypes.c_int(before)
    f = library(degree).isolate
    f.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_int, *[ctypes.c_void_p] * 3]
    count = f(given, noise, int(is_first), ctypes.byref(state), at, turn)
    return list(at[:count]), list(turn[:count]), state.value


def exactly(roots, degree, scale=1):
    """Power coefficients, as fractions, of scale times the product of (x - r), times (2 + x) to fill."""
    power = [Fraction(scale)]
    factors = [(-Fraction(r), Fraction(1)) for r in roots]
    factors += [(Fraction(2), Fraction(1))] * (degree - len(roots))
    for low, high in factors:
        power = [low * a + high * b for a, b in zip([*power, 0], [0, *power], strict=True)]
    return power


def bernstein(power):
    """Coefficients in Bernstein form on [0, 1], and the rounding error that a product of doubles has."""
    n = len(power) - 1
    scaled = [a / math.comb(n, k) for k, a in enumerate(power)]
    exact = [sum(math.comb(j, k) * scaled[k] for k in range(j + 1)) for j in range(n + 1)]
    return [float(b) for b in exact], 32 * EPSILON * float(sum(map(abs, power)))


def value(power, x):
    return sum(a * Fraction(x) ** k for k, a in enumerate(power))


def slope(power, x):
    return sum(k * a * Fraction(x) ** (k - 1) for k, a in enumerate(power) if k)


places = st.integers(1, 997).map(lambda k: Fraction(k, 998))


@settings(max_examples=50)
@given(
    st.lists(places, min_size=0, max_size=6, unique=True),
    st.integers(0, 2),
    st.sampled_from([1, -1]),
)
def test_separate_roots_are_all_found_once(roots, more, sign):
    """As far as the rounding of the coefficients moves them, with the directions in turn."""
    degree = [6, 12, 26][more]
    power = exactly(sorted(roots), degree, sign)
    b, noise = bernstein(power)
    at, turn, _ = isolate(b, noise)
    expected = sorted(roots)
    if any(abs(value(power, (r + s) / 2)) <= 4 * noise for r, s in itertools.pairwise(expected)):
        expected = None  # some are one within the rounding
    if expected is not None:
        assert len(at) == len(roots)
        for r, a, d in zip(expected, at, turn, strict=True):
            assert abs(Fraction(a) - r) <= noise / abs(slope(power, r)) + 4 * EPSILON
            assert d == (1 if slope(power, r) > 0 else -1)
    else:
        assert len(at) % 2 == len(roots) % 2 or 0 in turn


def real_roots(b):
    """Roots inside with their slopes, and the largest distance from the rest, to 60 digits."""
    n = len(b) - 1
    exact = [mpmath.mpf(x) for x in b]
    with mpmath.workdps(60):
        power = [math.comb(n, k) * sum((-1) ** (k - j) * math.comb(k, j) * exact[j] for j in range(k + 1))
                 for k in range(n + 1)]  # fmt: skip
        while not power[-1]:
            power.pop()
        roots = mpmath.polyroots(power[::-1], maxsteps=200, extraprec=200) if power[1:] else []
        inside = sorted(r.real for r in roots if abs(r.imag) < 1e-25 and 0 < r.real < 1)
        slopes = [sum(k * a * r ** (k - 1) for k, a in enumerate(power) if k) for r in inside]
    others = [r for r in roots if abs(r.imag) >= 1e-25 or not 0 < r.real < 1]
    near = [r for r in others if abs(r.imag) < 1e-5 and -1e-5 < r.real < 1 + 1e-5]
    return inside, slopes, bool(near)


@pytest.mark.slow
@settings(max_examples=40)
@given(st.lists(st.integers(-1000, 1000).map(lambda k: k / 1000), min_size=4, max_size=13))
def test_random_coefficients_agree_with_mpmath(b):
    """In number, place and direction, where no two roots are nearly one."""
    b[0], b[-1] = b[0] or 1.0, b[-1] or 1.0
    size = max(map(abs, b))
    at, turn, _ = isolate(b, 32 * EPSILON * size)
    inside, slopes, near = real_roots(b)
    signs = [t for t in turn if t]
    assert at == sorted(at)
    assert all(one == -other for one, other in itertools.pairwise(signs))
    assert sum(signs) == (np.sign(b[-1]) - np.sign(b[0])) / 2
    if not near and all(abs(s) > 1e-5 * size for s in slopes):
        assert turn == [int(mpmath.sign(s)) for s in slopes]
        assert all(abs(a - r) < 1e-9 for a, r in zip(at, inside, strict=True))


CLUSTERS = [
    (m, d, k) for m in (2, 3, 4, 5) for d in (0.0, 1e-10, 1e-8, 1e-6, 1e-4) for k in (6, 12, 26)
]


@pytest.mark.sparse
@pytest.mark.parametrize(("many", "apart", "degree"), CLUSTERS)
def test_clusters_are_one_within_the_noise_and_apart_beyond_it(many, apart, degree):
    roots = [Fraction(3, 7) + k * Fraction(apart) for k in range(many)]
    power = exactly([*roots, Fraction(9, 10)], degree)
    b, noise = bernstein(power)
    between = [abs(float(value(power, (r + s) / 2))) for r, s in itertools.pairwise(roots)]
    at, turn, _ = isolate(b, noise)
    assert at[-1] == pytest.approx(0.9, abs=1e-11)
    if not any(noise / 4 < v < 4 * noise for v in between):
        merged = 1 + sum(v > noise for v in between)
        assert len(at) == merged + 1 or apart == 0
        if merged == 1:
            assert turn[:-1] == [0 if many % 2 == 0 else -turn[-1]]
    spread = max((noise / 32 / abs(float(exact_slope(power, many)))) ** (1 / many), many * apart)
    assert all(abs(a - 3 / 7) < 20 * spread + 1e-14 for a in at[:-1])


def exact_slope(power, order):
    """The derivative of that order at 3/7 over its factorial."""
    return sum(
        math.comb(k, order) * a * Fraction(3, 7) ** (k - order)
        for k, a in enumerate(power)
        if k >= order
    )


# --- one polynomial in two intervals --------------------------------------------------------------


def shifted(power, start, length):
    """Power coefficients of p(start + length x)."""
    return [sum(math.comb(k, j) * a * start ** (k - j) for k, a in enumerate(power) if k >= j) * length**j
            for j in range(len(power))]  # fmt: skip


def in_two(power, cut):
    """Turns over [0, cut] and then [cut, 1], as steps of an integrator follow each other."""
    found, state = [], FAR
    for k, (start, length) in enumerate([(Fraction(0), cut), (cut, 1 - cut)]):
        b, noise = bernstein(shifted(power, start, length))
        at, turn, state = isolate(b, noise, is_first=k == 0, before=state)
        found += [(float(start + Fraction(a) * length), t) for a, t in zip(at, turn, strict=True)]
    return found


offsets = st.integers(1, 17).flatmap(lambda k: st.sampled_from([0.0, 10.0**-k, -(10.0**-k)]))


@settings(max_examples=80)
@given(offsets, st.sampled_from([6, 12, 26]), st.sampled_from([1, -1]))
def test_a_crossing_at_the_end_of_an_interval_is_found_once(offset, degree, sign):
    root = Fraction(2, 5)
    power = exactly([root], degree, sign)
    found = in_two(power, Fraction(float(root)) + Fraction(offset))
    assert [t for _, t in found] == [sign]
    assert found[0][0] == pytest.approx(0.4, abs=1e-15)


@settings(max_examples=80)
@given(offsets, st.sampled_from([6, 12, 26]), st.sampled_from([1, -1]))
def test_a_touch_at_the_end_of_an_interval_is_found_once(offset, degree, sign):
    """Rounding may put the computed value at the end on the other side: then it is crossed twice."""
    root = Fraction(2, 5)
    power = exactly([root, root], degree, sign)
    cut = Fraction(float(root)) + Fraction(offset)
    found = in_two(power, cut)
    assert [t for _, t in found] == [0]
    assert found[0][0] == pytest.approx(0.4, abs=1e-7)


@pytest.mark.parametrize("degree", [2, 6, 26])
@pytest.mark.parametrize("place", [Fraction(1, 2), Fraction(1, 4), Fraction(3, 8), Fraction(1, 3)])
def test_roots_at_the_places_of_halving(degree, place):
    for roots, expected in (([place], [1]), ([place, place], [0])):
        b, noise = bernstein(exactly(roots, degree))
        at, turn, _ = isolate(b, noise)
        assert turn == expected
        assert at[0] == pytest.approx(float(place), abs=1e-8 if expected == [0] else 1e-14)


@pytest.mark.parametrize("degree", [2, 6, 26])
def test_zeros_at_both_ends(degree):
    """A zero at the end counts, one at the start only where nothing was before."""
    b, noise = bernstein(exactly([0, 1], degree))
    assert isolate(b, noise)[:2] == ([1.0], [1])
    assert isolate(b, noise, is_first=True)[:2] == ([0.0, 1.0], [-1, 1])
    touched, noise = bernstein(exactly([1, 1], degree))
    assert isolate(touched, noise)[:2] == ([1.0], [0])


def test_nothing_where_all_is_zero_or_far():
    assert isolate([0.0] * 6, 1e-15)[:2] == ([], [])
    assert isolate([0.0] * 6, 1e-15, is_first=True)[:2] == ([0.0], [0])
    assert isolate([1e-300, 2e-300, 1e-300], 1e-320)[:2] == ([], [])
    assert isolate([-1e-300, 2e-300, 1e300], 1e280)[1] == [1]


def test_interpolation_gives_back_bernstein_coefficients():
    nodes, matrix = crossings.interpolation(crossings.DEGREE)
    n = crossings.DEGREE
    b = np.cos(np.arange(n + 1.0))
    values = [
        sum(math.comb(n, j) * b[j] * x**j * (1 - x) ** (n - j) for j in range(n + 1)) for x in nodes
    ]
    assert np.allclose(np.array(matrix) @ values, b, atol=1e3 * EPSILON)
