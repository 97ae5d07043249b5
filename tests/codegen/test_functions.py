"""SymPy's functions in every target: conventions at special points, accuracy, extreme states, refusals."""

import math

import mpmath
import numpy as np
import pytest
import scipy.special
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen import compile as compile_system
from codegen import compiled_jacobian
from codegen.derivatives.derivative import JACOBIAN, jacobian
from codegen.frontend.lower import FUNCTIONS, SUPPORTED, lower_expressions
from codegen.ir.interpret import Point, interpret, interpret_exactly, interpret_with_bound
from codegen.ir.program import RATES
from codegen.ir.special import FAR, bessel
from codegen.native import native
from eom.errors import InputError
from eom.quantities import Definition, Quantity, Singularity
from eom.system import System

pytestmark = pytest.mark.shipped_flags

x, y = sp.symbols("x y", real=True)

CONVENTIONS = [
    sp.floor(x), sp.ceiling(x), sp.frac(x), sp.Mod(x, 3), sp.Mod(x, -3), sp.Mod(x, y), sp.Mod(2, y),
    sp.Heaviside(x), sp.Heaviside(x, 0), sp.Heaviside(x, y), sp.sign(x), sp.Abs(x - 1), sp.acot(x),
    sp.asec(x + 5), sp.acsc(x - 7), sp.asech(1 / (5 + x**2)), sp.acsch(x + sp.Rational(1, 3)),
    sp.acoth(x + 9), sp.sinc(x), sp.sinc(sp.pi * x), sp.real_root(x, 3), sp.cbrt(x**2),
    x ** sp.Rational(4, 3), sp.log(x**2 + 2, 3), 2**x, sp.root(x**2 + 1, 5), sp.Min(x, y, 1),
    sp.Max(x, y, -1), sp.erf(x), sp.erfc(x),
    sp.besselj(0, x), sp.besselj(1, x), sp.besselj(-3, x), sp.besselj(2, y) * x, sp.bessely(0, x**2 + 1),
    sp.bessely(-1, x**2 + 1), sp.exp(x) - 1, 3 * sp.exp(x) - 3, 1 - sp.exp(-x), sp.log(1 + x**2),
    sp.log(1 + sp.Abs(x * y)), sp.sqrt(x**2 + y**2), sp.sqrt(4 * x**2 + y**4), 1 / sp.sqrt(1 + x**2 + y**2),
    (x**2 + y**2 / 9) ** sp.Rational(3, 2), sp.sec(x) + sp.cot(x + 5), sp.coth(x - 9), sp.csch(x - 9),
    sp.Piecewise((x, sp.And(x > 0, sp.floor(x) < 2)), (sp.Mod(y, 2), True)),
]  # fmt: skip


@pytest.fixture(scope="module")
def conventions(target):
    outputs = {f"f{k}": e for k, e in enumerate(CONVENTIONS)}
    rates = {x: sp.Integer(0), y: sp.Integer(0)}
    return compile_system(System.from_rates("conventions", rates, outputs=outputs), target)


@pytest.mark.sparse(8)
@pytest.mark.parametrize("at", [(0, 0.5), (0, -0.5), (1, 1), (-1, 2), (2.5, -1.5), (-2.5, -1.5), (6, 3),
                                (-6, 3), (1e-9, 1.0), (-1e-9, -1.0), (3.75, 0.25), (0.5, 0.0)])  # fmt: skip
def test_values_are_those_of_sympy(at, conventions):
    numbers = dict(zip((x, y), map(sp.Rational, at), strict=True))
    for e, value in zip(CONVENTIONS, conventions.outputs(0.0, at), strict=True):
        try:
            exact = sp.N(e.xreplace(numbers), 30)
        except ZeroDivisionError:
            exact = sp.nan
        if exact.is_real:
            assert value == pytest.approx(float(exact), rel=4e-14, abs=1e-16), e
        else:
            assert not math.isfinite(value), (e, exact)


def test_every_listed_function_is_among_the_supported_ones():
    for f in FUNCTIONS:
        assert f.__name__ in SUPPORTED


def test_functions_that_sympy_writes_otherwise_are_lowered():
    for e in (
        sp.cbrt(x),
        sp.real_root(x, 5),
        sp.exp(x) ** 3,
        sp.sqrt(x) ** 3,
        sp.tan(x) ** -1,
        sp.log(x, y),
    ):
        assert lower_expressions({"f": [e]}, [x, y]).results


# --- digits -------------------------------------------------------------------------------------------

PRECISE = {
    "expm1": (sp.exp(x) - 1, mpmath.expm1),
    "log1p": (sp.log(1 + x), mpmath.log1p),
    "three times": (3 - 3 * sp.exp(-x), lambda v: -3 * mpmath.expm1(-v)),
    "hypot": (sp.sqrt(x**2 + 9 * x**4), lambda v: mpmath.hypot(v, 3 * v * v)),
    "erfc": (sp.erfc(10 + x), lambda v: mpmath.erfc(10 + v)),
    "acot": (sp.acot(1 / x), mpmath.atan),
    "frac": (sp.frac(x + 3), lambda v: (v + 3) % 1),
}


@pytest.mark.parametrize("name", PRECISE)
def test_no_digits_are_lost_where_the_function_keeps_them(name, target):
    e, exact = PRECISE[name]
    compiled = compile_system(System.from_rates(f"precise {name}", {x: e}), target)
    with mpmath.workdps(60):
        for at in (1e-300, 1e-20, 2.0**-60, 1e-9, 1e-3, 0.4):
            if name == "frac" and at < 1e-9:
                continue
            value = compiled.rhs(0.0, [at])[0]
            wanted = exact(mpmath.mpf(at))
            slack = 2.0**-52 * (400 if name == "erfc" else 3 if name != "frac" else 1e10)
            assert abs(value - wanted) <= slack * abs(wanted), at


def test_norms_neither_overflow_nor_underflow(target):
    system = System.from_rates("norms", {x: sp.sqrt(x**2 + y**2), y: x / sp.sqrt(x**2 + y**2)})
    compiled = compile_system(system, target)
    for size in (1e200, 1e-200, 5e-324):
        got = compiled.rhs(0.0, [3 * size, -4 * size])
        np.testing.assert_allclose(got, [5 * size, 0.6], rtol=4e-16)
    slopes = compiled_jacobian(compiled)
    np.testing.assert_allclose(slopes.dense(0.0, [3e200, 4e200])[0], [0.6, 0.8], rtol=1e-15)
    np.testing.assert_array_equal(slopes.dense(0.0, [0.0, 0.0])[0], [0.0, 0.0])


@settings(max_examples=60)
@given(
    st.floats(allow_nan=False, allow_infinity=False),
    st.floats(allow_nan=False, allow_infinity=False),
)
def test_floor_and_mod_are_pythons_for_all_doubles(a, b):
    program = lower_expressions({"f": [sp.floor(x), sp.Mod(x, y)]}, [x, y])
    floor, mod = interpret(program, Point(x=[a, b]))["f"]
    assert floor == math.floor(a)
    if b:
        assert mod == a % b
        exact = interpret_exactly(program, Point(x=[a, b]))["f"][1]
        assert abs(mpmath.mpf(mod) - exact) <= abs(exact) * 2.0**-53
        assert mod == 0 or (mod > 0) == (b > 0)
    else:
        assert math.isnan(mod)


EXTREME = [0.0, -0.0, 5e-324, -5e-324, 1e-300, 0.5, 1.0, -1.0, 2.5, -7.0, 1e16, -1e16, 1e300, -1e300,
           math.inf, -math.inf, math.nan]  # fmt: skip


def test_floor_mod_and_steps_are_the_same_to_the_last_bit_everywhere(target):
    e = [sp.floor(x), sp.ceiling(x), sp.frac(x), sp.Mod(x, y), sp.Heaviside(x), sp.Heaviside(x, y)]
    outputs = {f"f{k}": v for k, v in enumerate(e)}
    system = System.from_rates("exact", {x: sp.Integer(0), y: sp.Integer(0)}, outputs=outputs)
    compiled = compile_system(system, target)
    pairs = [(a, b) for a in EXTREME for b in EXTREME]
    got = compiled.outputs(0.0, np.array(pairs).T)
    for k, pair in enumerate(pairs):
        expected = interpret(compiled.program, Point(x=pair))["outputs"]
        np.testing.assert_array_equal(got[:, k], expected, err_msg=str(pair))


# --- Bessel functions and error functions -------------------------------------------------------------


@pytest.mark.sparse(1)
@pytest.mark.parametrize("order", [0, 1, 2, 7, 12])
def test_bessel_and_error_functions_are_those_of_scipy_within_the_bound(order, target):
    e = [sp.besselj(order, x), sp.bessely(order, sp.Abs(x)), sp.erf(x), sp.erfc(x)]
    outputs = {f"f{k}": v for k, v in enumerate(e)}
    compiled = compile_system(System.from_rates(f"bessel {order}", {x: x}, outputs=outputs), target)
    zeros = scipy.special.jn_zeros(order, 3)
    at = np.array(
        [1e-8, 0.3, -0.7, 2.2, -9.0, 24.0, 90.0, 1e4, *zeros, *scipy.special.yn_zeros(order, 3)]
    )
    got = compiled.outputs(0.0, at[None, :])
    size = np.abs(at)
    oracle = [scipy.special.jv(order, at), scipy.special.yn(order, size), scipy.special.erf(at),
              scipy.special.erfc(at)]  # fmt: skip
    np.testing.assert_allclose(got, oracle, rtol=1e-12, atol=1e-14)
    for k, v in enumerate(at):
        bounds = interpret_with_bound(compiled.program, Point(x=[v]))["outputs"]
        for value, bound in zip(got[:, k], bounds, strict=True):
            assert abs(value - bound.value) <= bound.error
            assert bound.error <= 1e-12 * (1 + abs(bound.value))


@pytest.mark.parametrize("kind", ["besselj", "bessely"])
@pytest.mark.parametrize("order", [0, 1, 2, 3, 6])
def test_bessel_functions_of_large_arguments_have_fifty_digits(kind, order):
    """Just beyond the place where the expansion for large arguments takes over; and far beyond it."""
    m = mpmath.mp.clone()
    m.dps = 50
    x = m.mpf("1.01") * FAR * (order**2 + 1)
    for at in (x, -x) if kind == "besselj" else (x,):
        ours, other = bessel(m, kind, order, at), getattr(m, kind)(order, at)
        assert abs(ours - other) <= m.mpf(10) ** -48 / m.sqrt(x)
    huge = m.mpf(2) ** 3000
    both = bessel(m, "besselj", order, huge) ** 2 + bessel(m, "bessely", order, huge) ** 2
    assert abs(both * m.pi * huge / 2 - 1) < m.mpf(10) ** -48


@pytest.mark.parametrize(
    "e", [sp.erf(x), sp.erfc(x), sp.exp(x) - 1, sp.besselj(3, x), sp.sinc(x)], ids=str
)
def test_the_interpreter_is_quick_and_finite_at_huge_values(e):
    """Doubles are far away, but intermediate values of 50 digits get there."""
    program = lower_expressions({"f": [e.subs(x, x**8)]}, [x])
    for at in (1e300, -1e300):
        (value,) = interpret_exactly(program, Point(x=[at]))["f"]
        assert not mpmath.isnan(value)


def test_bessel_functions_of_huge_arguments_are_promised_no_digits(target):
    system = System.from_rates("bessel far", {x: sp.besselj(2, x), y: sp.bessely(1, x)})
    compiled = compile_system(system, target)
    for at in (3e14, 1e20, 1e300):
        bounds = interpret_with_bound(compiled.program, Point(x=[at, 0.0]))["rates"]
        wave = math.sqrt(2 / (math.pi * at))
        for value, bound in zip(compiled.rhs(0.0, [at, 0.0]), bounds, strict=True):
            assert abs(value - bound.value) <= bound.error
            assert (bound.error < 1e-13 * wave) == (at < 1e15)


def test_bessel_functions_at_zero_and_their_derivatives(target):
    e = [sp.besselj(n, x) for n in range(4)]
    outputs = {f"f{k}": v for k, v in enumerate(e)}
    compiled = compile_system(System.from_rates("bessel zero", {x: x}, outputs=outputs), target)
    np.testing.assert_array_equal(compiled.outputs(0.0, [0.0]), [1, 0, 0, 0])
    slopes = compiled_jacobian(compiled, of="outputs").dense(0.0, [0.0])[:, 0]
    np.testing.assert_array_equal(slopes, [0, 0.5, 0, 0])


def test_only_modules_that_need_it_import_scipy():
    texts = {
        name: compile_system(System.from_rates("one", {x: e}), "numpy").source
        for name, e in (("bessel", sp.besselj(1, x)), ("error", sp.erf(x)), ("plain", sp.sinc(x)))
    }
    assert "import scipy.special\n" in texts["bessel"]
    assert "come from SciPy" in texts["error"]
    assert "scipy" not in texts["plain"].lower()


@pytest.mark.skipif(not native.compiler(), reason="tests C itself")
def test_only_sources_that_need_them_declare_posix_functions_and_helpers():
    sources = [compile_system(System.from_rates("one", {x: e}), "c").source
               for e in (sp.besselj(1, x), sp.bessely(1, x), -x)]  # fmt: skip
    assert [s.count("double jn(int n, double x);") for s in sources] == [1, 0, 0]
    assert [s.count("double yn(int n, double x);") for s in sources] == [0, 1, 0]
    assert not any(helper in sources[2] for helper in ("stumpff_", "mod_", "table_"))


# --- derivatives --------------------------------------------------------------------------------------

SMOOTH = [
    sp.Mod(x, y), sp.sqrt(x**2 + y**2), sp.erf(x * y), sp.erfc(x - y), sp.exp(x * y) - 1, sp.log(1 + x * y),
    sp.besselj(2, x * y), sp.bessely(1, x + y), sp.besselj(0, y), sp.sinc(x * y), sp.frac(x) * y,
    sp.acot(x - y), sp.asec(x + 3), sp.acsch(y), sp.Heaviside(x - 3) * y + sp.ceiling(x), sp.tan(x) / x,
    (1 - sp.cos(y)) / y**2,
]  # fmt: skip


@pytest.mark.parametrize("e", SMOOTH, ids=str)
def test_derivatives_are_those_of_differences(e):
    derived = jacobian(lower_expressions({RATES: [e]}, [x, y]), RATES)
    h = 2.0**-26
    for at in ((0.7, 0.3), (2.3, 1.1), (0.2, 1.7)):
        found = dict(
            zip(
                derived.pattern,
                interpret_exactly(derived.program, Point(x=at))[JACOBIAN],
                strict=True,
            )
        )
        for k in range(2):
            sides = []
            for sign in (1, -1):
                moved = list(at)
                moved[k] += sign * h
                sides.append(
                    (moved[k], interpret_exactly(derived.program, Point(x=moved))[RATES][0])
                )
            (up, above), (down, below) = sides
            with mpmath.workdps(50):
                slope = (above - below) / (mpmath.mpf(up) - mpmath.mpf(down))
                assert abs(found.get((0, k), 0) - slope) <= 1e-12 * (1 + abs(slope))


# --- refusals -----------------------------------------------------------------------------------------

BAD = {
    "gamma": sp.gamma(x), "zeta": sp.zeta(x), "impulse": sp.DiracDelta(x), "complex": sp.I * x,
    "half order": sp.besselj(sp.Rational(1, 2), x), "symbolic order": sp.besselj(y, x),
    "modified": sp.besseli(0, x), "inverse": sp.erfinv(x), "sum": sp.Sum(x, (sp.Symbol("k"), 1, y)),
    "matrix": sp.ImmutableMatrix([x]), "infinity": sp.oo + x, "part": sp.re(x + sp.I * y, evaluate=False),
}  # fmt: skip


def part_systems(e):
    """The expression as each part of a system, by the words that name it."""
    one = Quantity(x), Quantity(y)
    named = Definition(Quantity(sp.Symbol("d", real=True)), e)
    rest = {"states": one, "rates": (y, -x)}
    mass = None if isinstance(e, sp.MatrixBase) else sp.ImmutableMatrix([[1, 0], [0, e]])
    if mass is None:
        return {"rate of y": lambda: System("odd", one, (x, e))}
    return {
        "rate of y": lambda: System("odd", one, (x, e + x)),
        "definition d": lambda: System("odd", **rest, definitions=(named,)),
        "output d": lambda: System("odd", **rest, outputs=(named,)),
        "invariant d": lambda: System("odd", **rest, invariants=(named,)),
        "singularity": lambda: System("odd", **rest, singularities=(Singularity(e, x),)),
        "mass matrix, entry (2, 2)": lambda: System("odd", **rest, mass_matrix=mass),
    }  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_a_refusal_names_system_part_expression_and_what_is_supported(
    name, target, tmp_path, monkeypatch
):
    monkeypatch.setenv(native.CACHE_VARIABLE, str(tmp_path))
    e = (
        BAD[name].xreplace({sp.Symbol("w"): sp.Function("w")(x)})
        if name == "nothing"
        else BAD[name]
    )
    if name == "part":
        e = sp.re(x + sp.I * y, evaluate=False)
    for part, make in part_systems(e).items():
        with pytest.raises(InputError) as error:
            compile_system(make(), target)
        assert error.value.where == f"system 'odd': {part}"
        assert error.value.got
        assert "\n" not in error.value.got
        if error.value.what == "no operation computes this expression":
            assert "besselj and bessely of integer order" in error.value.expected
    assert not list(tmp_path.iterdir())


def test_functions_of_time_and_derivatives_are_refused_with_the_way_out():
    f = sp.Function("f")
    ways = {f(x): "eom.Table", sp.Derivative(f(x), x): "doit()", sp.Integral(sp.gamma(x), x): "doit()",
            sp.DiracDelta(x): "impulses", sp.I * x: "real and imaginary"}  # fmt: skip
    for e, way in ways.items():
        with pytest.raises(InputError) as error:
            lower_expressions({"f": [e]}, [x])
        assert way in error.value.hint
    with pytest.raises(InputError, match="function of time or derivative"):
        System.from_rates("odd", {x: f(x)})


def test_nothing_is_written_where_one_part_is_refused(tmp_path):
    system = System.from_rates("half", {x: -x}, outputs={"fine": 2 * x, "odd": sp.gamma(x)})
    with pytest.raises(InputError):
        compile_system(system, "numpy").write(tmp_path)
    assert list(tmp_path.iterdir()) == []
