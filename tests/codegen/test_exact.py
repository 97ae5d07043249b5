"""The torque-free body in closed form, beside 50 digits: Taylor series, and Legendre's integrals.

The second oracle integrates the precession angle by mpmath's ellippi and uses its sn, cn, dn: not
the angle, not the theta functions and not the series of the code.
"""

import itertools
import math
import pickle
from functools import partial

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf

import codegen
import eom
from codegen.closed.elliptic import Modulus, agm, carlson, first_kind, pair, series
from codegen.closed.exact import CHUNK, KINDS, free_body, free_motion
from codegen.closed.polhode import context
from eom.errors import InputError
from tests.draws import nonzero

T_HANDLE = (1.5e-4, 4.0e-4, 5.2e-4)
ATTITUDE = (0.5, -0.1, 0.7, 0.5)
ROUNDING = 2e-15  # of omega, beside its size; asked is 1e-14
TURN = 5e-15  # rad; asked is 1e-13


def product(p, q):
    (a, *v), (b, *w) = p, q
    cross = [v[i - 2] * w[i - 1] - v[i - 1] * w[i - 2] for i in range(3)]
    return [
        a * b - sum(x * y for x, y in zip(v, w, strict=True)),
        *(a * y + b * x + z for x, y, z in zip(v, w, cross, strict=True)),
    ]


def conjugate(q):
    return [q[0], *(-v for v in q[1:])]


def taylor(I, omega, attitude, t, order=36):
    """Both at time t by steps of Taylor series of the differential equations themselves."""
    I, w, q, t = [mpf(v) for v in I], [mpf(v) for v in omega], [mpf(v) for v in attitude], mpf(t)
    k = [(I[i - 2] - I[i - 1]) / I[i] for i in range(3)]
    energy = sum(a * b * b for a, b in zip(I, w, strict=True))
    steps = int(abs(t) * mpmath.sqrt(energy / min(I)) * 2) + 1
    for _ in range(steps):
        W, Q = [[v] for v in w], [[v] for v in q]
        for n in range(order):
            new = [sum(W[i - 2][j] * W[i - 1][n - j] for j in range(n + 1)) for i in range(3)]
            turned = [0, 0, 0, 0]
            for j in range(n + 1):
                step = product([c[j] for c in Q], [0, *(c[n - j] for c in W)])
                turned = [a + b for a, b in zip(turned, step, strict=True)]
            for c, a, b in zip(W, k, new, strict=True):
                c.append(a * b / (n + 1))
            for c, a in zip(Q, turned, strict=True):
                c.append(a / (2 * (n + 1)))
        w, q = ([mpmath.polyval(c[::-1], t / steps) for c in C] for C in (W, Q))
    return w, q


def arranged(I, omega):
    """Axes (first, intermediate, dominant) as (axis, sign) with determinant 1."""
    low, mid, high = sorted(range(3), key=lambda i: mpf(I[i]))
    T2 = sum(a * b * b for a, b in zip(I, omega, strict=True))
    H2 = sum((a * b) ** 2 for a, b in zip(I, omega, strict=True))
    order = (low, mid, high) if T2 * I[mid] <= H2 else (high, mid, low)
    even = order in {(0, 1, 2), (1, 2, 0), (2, 0, 1)}
    return order, (1, 1 if even else -1, 1), T2, H2


def legendre(I, omega, attitude, t):
    """Both at time t by mpmath's elliptic functions, and Euler angles 3-1-3 about H."""
    I, w, t = [mpf(v) for v in I], [mpf(v) for v in omega], mpf(t)
    order, signs, T2, H2 = arranged(I, w)
    A, B, C = (I[i] for i in order)
    x, y, z = (w[i] * s for i, s in zip(order, signs, strict=True))
    H = mpmath.sqrt(H2)
    a1 = mpmath.sqrt((H2 - T2 * C) / (A * (A - C)))
    a2 = mpmath.sqrt((H2 - T2 * C) / (B * (B - C))) * mpmath.sign((C - A) * z)
    a3 = mpmath.sqrt((H2 - T2 * A) / (C * (C - A))) * mpmath.sign(z)
    p = mpmath.sqrt((C - B) * (H2 - T2 * A) / (A * B * C))
    m = (B - A) * (T2 * C - H2) / ((C - B) * (H2 - T2 * A))
    K = mpmath.ellipk(m)
    n, ratio = -((C * a3 / (A * a1)) ** 2) * m, (T2 - H2 / C) * H / (p * (A * a1) ** 2)

    def state(u):
        count = mpmath.nint(u / (2 * K))
        rest = u - 2 * K * count
        sn, cn, dn = (mpmath.ellipfun(name, rest, m=m) for name in ("sn", "cn", "dn"))
        phi = mpmath.atan2(sn, cn)
        integral = mpmath.ellippi(n, phi, m) + 2 * count * mpmath.ellippi(n, m)
        sign = (-1) ** int(count)
        return [a1 * cn * sign, a2 * sn * sign, a3 * dn], ratio * integral

    def euler(v, precession):
        h = [a * b / H for a, b in zip((A, B, C), v, strict=True)]
        nutation, spin = mpmath.atan2(mpmath.hypot(h[0], h[1]), h[2]), mpmath.atan2(h[0], h[1])
        q = [mpf(1), 0, 0, 0]
        for axis, angle in ((3, precession), (1, nutation), (3, spin)):
            turn = [mpmath.cos(angle / 2), 0, 0, 0]
            turn[axis] = mpmath.sin(angle / 2)
            q = product(q, turn)
        return q

    u0 = mpmath.ellipf(mpmath.atan2(y / a2, x / a1), m)
    (v0, f0), (v, f) = state(u0), state(u0 + p * t)
    assert max(abs(a - b) for a, b in zip(v0, (x, y, z), strict=True)) <= mpf(10) ** -30 * H / min(
        I
    )
    r = product(conjugate(euler(v0, mpf(0))), euler(v, H * t / C + f - f0))
    omega, turn = [mpf(0)] * 3, [r[0], 0, 0, 0]
    for i, s, a, b in zip(order, signs, v, r[1:], strict=True):
        omega[i], turn[i + 1] = s * a, s * b
    return omega, product([mpf(c) for c in attitude], turn)


def check(I, omega, attitude, t, oracle, extra=0):
    """Compare one time with an oracle; the sign of the quaternion is left free."""
    w, q = free_body(I, omega, attitude, t)
    with mpmath.workdps(50 + extra):
        W, Q = oracle(I, omega, attitude, t)
        size = mpmath.sqrt(sum(v * v for v in W))
        off = mpmath.sqrt(sum((a - b) ** 2 for a, b in zip(W, map(mpf, w), strict=True))) / size
        sides = (
            sum((s * a - b) ** 2 for a, b in zip(Q, map(mpf, q), strict=True)) for s in (1, -1)
        )
        turn = 2 * mpmath.sqrt(min(sides))
    assert off <= ROUNDING
    assert turn <= TURN
    assert abs(np.linalg.norm(q) - 1) <= 2e-15


CASES = {
    "least": (T_HANDLE, (-1.0, -0.2, 0.3)),
    "greatest": (T_HANDLE, (1.0, 0.3, -2.0)),
    "near the separatrix": (T_HANDLE, (1e-9, 1.0, 1e-8)),
    "separatrix": ((3.0, 2.0, 1.5), (1.0, 0.3, -2.0)),
    "separatrix, backwards": ((1.5, 3.0, 2.0), (-2.0, -1.0, 0.3)),
    "beside the separatrix": ((3.0, 2.0, 1.5), (1.0, 0.3, np.nextafter(-2.0, 0))),
    "beyond the separatrix": ((3.0, 2.0, 1.5), (1.0, 0.3, np.nextafter(-2.0, -3))),
    "nearly spherical": ((1.0, 1 + 1e-15, 1 - 1e-15), (1.0, 0.3, -2.0)),
    "oblate": ((1.0, 1.5, 1.0), (-1.0, 0.3, 2.0)),
    "prolate": ((1.2, 2.0, 1.2), (1.0, -0.3, 2.0)),
    "nearly oblate": ((1.0, 1 + 2e-16, 1.5), (1.0, 0.3, 2.0)),
    "nearly steady": ((1.0, 1.6, 2.0), (1e-200, 1e-9, -1.0)),
    "steady, unstable": ((1.0, 1.6, 2.0), (0.0, -1.3, 0.0)),
    "steady, equal moments": ((1.0, 1.0, 2.0), (0.6, -1.3, 0.0)),
    "spherical": ((2.0, 2.0, 2.0), (0.6, -1.3, 0.4)),
    "rest": ((1.0, 1.6, 2.0), (0.0, 0.0, 0.0)),
    "plate": ((1.0, 1.6, 2.6), (0.3, 1.0, 0.7)),
    "slender": ((1e-3, 1.0, 1.0005), (1.0, 0.3, 0.2)),
}
MEANT = {
    "near the separatrix": "greatest",
    "separatrix, backwards": "separatrix",
    "beside the separatrix": "greatest",
    "beyond the separatrix": "least",
    "oblate": "symmetric",
    "prolate": "symmetric",
    "steady, unstable": "steady",
    "steady, equal moments": "steady",
    **{k.name: k.name for k in KINDS},
}


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", CASES)
def test_against_taylor_series(name):
    I, omega = CASES[name]
    motion = free_motion(I, omega)
    assert motion.kind == MEANT.get(name, motion.kind)
    t = -1.7 if name != "slender" else 0.3
    if any(omega):
        check(I, omega, ATTITUDE, t, taylor)
    else:
        w, q = free_body(I, omega, ATTITUDE, t)
        assert not w.any()
        np.testing.assert_allclose(q, ATTITUDE, rtol=1e-15)


def moments_of(x, y, z):
    return (y + z, z + x, x + y)


masses = st.floats(-5, 0).map(lambda e: 10.0**e)
bodies = st.tuples(masses, masses.map(lambda v: v + 2), masses.map(lambda v: v + 5)).map(
    lambda m: moments_of(*m)
)


@pytest.mark.slow
@given(
    I=bodies,
    order=st.permutations(range(3)),
    omega=st.tuples(*[nonzero(1e-3, 10.0)] * 3),
    phase=nonzero(1e-3, 1e3),
)
def test_against_legendre_integrals(I, order, omega, phase):
    moments = tuple(I[k] for k in order)
    t = phase / math.dist(omega, (0, 0, 0))
    check(moments, omega, ATTITUDE, t, legendre, extra=30)


@pytest.mark.sparse(4)
@pytest.mark.parametrize("turns", [1e3, 1e6, -1e9])
@pytest.mark.parametrize("omega", [(1.0, 0.3, -2.0), (-1.0, -0.2, 0.3), (0.05, 10.0, 0.05)])
def test_errors_do_not_grow_with_time(omega, turns):
    """Better than asked: not even the rounding of the phase is lost."""
    motion = free_motion(T_HANDLE, omega)
    check(T_HANDLE, omega, ATTITUDE, turns * motion.period, legendre, extra=40)
    check(T_HANDLE, omega, ATTITUDE, turns, legendre, extra=40)


@pytest.mark.sparse(3)
@pytest.mark.parametrize("exponent", [1, 3, 8, 20, 75, 150])
@pytest.mark.parametrize("phase", [3.1, 417.3])
def test_complementary_parameter_to_1e_300(exponent, phase):
    """Spin about the intermediate axis: m1 goes as the square of the part about p3."""
    omega = (0.0, -1.0, 10.0**-exponent)
    check((1.0, 1.6, 2.0), omega, ATTITUDE, phase, legendre, extra=3 * exponent + 30)


@pytest.mark.sparse(3)
@pytest.mark.parametrize("exponent", [1, 4, 8, 30, 150])
def test_parameter_to_1e_300(exponent):
    """Spin nearly about an axis; the small components are right beside their own size, too."""
    I, omega, t = (1.0, 1.6, 2.0), (10.0**-exponent, 0.0, 1.0), 211.7
    check(I, omega, ATTITUDE, t, legendre, extra=4 * exponent + 30)
    w, _ = free_body(I, omega, ATTITUDE, t)
    with mpmath.workdps(80 + 4 * exponent):
        W, _ = legendre(I, omega, ATTITUDE, t)
        assert max(abs(mpf(a) - b) for a, b in zip(w[:2], W, strict=False)) <= 1e-14 * omega[0]


@pytest.mark.parametrize(
    "I", [(1e-12, 1.0, 1 + 1e-13), (1.0, 1.0 + 1e-12, 1e-12), (1.0, 1 - 1e-15, 2.0)]
)
def test_extreme_moments(I):
    for omega in ((1.0, 0.3, -2.0), (1e-3, 0.3, 0.2)):
        check(I, omega, ATTITUDE, 52.3, legendre, extra=60)


@pytest.mark.slow
@given(scale=st.integers(-300, 300), omega=st.tuples(*[nonzero(1e-3, 10.0)] * 3))
def test_powers_of_two_scale_exactly(scale, omega):
    """Units of time and of mass change no digit; 2^30 is a spin of 1e9 rad/s."""
    t = np.array([-31.0, 0.0, 0.25, 77.0])
    w, q = free_body(T_HANDLE, omega, ATTITUDE, t)
    faster = np.ldexp(omega, scale)
    v, r = free_body(np.ldexp(T_HANDLE, -scale), faster, ATTITUDE, np.ldexp(t, -scale))
    np.testing.assert_array_equal(np.ldexp(w, scale), v)
    np.testing.assert_array_equal(q, r)


@pytest.mark.slow
@given(omega=st.tuples(*[nonzero(1e-2, 3.0)] * 3), t1=st.integers(-64, 64), t2=st.integers(-64, 64))
def test_group_property(omega, t1, t2):
    """To go on from a rounded state costs what that state's rounding is amplified, linear in time."""
    I = (1.0, 1.1, 2.0)
    middle, attitude = free_body(I, omega, ATTITUDE, t1 / 8)
    w, q = free_body(I, middle, attitude, t2 / 8)
    v, r = free_body(I, omega, ATTITUDE, (t1 + t2) / 8)
    close = 1e-12 * (1 + np.linalg.norm(omega))
    assert np.abs(w - v).max() <= close
    assert min(np.abs(q - r).max(), np.abs(q + r).max()) <= close


@given(I=bodies, omega=st.tuples(*[nonzero(1e-3, 10.0)] * 3), t=nonzero(1e-3, 1e6))
def test_energy_and_momentum(I, omega, t):
    """T, and H in inertial space: the quaternion takes it there."""
    J = np.array(I)
    w, q = free_body(I, omega, ATTITUDE, [0.0, t])
    np.testing.assert_allclose(J @ w**2, J @ np.square(omega), rtol=1e-14)
    H = [
        product(product(r, [0, *(J * v)]), conjugate(r))[1:] for r, v in zip(q.T, w.T, strict=True)
    ]
    assert np.abs(np.subtract(*H)).max() <= 1e-14 * np.linalg.norm(J * omega)


@pytest.mark.parametrize("name", CASES)
def test_quaternion_is_continuous_and_follows_its_equation(name):
    """Central differences at many times, across periods and chunks; no change of sign."""
    I, omega = CASES[name]
    h = 1e-3
    t = np.arange(-CHUNK, CHUNK) * h * 4
    w, q = free_body(I, omega, ATTITUDE, t)
    rate = np.subtract(*(free_body(I, omega, ATTITUDE, t + s * h)[1] for s in (1, -1))) / (2 * h)
    expected = np.stack(product(list(q), [np.zeros_like(t), *w])) / 2
    fastest = 1 + np.abs(w).max()
    assert np.abs(rate - expected).max() <= 1e-6 * fastest**3
    assert np.abs(np.diff(q)).max() <= 4 * h * fastest


def test_agrees_with_integration_of_the_t_handle():
    scene = eom.Scene.ready("t-handle")
    start, t = scene.initial_values(), (0.0, 10.0)
    run = codegen.simulate(
        scene.derive(), start, t, scene.parameter_values(), rtol=1e-12, atol=1e-12
    )
    w, _ = free_body(T_HANDLE, list(start.values()), (1, 0, 0, 0), run.t)
    found = np.stack([run[f"omega_{k}"] for k in (1, 2, 3)])
    assert np.abs(found - w).max() <= 1e-7


def test_agrees_with_integration_of_the_attitude():
    """The conventions of the project: C_BI of the quaternion, and its rates."""
    omega = (0.7, -1.1, 2.3)
    names = ["omega_1", "omega_2", "omega_3", "q0", "q1", "q2", "q3"]
    start = dict(zip(names, (*omega, *ATTITUDE), strict=True))
    parameters = {"I1": 1.0, "I2": 1.6, "I3": 2.0}
    system = eom.free_rigid_body("quaternion")
    run = codegen.simulate(system, start, (0.0, 20.0), parameters, rtol=1e-12, atol=1e-12)
    w, q = free_body((1.0, 1.6, 2.0), omega, ATTITUDE, run.t)
    found = np.stack([run[n] for n in names])
    assert np.abs(found - np.concatenate([w, q])).max() <= 1e-9


def test_symmetric_top_by_elementary_functions():
    """The transverse part turns at (I3 - I1)/I1 w3 in the body (Goldstein, sec. 5.6)."""
    I1, I3, w3, t = 1.0, 1.5, 2.0, np.linspace(-40.0, 40.0, 1001)
    w, _ = free_body((I1, I1, I3), (0.3, 0.0, w3), (1, 0, 0, 0), t)
    rate = (I3 - I1) / I1 * w3
    expected = [0.3 * np.cos(rate * t), 0.3 * np.sin(rate * t), np.full_like(t, w3)]
    np.testing.assert_allclose(w, expected, atol=1e-14)


SIZES = (0.0, 5e-324, 1e-300, -1e-160, 1e-16, -1.0, 1 + 2e-16, 1e9)
BODIES = (
    (1, 1, 1),
    (1, 1, 1 + 2e-16),
    (1e-12, 1, 1),
    (1, 2, 3),
    (2e300, 1e300, 1e300),
    (1, 1.5, 1.5),
)


@pytest.mark.sparse(1)
@pytest.mark.parametrize("I", BODIES)
def test_no_data_give_nan(I):
    """Warnings are errors here, too."""
    for omega in itertools.product(SIZES, repeat=3):
        motion = free_motion(I, omega, ATTITUDE)
        longest = min(1e300, 9e14 / max(motion.form.fastest, 1e-290))
        w, q = motion([0.0, 1e-300, -longest / 1e7, longest])
        assert np.isfinite(w).all()
        assert np.abs(np.linalg.norm(q, axis=0) - 1).max() <= 2e-15
        np.testing.assert_allclose(w[:, 0], omega, rtol=0, atol=3e-15 * math.hypot(*omega))
        np.testing.assert_allclose(q[:, 0], ATTITUDE, rtol=0, atol=2e-15)


@pytest.mark.parametrize("name", CASES)
def test_a_motion_can_be_sent_to_another_process(name):
    motion = free_motion(*CASES[name])
    again = pickle.loads(pickle.dumps(motion))
    assert again == motion
    np.testing.assert_array_equal(again([0.0, 3.7])[1], motion([0.0, 3.7])[1])


def test_shapes():
    motion = free_motion(T_HANDLE, (1.0, 0.3, -2.0))
    for t in (0.5, np.zeros(0), np.zeros((2, 3)), [[1, 2]], np.arange(CHUNK + 1.0)):
        w, q = motion(t)
        assert w.shape == (3, *np.shape(t))
        assert q.shape == (4, *np.shape(t))
    assert motion.period == pytest.approx(3.7908904617824044)


@given(m=st.floats(0, 1), part=st.floats(-1, 1), offset=st.floats(0, 1))
def test_elliptic_functions(m, part, offset):
    """sn, cn, dn and the argument of theta4 against mpmath's own, on both sides of m = 1/2."""
    with mpmath.workdps(50):
        parameter = mpf(m) / 2**60 if part < -0.9 else mpf(m)
        own = Modulus(parameter, 1 - parameter)
        K, K1 = mpmath.ellipk(own.m), mpmath.ellipk(own.m1)
        eta = offset * min(K1, mpf(60))
        u = float(part * min(K, mpf(60)))
        found = series(own, eta).functions(np.array([u]))
        for name, value in zip(("sn", "cn", "dn"), found, strict=False):
            assert abs(mpmath.ellipfun(name, u, m=own.m) - mpf(float(value[0]))) <= 3e-15
        if own.m and own.m1:
            z = mpmath.pi * (u + 1j * eta) / (2 * K)
            value = mpmath.jtheta(4, z, mpmath.exp(-2 * mpmath.pi * K1 / K))
            linear = mpmath.pi * u * eta / (4 * K * K1) if own.m > 0.5 else 0
            angle = math.atan2(float(found[4][0]), float(found[3][0]))
            assert abs(mpmath.arg(value) + linear - angle) <= 3e-15


def test_first_kind_and_pairs():
    with mpmath.workdps(50):
        for m1 in (mpf(10) ** -300, mpf(1) / 3, mpf(1)):
            sine = mpmath.sin(mpf(1))
            with mpmath.workdps(700):
                expected = mpmath.ellipf(mpf(1), 1 - m1)
            found = first_kind(sine, mpmath.cos(mpf(1)), m1)
            assert abs(found / expected - 1) < 1e-48
        split = pair(mpmath.pi)
        assert abs(split.high + mpf(split.low) - mpmath.pi) < 1e-32


REFUSED = {
    "is not positive": ((0.0, 1.0, 1.0), (1, 0, 0), (1, 0, 0, 0), 0.0),
    "exceeds the sum": ((1.0, 1.0, 2.1), (1, 0, 0), (1, 0, 0, 0), 0.0),
    "moments of inertia: not finite": ((1.0, 1.0, np.inf), (1, 0, 0), (1, 0, 0, 0), 0.0),
    "moments of inertia: wrong shape": ((1.0, 1.0), (1, 0, 0), (1, 0, 0, 0), 0.0),
    "angular velocity: not finite": ((1, 1, 1), (np.nan, 0, 0), (1, 0, 0, 0), 0.0),
    "angular velocity: not real": ((1, 1, 1), ("fast", 0, 0), (1, 0, 0, 0), 0.0),
    "angular velocity out of range": ((1, 1, 1), (1e300, 0, 0), (1, 0, 0, 0), 0.0),
    "not a unit quaternion": ((1, 1, 1), (1, 0, 0), (1, 1, 0, 0), 0.0),
    "attitude: wrong shape": ((1, 1, 1), (1, 0, 0), (1, 0, 0), 0.0),
    "times: not finite": ((1, 1, 1), (1, 0, 0), (1, 0, 0, 0), [0.0, np.inf]),
    "time too long": ((1, 1, 1), (1, 0, 0), (1, 0, 0, 0), 1e16),
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_is_refused(message):
    with pytest.raises(InputError, match=message):
        free_body(*REFUSED[message])


def test_rounding_may_break_the_triangle_inequality():
    w, q = free_body((0.1, 0.2, 0.1 + 0.2), (1.0, 2.0, 3.0), (1, 0, 0, 0), 1.0)
    assert np.isfinite([*w, *q]).all()


SCATTERED = st.tuples(st.floats(0.5, 1.0), st.integers(-1000, 1000), st.floats(0.0, 1e-16))


@given(st.lists(SCATTERED, min_size=3, max_size=3), st.sampled_from([None, None, 0, 1, 2]))
def test_means_and_integrals_of_whole_numbers_have_all_digits_whatever_their_sizes(sizes, zero):
    """Of what may be as small beside another as doubles can say, with mpmath at more digits."""
    own, more = context(), mpmath.mp.clone()
    more.dps = own.dps + 30
    values = [own.ldexp(own.mpf(a) + b, e) for a, e, b in sizes]
    if zero is not None:
        values[zero] = own.zero
    x, y, z = map(more.mpf, values)
    close = partial(more.almosteq, rel_eps=2 * own.eps)
    assert close(more.mpf(carlson(*values)), more.elliprf(x, y, z))
    assert close(more.mpf(agm(*values[:2])), more.agm(x, y))
