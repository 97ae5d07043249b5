"""Compiled functions against the 50-digit interpreter, SymPy, and their own contract of shapes."""

import math
from dataclasses import dataclass

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eom
from codegen import compile as compile_system
from codegen import linearise
from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir import linsolve
from codegen.ir.interpret import Bounded, Point, interpret, interpret_exactly, interpret_with_bound
from codegen.ir.ops import BLOCKS, OPS
from codegen.ir.passes import prune
from codegen.ir.program import Program
from codegen.passes.pipeline import costs
from eom.errors import AssumptionError, InputError
from eom.kinematics.coordinates import SEQUENCES, attitude
from eom.mechanics.rigidbody import full_inertia, rigid_body
from eom.mechanics.torques import applied, gravity_gradient
from eom.quantities import TIME, Definition, Quantity
from eom.system import System
from eom.tables import Table
from tests.codegen.scenes import SCENES

pytestmark = pytest.mark.shipped_flags

x, y, z, p, q = sp.symbols("x y z p q", real=True)
VARIABLES = (x, y, z, p, q, TIME)


TABLES = (
    Table("line", [-2, -0.5, 0.3, 2], [1, -1, 0.25, 3]),
    Table("spline", [-2, -0.5, 0.3, 2], [1, -1, 0.25, 3], "cubic", "linear"),
    Table("slope", [-2, -0.5, 0.3, 2], [1, -1, 0.25, 3], "pchip").derivative,
)

# --- random expressions --------------------------------------------------------------------------

UNARY = (
    sp.sin, sp.cos, sp.tan, sp.asin, sp.acos, sp.atan, sp.sinh, sp.cosh, sp.tanh, sp.asinh,
    sp.acosh, sp.atanh, sp.exp, sp.log, sp.Abs, sp.sign, sp.sec, sp.csc, sp.cot, sp.sech, sp.csch,
    sp.coth, sp.sqrt, lambda e: -e, lambda e: 1 / e, lambda e: e**2, lambda e: e**-3,
    lambda e: e ** sp.Rational(-3, 2), lambda e: e ** sp.Rational(2, 3), lambda e: e**7 / 3,
    sp.floor, sp.ceiling, sp.frac, sp.erf, sp.erfc, sp.Heaviside, sp.sinc, sp.acot, sp.asinh,
    lambda e: sp.exp(e) - 1, lambda e: sp.log(1 + e), lambda e: sp.besselj(2, e),
    lambda e: sp.bessely(0, e), lambda e: sp.tan(e) / e, lambda e: (1 - sp.cos(e)) / e**2,
    lambda e: (e - sp.sin(e)) / e**3, lambda e: sp.atan(e) / e, lambda e: (sp.exp(e) - 1) / e,
    lambda e: sp.sin(sp.sqrt(e)) / sp.sqrt(e), *TABLES,
)  # fmt: skip
BINARY = (
    sp.Add, sp.Mul, sp.Add, sp.Mul, lambda a, b: a - b, lambda a, b: a / b, sp.Pow, sp.atan2,
    sp.Min, sp.Max, sp.Mod, lambda a, b: sp.sqrt(a**2 + b**2), lambda a, b: sp.sin(a * b) / a,
)  # fmt: skip
RELATIONS = (sp.Lt, sp.Le, sp.Gt, sp.Ge, sp.Eq, sp.Ne)
JUNCTIONS = (lambda a, b: a, sp.And, sp.Or, lambda a, b: sp.Not(sp.And(a, b)))
LEAVES = (*VARIABLES, sp.Integer(0), sp.Integer(2), sp.Integer(-3), sp.Rational(1, 3),
          sp.Rational(-7, 5), sp.Float(0.1), sp.pi, sp.E)  # fmt: skip


def usable(e):
    return e.is_number is not None and not e.has(sp.nan, sp.oo, -sp.oo, sp.zoo, sp.I)


def build(make, *args):
    """Build a node; what SymPy makes complex or infinite by itself is replaced by its first part."""
    try:
        made = sp.sympify(make(*args))
    except (ArithmeticError, AttributeError, TypeError, ValueError, RecursionError):  # of SymPy
        return args[0]
    return made if isinstance(made, sp.Expr) and usable(made) else args[0]


def choice(make_list, *parts):
    return st.tuples(st.sampled_from(make_list), *parts).map(lambda c: build(c[0], *c[1:]))


def piecewise(inner):
    def make(c):
        kind, r1, r2, a, b, yes, no = c
        return build(lambda s, o: sp.Piecewise((s, kind(r1(a, b), r2(b, o))), (o, True)), yes, no)

    relation = st.sampled_from(RELATIONS)
    parts = (st.sampled_from(JUNCTIONS), relation, relation, inner, inner, inner, inner)
    return st.tuples(*parts).map(make)


expressions = st.recursive(
    st.sampled_from(LEAVES),
    lambda inner: st.one_of(choice(UNARY, inner), choice(BINARY, inner, inner), piecewise(inner)),
    max_leaves=8,
)
modest = st.one_of(
    st.sampled_from([0.0, -0.0, 1.0, -1.0, 0.5, -2.0, 3.0]),
    st.floats(-4, 4, allow_subnormal=False),
)
extreme = st.one_of(
    modest, st.sampled_from([1e-300, -1e-300, 5e-324, 1e-20, 1e20, -1e160, 1e300, 1.7e308])
)


def points(values):
    return st.lists(values, min_size=len(VARIABLES), max_size=len(VARIABLES))


def several(strategy, least, most):
    return st.lists(strategy, min_size=least, max_size=most)


def as_point(v):
    return Point(t=v[5], x=v[:3], p=v[3:5])


def system_of(exprs):
    """The expressions as outputs of a system at rest."""
    outputs = tuple(
        Definition(Quantity(sp.Symbol(f"f{k}", real=True)), e) for k, e in enumerate(exprs)
    )
    states, parameters = (tuple(map(Quantity, s)) for s in ((x, y, z), (p, q)))
    zero = (sp.Integer(0),) * 3
    return System("random", states, zero, parameters=parameters, outputs=outputs)


# --- where a bound of first order says something ---------------------------------------------------

TINY, HUGE = 1e-290, 1e290


@dataclass(frozen=True)
class Precision:
    """Unit roundoff over that of double, sizes that neither over- nor underflow, and the largest
    relative error for which first order is enough."""

    scale: float = 1.0
    tiny: float = TINY
    huge: float = HUGE
    relative: float = math.inf


DOUBLE = Precision()
SINGLE = Precision(2.0**29, 1e-30, 1e30, 1e-2)


def reliable(program, point, precision=DOUBLE):
    """For each instruction: whether neither over- or underflow, a jump nor a border is near it.

    The bound of the interpreter is of first order: it speaks only where an operation is smooth
    over the whole error of its operands.
    """
    return judged(program, point, precision)[0]


def judged(program, point, precision=DOUBLE):
    """Whether each instruction is `reliable`, and its value with the bound in that precision."""
    every = Program(program.instructions, {"all": tuple(range(len(program.instructions)))})
    found = interpret_with_bound(every, point)["all"]
    values = [
        v if i.op in BLOCKS else Bounded(v.value, v.error * precision.scale)
        for i, v in zip(program.instructions, found, strict=True)
    ]
    good = []
    for (op, args, data), v in zip(program.instructions, values, strict=True):
        a = [values[k] for k in args]
        known = all(good[k] for k in args)
        if op in BLOCKS:
            good.append(known and (op == "factor" or regular(a[0], precision)))
            continue
        is_near = any(good_operand_is_near(op, a, data))
        sized = v.value == 0 or precision.tiny < abs(v.value) < precision.huge
        sized |= op not in OPS and mpmath.isfinite(v.value)
        fine = math.isfinite(v.error) and v.error <= precision.relative * abs(v.value or mpmath.inf)
        good.append(known and sized and fine and not is_near)
    return good, values


def regular(matrix, precision=DOUBLE):
    """Whether a matrix is so far from a singular one that the bound of first order holds."""
    n, size = matrix.value.rows, max(map(abs, matrix.value))
    if not math.isfinite(size):
        return False
    inverse = linsolve.sizes_of_inverse(size.context, matrix.value)
    if inverse is None:
        return False
    change = precision.scale * (matrix.error + float(size) * 2.0**-45)
    with np.errstate(over="ignore", invalid="ignore"):
        shift = np.array(inverse) @ np.array(change, dtype=float)
    return bool(np.all(np.isfinite(shift))) and shift.sum(axis=1).max() < 1e-2 / n


def good_operand_is_near(op, a, data=None):
    """Whether a jump, a pole or a border of the domain is within ten errors of the operands."""
    rule = NEAR.get(op)
    return rule(data, *a) if rule else ()


def near(value, error, *borders):
    """Whether one of the borders is within ten errors."""
    return bool(error) and any(abs(value - b) <= 10 * error for b in borders)


def at_borders(*borders):
    return lambda _, a: [near(a.value, a.error, *borders)]


def near_each_other(_, a, b):
    return [near(a.value - b.value, a.error + b.error, 0)]


def near_power(_, a, b):
    yield near(a.value, a.error, 0)
    yield a.value < 0 and b.error
    yield b.error * abs(mpmath.log(abs(a.value) or 1)) > 1e-3


def near_cut(_, a, b):
    yield a.value == 0 and b.value <= 0  # the sign of a zero decides
    yield b.value < 0 and near(a.value, a.error, 0)
    error = max(a.error, b.error)
    yield error and max(abs(a.value), abs(b.value)) <= 10 * error


def nearest(value):
    return value.context.nint(value)


def near_period(_, a, b):
    yield b.error > 1e-3 or near(b.value, b.error, 0)
    if b.value:
        quotient = a.value / b.value
        error = a.error + abs(quotient) * b.error
        yield near(abs(b.value) * (quotient - nearest(quotient)), error, 0)


def near_whole(_, a):
    return [near(a.value, a.error, nearest(a.value))]


def near_breakpoint(table, a):
    return [a.error > 1e-3 or near(a.value, a.error, *table.breakpoints)]


def vague(_, a):
    return [a.error > 1e-3]


NEAR = {
    **dict.fromkeys(("lt", "le", "eq", "min", "max"), near_each_other),
    **dict.fromkeys(("sin", "cos", "exp", "sinh", "cosh", "expm1", "erf", "erfc"), vague),
    **dict.fromkeys(("abs", "sign", "sqrt", "log", "not"), at_borders(0)),
    **dict.fromkeys(("asin", "acos", "atanh"), at_borders(-1, 1)),
    **dict.fromkeys(
        ("besselj", "bessely", "stumpff"), lambda _, n, a: [a.error > 1e-3, near(a.value, a.error, 0)]
    ),
    "acosh": at_borders(1), "log1p": at_borders(-1),
    "div": lambda _, a, b: [near(b.value, b.error, 0)],
    "tan": lambda _, a: [a.error > 1e-3, near(mpmath.cos(a.value), a.error, 0)],
    "pow": near_power, "atan2": near_cut, "mod": near_period, "floor": near_whole,
    "table": near_breakpoint,
}  # fmt: skip
"""By operation: the data of the instruction and the operands with their bounds."""


def check_against_bound(program, group, point, got):
    """Compare numbers with the 50-digit values where their bound holds; return how many there were."""
    good = reliable(program, point)
    numbers = program.results[group]
    expected = interpret_with_bound(program, point)[group]
    checked = 0
    for k, e, value in zip(numbers, expected, got, strict=True):
        if good[k]:
            assert abs(mpmath.mpf(float(value)) - e.value) <= e.error, (k, value, e)
            checked += 1
    return checked


# --- random expressions against the interpreter ----------------------------------------------------


@pytest.mark.sparse(only=("c",))
@settings(max_examples=25)
@given(several(expressions, 4, 10), several(points(extreme), 6, 6))
def test_random_expressions_stay_within_the_error_bound(target, exprs, values):
    compiled = compile_system(system_of(exprs), target)
    columns = np.array(values).T
    got = compiled.outputs(columns[5], columns[:3], columns[3:5])
    for k, v in enumerate(values):
        check_against_bound(compiled.program, "outputs", as_point(v), got[:, k])
        one = compiled.outputs(v[5], np.array(v[:3]), np.array(v[3:5]))
        good = np.array(reliable(compiled.program, as_point(v)))
        same = good[list(compiled.program.results["outputs"])]
        np.testing.assert_allclose(got[same, k], one[same], rtol=1e-9, atol=1e-300)


def test_the_check_against_the_bound_checks_most_values(target):
    """Guard against a check that skips everything: on smooth functions nothing is skipped."""
    exprs = [
        f(x) * sp.exp(y) / (2 + sp.cos(z * p)) - q for f in (sp.sin, sp.atan, sp.cosh, sp.tanh)
    ]
    exprs += [sp.Piecewise((x, x < y), (z, True)), sp.Min(x, y), sp.sqrt(x), x**y, sp.atan2(y, -x)]
    compiled = compile_system(system_of(exprs), target)
    v = [0.7, 1.9, -0.4, 1.3, 0.2, 5.0]
    got = compiled.outputs(v[5], v[:3], v[3:5])
    assert check_against_bound(compiled.program, "outputs", as_point(v), got) == len(exprs)
    wrong = got * (1 + 1e-13)
    with pytest.raises(AssertionError):
        check_against_bound(compiled.program, "outputs", as_point(v), wrong)


@settings(max_examples=60)
@given(expressions, points(modest))
def test_lowered_expressions_have_the_value_that_sympy_gives_them(e, v):
    program = lower_expressions({"f": [e]}, (x, y, z), (p, q, TIME))
    point = Point(x=v[:3], p=v[3:])
    (ours,) = interpret_with_bound(program, point)["f"]
    numbers = {s: sp.Rational(value) for s, value in zip(VARIABLES, v, strict=True)}
    e = e.xreplace({f: sp.Rational(f) for f in e.atoms(sp.Float)})  # SymPy rounds to 15 digits
    try:
        theirs = sp.N(e.xreplace(numbers), 60)
    except (ArithmeticError, TypeError, ValueError):  # SymPy does not order complex numbers or NaN
        assert math.isinf(ours.error) or e.has(sp.Piecewise)
        return
    if mpmath.isnan(ours.value) or mpmath.isinf(ours.value):
        nodes = [n.xreplace(numbers) for n in sp.preorder_traversal(e) if isinstance(n, sp.Expr)]
        assert any(sp.N(n).is_finite is not True or sp.N(n).is_real is not True for n in nodes)
        return
    assume(theirs.is_Float or theirs.is_zero)
    assume(reliable(program, point)[program.results["f"][0]])
    with mpmath.workdps(60):
        difference = abs(ours.value - mpmath.mpf(str(theirs)))
        assert difference <= ours.error * 2.0**-100 + mpmath.mpf(10) ** -40, (ours, theirs)


ARITHMETIC = st.recursive(
    st.sampled_from([*VARIABLES, sp.Integer(3), sp.Rational(1, 3), sp.Integer(-1)]),
    lambda inner: st.one_of(
        choice((sp.Add, sp.Mul, lambda a, b: a - b, lambda a, b: a / b, sp.Min, sp.Max), inner, inner),
        choice((sp.sqrt, sp.Abs, sp.sign, lambda e: -e, lambda e: e**3), inner),
        choice((sp.floor, sp.frac, sp.Heaviside), inner),
        choice((sp.Mod,), inner, inner),
        piecewise(inner),
    ),
    max_leaves=10,
).map(
    lambda e: e if all(p.exp.q <= 2 for p in e.atoms(sp.Pow) if p.exp.is_Rational) else x
)  # fmt: skip
"""Expressions of operations that are correctly rounded; roots other than square ones are not."""


@pytest.mark.sparse(only=("c",))
@settings(max_examples=25)
@given(several(ARITHMETIC, 4, 10), several(points(extreme), 8, 8))
def test_arithmetic_is_the_same_to_the_last_bit_even_where_it_overflows(target, exprs, values):
    """Correctly rounded operations leave a target no choice, also for NaN and infinity."""
    compiled = compile_system(system_of(exprs), target)
    columns = np.array(values).T
    got = compiled.outputs(columns[5], columns[:3], columns[3:5])
    for k, v in enumerate(values):
        expected = interpret(compiled.program, as_point(v))["outputs"]
        np.testing.assert_array_equal(got[:, k], expected)


# --- every system of the project ---------------------------------------------------------------------


def full_inertia_body(name):
    return rigid_body(full_inertia(), lambda C, J: applied((0, 0, 0)), attitude(name), name="full")


SYSTEMS = {
    **{f"free {a}": lambda a=a: eom.free_rigid_body(a) for a in ("quaternion", "dcm", *SEQUENCES)},
    "free": eom.free_rigid_body,
    "heavy top": eom.heavy_top,
    "heavy top 3-1-3": lambda: eom.heavy_top("3-1-3"),
    "satellite": eom.gravity_gradient_satellite,
    "satellite 3-2-1": lambda: eom.gravity_gradient_satellite("3-2-1"),
    "satellite dcm": lambda: eom.gravity_gradient_satellite("dcm"),
    "full inertia": lambda: full_inertia_body("quaternion"),
    "full inertia 3-1-2": lambda: full_inertia_body("3-1-2"),
    "full inertia, gravity gradient": lambda: rigid_body(
        full_inertia(), gravity_gradient, attitude("quaternion"), name="full_gradient"
    ),
    "lecture": lambda: eom.lecture_torque().system(),
    **{n: lambda n=n: eom.load_scene(n).derive() for n in SCENES},
    **{f"{n}, all of it": lambda n=n: eom.load_scene(n).full_system for n in SCENES},
}


def random_values(system, seed):
    """States from -2 to 2, with rotations; parameters that make a positive definite inertia."""
    rng = np.random.default_rng(seed)
    states = rng.uniform(-2, 2, len(system.states))
    parameters = []
    for quantity in system.parameters:
        if quantity.symbol.is_positive:
            parameters.append(rng.uniform(1.1, 2.0))
        else:
            parameters.append(rng.uniform(-0.5, 0.5))
    inputs = rng.uniform(-1, 1, len(system.inputs))
    names = list(system.state_names)
    if "q0" in names:
        states[names.index("q0") :][:4] /= np.linalg.norm(states[names.index("q0") :][:4])
    if "C11" in names:
        states[names.index("C11") :][:9] = np.linalg.qr(rng.normal(size=(3, 3)))[0].ravel()
    return rng.uniform(-3, 3), states, np.array(parameters), inputs


@pytest.fixture(scope="module", params=SYSTEMS)
def system(request):
    return SYSTEMS[request.param]()


def as_array(values):
    return values if len(values) else None


@pytest.mark.sparse(3)
def test_every_system_stays_within_the_error_bound(system, target):
    compiled = compile_system(system, target)
    checked = 0
    for seed in range(4):
        t, xs, ps, us = random_values(system, seed)
        for group, function in compiled.functions.items():
            got = function(t, xs, as_array(ps), as_array(us))
            checked += check_against_bound(compiled.program, group, Point(t, xs, ps, us), got)
    assert checked >= 3 * sum(compiled.layout.sizes.values())


@pytest.mark.sparse(6)
def test_every_system_has_the_values_that_sympy_gives_it(system):
    """Definitions are expanded, and the mass matrix solved, by SymPy with 60 digits."""
    t, xs, ps, us = random_values(system, 7)
    symbols = [q.symbol for q in (*system.states, *system.parameters, *system.inputs)]
    numbers = dict(zip(symbols, map(sp.Rational, [*xs, *ps, *us]), strict=True))
    numbers[system.time] = sp.Rational(t)
    definitions = {}
    for d in system.definitions:
        definitions[d.symbol] = sp.N(d.expression.xreplace(definitions).xreplace(numbers), 60)

    def value(e):
        return sp.N(e.xreplace(definitions).xreplace(numbers), 60)

    rates = sp.Matrix([value(r) for r in system.rates])
    if system.mass_matrix is not None:
        rates = system.mass_matrix.applyfunc(value).LUsolve(rates)
    expected = {
        "rates": list(rates),
        "outputs": [value(d.expression) for d in system.outputs],
        "invariants": [value(d.expression) for d in system.invariants],
        "singularities": [value(s.expression) for s in system.singularities],
    }
    exact = interpret_exactly(lower_system(system), Point(t, xs, ps, us))
    with mpmath.workdps(60):
        for group, values in expected.items():
            for ours, theirs in zip(exact[group], values, strict=True):
                assert abs(ours - mpmath.mpf(str(theirs))) < 1e-42 * (1 + abs(ours)), group


@pytest.mark.sparse(9)
def test_every_system_is_finite_at_rest(system, target):
    """All states zero: rates are finite unless the coordinates are singular there."""
    compiled = compile_system(system, target)
    _, xs, ps, us = random_values(system, 1)
    zero = np.zeros_like(xs)
    arguments = (0.0, zero, as_array(ps), as_array(us))
    if system.singularities and np.any(np.abs(compiled.singularities(*arguments)) < 1e-9):
        assert not np.all(np.isfinite(compiled.rhs(*arguments)))
    else:
        assert np.all(np.isfinite(compiled.rhs(*arguments)))


@pytest.mark.sparse(6)
def test_compiled_in_parameters_give_what_the_general_functions_give(system, target):
    t, xs, ps, us = random_values(system, 3)
    general = compile_system(system, target)
    names = system.parameter_names
    fixed = {n: v for k, (n, v) in enumerate(zip(names, ps, strict=True)) if k % 2 == 0}
    rest = np.array([v for n, v in zip(names, ps, strict=True) if n not in fixed])
    special = compile_system(system, target, fixed)
    point, reduced = Point(t, xs, ps, us), Point(t, xs, rest, us)
    a, b = (interpret_with_bound(c.program, v) for c, v in ((general, point), (special, reduced)))
    for group, function in special.functions.items():
        for one, other in zip(a[group], b[group], strict=True):
            assert abs(one.value - other.value) <= 1e-40 * (1 + abs(one.value))
        got = function(t, xs, as_array(rest), as_array(us))
        check_against_bound(special.program, group, reduced, got)
        one, other = (prune(c.program, [group]) for c in (special, general))
        assert costs(one) <= costs(other)  # each group is a function of its own


# --- shapes ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def forced():
    """A system with states, parameters, inputs and time in it."""
    u, v = sp.symbols("u v", real=True)
    return System.from_rates(
        "forced",
        {x: y * sp.cos(TIME) + u, y: -p * sp.sin(x) * q + v * TIME},
        inputs=(u, v),
        outputs={"energy": y**2 / 2 - p * sp.cos(x), "constant": sp.Integer(7), "drive": u * TIME},
    )


def batch(n=9, seed=5):
    rng = np.random.default_rng(seed)
    return rng.normal(size=n), *(rng.normal(size=(2, n)) for _ in range(3))


@pytest.mark.parametrize("group", ["rhs", "outputs"])
def test_a_batch_is_its_columns_one_by_one(forced, target, group):
    f = getattr(compile_system(forced, target), group)
    t, xs, ps, us = batch()
    together = f(t, xs, ps, us)
    for k in range(len(t)):
        one = f(float(t[k]), xs[:, k].copy(), ps[:, k].copy(), us[:, k].copy())
        np.testing.assert_allclose(together[:, k], one, rtol=1e-15, atol=1e-300)


@pytest.mark.parametrize("shared", [(), ("t",), ("p",), ("u",), ("t", "p", "u"), ("x", "p", "u")])
def test_what_has_no_column_axis_is_the_same_at_every_point(forced, target, shared):
    f = compile_system(forced, target).rhs
    full = dict(zip("txpu", batch(), strict=True))
    given_ = {k: (v[..., 0] if k in shared else v) for k, v in full.items()}
    spread = {k: (np.repeat(v[..., :1], 9, axis=-1) if k in shared else v) for k, v in full.items()}
    expected = f(*(spread[k] for k in "txpu"))
    np.testing.assert_array_equal(f(*(given_[k] for k in "txpu")), expected)


@pytest.mark.parametrize(
    "change",
    [
        np.asfortranarray,
        lambda a: np.repeat(a, 3, axis=-1)[..., ::3],
        lambda a: a[..., ::-1].copy()[..., ::-1],
        lambda a: np.concatenate([a, a])[: len(a)],
        lambda a: a.astype(np.float64).astype(">f8"),
        lambda a: a.tolist(),
        lambda a: np.ndarray(a.shape, np.float64, b"\0" * 4 + a.tobytes(), 4),
    ],
    ids=["fortran", "strided", "negative strides", "part", "big endian", "list", "unaligned"],
)
def test_memory_layout_does_not_matter(forced, target, change):
    f = compile_system(forced, target).rhs
    arguments = batch()
    np.testing.assert_array_equal(f(*map(change, arguments)), f(*arguments))
    singles = (0.5, *(a[:, 0].copy() for a in arguments[1:]))
    changed = (0.5, *map(change, singles[1:]))
    np.testing.assert_array_equal(f(*changed), f(*singles))


def test_fields_of_records_have_strides_that_are_no_multiple_of_a_double(forced, target):
    f = compile_system(forced, target).rhs
    record = np.zeros(2, dtype=[("flag", "i4"), ("value", "f8")])
    record["value"] = [0.3, -0.2]
    expected = f(0.5, [0.3, -0.2], [1.0, 2.0], [3.0, 4.0])
    np.testing.assert_array_equal(f(0.5, record["value"], [1.0, 2.0], [3.0, 4.0]), expected)
    times = np.zeros(3, dtype=[("flag", "i4"), ("value", "f8")])
    times["value"] = [0.1, 0.2, 0.3]
    columns = [np.tile(np.array([[a], [b]]), 3) for a, b in ((0.3, -0.2), (1, 2), (3, 4))]
    np.testing.assert_array_equal(f(times["value"], *columns), f(times["value"].copy(), *columns))


def test_out_is_filled_and_returned(forced, target):
    f = compile_system(forced, target).rhs
    t, xs, ps, us = batch()
    record = np.zeros((2, 9), dtype=[("flag", "i4"), ("value", "f8")])["value"]
    outs = (np.full((2, 9), np.nan), np.full((9, 2), np.nan).T, np.full((2, 18), np.nan)[:, ::2])
    for out in (*outs, record):
        assert f(t, xs, ps, us, out=out) is out
        np.testing.assert_array_equal(out, f(t, xs, ps, us))
    single = np.full(2, np.nan)
    assert f(0.5, xs[:, 0], ps[:, 0], us[:, 0], out=single) is single
    np.testing.assert_array_equal(single, f(0.5, xs[:, 0], ps[:, 0], us[:, 0]))
    every_other = np.full(4, np.nan)[::2]
    assert f(0.5, xs[:, 0], ps[:, 0], us[:, 0], out=every_other) is every_other
    np.testing.assert_array_equal(every_other, single)


def test_out_may_be_the_states_themselves(forced, target):
    f = compile_system(forced, target).rhs
    t, xs, ps, us = batch()
    expected = f(t, xs, ps, us)
    again = xs.copy()
    f(t, again, ps, us, out=again)
    np.testing.assert_array_equal(again, expected)
    single = xs[:, 0].copy()
    f(float(t[0]), single, ps[:, 0], us[:, 0], out=single)
    np.testing.assert_allclose(single, expected[:, 0], rtol=1e-15)
    row = xs.copy()
    f(t, row, ps, us, out=row[::-1])
    np.testing.assert_array_equal(row[::-1], expected)


def test_empty_batches_give_empty_results(forced, target):
    f = compile_system(forced, target).rhs
    assert f(np.empty(0), np.empty((2, 0)), [1.0, 2.0], [3.0, 4.0]).shape == (2, 0)
    assert f(0.0, np.empty((2, 0)), [1.0, 2.0], [3.0, 4.0]).shape == (2, 0)


def test_arguments_are_not_changed(forced, target):
    f = compile_system(forced, target).rhs
    arguments = batch()
    copies = [a.copy() for a in arguments]
    f(*arguments)
    for a, b in zip(arguments, copies, strict=True):
        np.testing.assert_array_equal(a, b)


def test_integers_and_time_of_other_kinds_are_accepted(forced, target):
    f = compile_system(forced, target).rhs
    expected = f(2.0, [1.0, 2.0], [1.0, 2.0], [3.0, 4.0])
    for t in (2, np.float64(2), np.float32(2), np.array(2.0), np.array(2)):
        np.testing.assert_array_equal(f(t, [1, 2], np.array([1, 2]), (3, 4)), expected)


def test_values_by_name_are_those_in_order(forced, target):
    """Of rates, outputs, batches, Jacobians and linear motions; at one point and at many."""
    compiled = compile_system(forced, target)
    t, xs, ps, us = batch()
    named = [dict(zip(names, rows, strict=True)) for names, rows in
             (("yx", xs[::-1]), ("pq", ps), ("vu", us[::-1]))]  # fmt: skip
    first = [{n: row[0] for n, row in given.items()} for given in named]
    J = compiled.jacobian("parameters", "outputs")
    for f in (compiled.rhs, compiled.outputs, compiled.batch("outputs"), J, J.dense, J.with_value):
        for got, expected in zip(f(t, *named), f(t, xs, ps, us), strict=True):
            np.testing.assert_array_equal(got, expected)
        for got, expected in zip(f(0.5, *first), f(0.5, xs[:, 0], ps[:, 0], us[:, 0]), strict=True):
            np.testing.assert_array_equal(got, expected)
    near, same = linearise(compiled, *named, t), linearise(compiled, xs, ps, us, t)
    assert all(np.array_equal(getattr(near, k), getattr(same, k)) for k in "ABCD")
    mixed = compiled.rhs(0.5, {"x": xs[0], "y": 2.0}, *first[1:])
    assert np.array_equal(mixed[:, 3], compiled.rhs(0.5, [xs[0, 3], 2.0], *first[1:]))


def test_values_by_name_may_leave_out_what_has_a_default(target):
    z, k, c = sp.symbols("z k c", real=True)
    parameters = (Quantity(k, default=2.0), Quantity(c))
    system = System("s", (Quantity(z, default=3.0),), (-k * z + c,), parameters)
    rhs = compile_system(system, target).rhs
    assert rhs(0.0, {}, {"c": 1}) == [-5.0]
    with pytest.raises(InputError, match="missing parameter: c"):
        rhs(0.0, {"z": 1})
    free = compile_system(System("s", (Quantity(z),), (-k * z,), parameters[:1]), target).rhs
    assert free(0.0, [1.0]) == [-2.0]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((0.0, [1.0], [1.0, 2.0], [1.0, 2.0]), ["x has the wrong shape", "(1,)", "x, y"]),
        ((0.0, [[[1.0], [2.0]]], [1.0, 2.0], [1.0, 2.0]), ["x has the wrong shape"]),
        ((0.0, 1.0, [1.0, 2.0], [1.0, 2.0]), ["x has the wrong shape", "()"]),
        ((0.0, [1.0, 2.0], [1.0], [1.0, 2.0]), ["p has the wrong shape", "p, q"]),
        ((0.0, [1.0, 2.0], None, [1.0, 2.0]), ["p is missing", "p, q"]),
        ((0.0, [1.0, 2.0], [1.0, 2.0]), ["u is missing", "u, v"]),
        ((0.0, [1.0, 2.0], [1.0, 2.0], [1j, 2.0]), ["u is not an array of real numbers"]),
        ((0.0, ["a", "b"], [1.0, 2.0], [1.0, 2.0]), ["x is not an array of real numbers"]),
        (([[0.0]], [1.0, 2.0], [1.0, 2.0], [1.0, 2.0]), ["t has the wrong shape", "(1, 1)"]),
        (([0.0, 1.0], np.ones((2, 3)), [1.0, 2.0], [1.0, 2.0]), ["columns differ", "t: 2", "x: 3"]),
        ((0.0, {"x": 1, "z": 2}, [1.0, 2.0], [1.0, 2.0]), ["unknown state 'z'; missing state: y"]),
        (
            (0.0, [1.0, 2.0], {"r": 1, "s": 1}, [1.0, 2.0]),
            ["unknown parameters 'r', 's'; missing parameters: p, q"],
        ),
        ((0.0, [1.0, 2.0], [1.0, 2.0], {"u": 1}), ["missing input: v"]),
        ((0.0, {"x": 1, "y": "a"}, [1.0, 2.0], [1.0, 2.0]), ["not a number", "value of y"]),
        ((0.0, {"x": 1, "y": [[1]]}, [1.0, 2.0], [1.0, 2.0]), ["state y has the wrong shape"]),
        (
            (0.0, {"x": [1, 2], "y": [1, 2, 3]}, [1.0, 2.0], [1.0, 2.0]),
            ["columns of states differ", "x: 2, y: 3"],
        ),
        ((0.0, {1: 2.0}, [1.0, 2.0], [1.0, 2.0]), ["a state has a name"]),
    ],
)
def test_wrong_arguments_are_refused_with_what_was_expected(forced, target, arguments, words):
    f = compile_system(forced, target).rhs
    with pytest.raises(InputError) as error:
        f(*arguments)
    assert all(w in str(error.value) for w in words), str(error.value)


@pytest.mark.parametrize(
    "out",
    [np.empty(3), np.empty((2, 1)), np.empty(2, dtype=np.float32), [0.0, 0.0], np.empty(2, dtype=">f8")],
    ids=["length", "shape", "single precision", "list", "big endian"],
)  # fmt: skip
def test_an_out_that_does_not_fit_is_refused(forced, target, out):
    with pytest.raises(InputError, match="out does not fit"):
        compile_system(forced, target).rhs(0.0, [1.0, 2.0], [1.0, 2.0], [1.0, 2.0], out=out)


def test_an_out_that_is_read_only_is_refused(forced, target):
    out = np.zeros(2)
    out.flags.writeable = False
    with pytest.raises(InputError, match="out does not fit"):
        compile_system(forced, target).rhs(0.0, [1.0, 2.0], [1.0, 2.0], [1.0, 2.0], out=out)
    np.testing.assert_array_equal(out, 0)


def test_values_for_a_group_that_a_system_lacks_are_refused(target):
    still = compile_system(System.from_rates("still", {x: -x}), target)
    for extra in ({"p": [1.0]}, {"u": [1.0]}):
        with pytest.raises(InputError, match="wrong shape"):
            still.rhs(0.0, [1.0], **extra)
    for group in ("outputs", "invariants", "singularities"):
        with pytest.raises(InputError, match=f"has no {group}"):
            getattr(still, group)


def test_functions_work_after_the_compiled_object_is_gone(forced, target):
    f = compile_system(forced, target).rhs
    assert np.all(np.isfinite(f(0.5, np.ones(2), np.ones(2), np.ones(2))))


# --- compile ----------------------------------------------------------------------------------------


def test_an_unknown_target_is_refused():
    with pytest.raises(InputError, match="unknown target 'numpi'") as error:
        compile_system(eom.free_rigid_body(), "numpi")
    assert "numpy" in error.value.hint


@pytest.mark.parametrize(
    ("values", "kind", "words"),
    [
        ({"I4": 1.0}, InputError, ["unknown name 'I4'", "I1, I2, I3"]),
        ({"I1": -1.0}, InputError, ["I1 is not positive"]),
        ({"I1": math.nan}, InputError, ["I1"]),
        ({"I1": math.inf}, InputError, ["I1"]),
        ({"I1": 1.0, "I2": 1.0, "I3": 2.5}, AssumptionError, ["I1 = 1.0", "I3 = 2.5", ">= 0"]),
        ({"J12": 0.3}, AssumptionError, ["principal_axes", "J12 = 0.3"]),
    ],
)
def test_parameters_that_cannot_be_are_refused(target, values, kind, words):
    with pytest.raises(kind) as error:
        compile_system(eom.free_rigid_body(), target, values)
    assert all(w in str(error.value) for w in words), str(error.value)


def test_parameters_that_are_compiled_in_are_no_arguments_any_more(target):
    compiled = compile_system(eom.free_rigid_body(), target, {"I1": 1.0, "I3": 1.5})
    assert [q.name for q in compiled.layout.parameters] == ["I2"]
    assert compiled.fixed == {"I1": 1.0, "I3": 1.5}
    # I1 w1' = (I2 - I3) w2 w3, lecture 002 eq. 3.36
    rates = compiled.rhs(0.0, [1.0, 2.0, 3.0], [2.0])
    np.testing.assert_allclose(rates, [(2 - 1.5) * 6, (1.5 - 1) * 3 / 2, (1 - 2) * 2 / 1.5], 1e-15)


def test_written_files_are_the_generated_ones_byte_by_byte(target, tmp_path):
    compiled = compile_system(eom.free_rigid_body("3-1-2"), target)
    paths = compiled.write(tmp_path / "deep" / "er")
    assert {p.name: p.read_bytes().decode() for p in paths} == dict(compiled.files)
    assert compiled.source in compiled.files.values()
    again = compiled.write(tmp_path / "deep" / "er")
    assert again == paths
    assert sorted(p.name for p in (tmp_path / "deep" / "er").iterdir()) == sorted(compiled.files)


def test_writing_below_a_regular_file_fails_with_one_error_and_writes_nothing(target, tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match="files cannot be written") as error:
        compile_system(eom.free_rigid_body(), target).write(tmp_path / "file" / "folder")
    assert str(tmp_path / "file") in error.value.where
    assert [p.name for p in tmp_path.iterdir()] == ["file"]
    assert (tmp_path / "file").read_text() == "mine"


def test_writing_onto_a_folder_leaves_no_half_of_the_files(tmp_path, target):
    compiled = compile_system(eom.free_rigid_body(), target)
    last = list(compiled.files)[-1]
    (tmp_path / last).mkdir()
    (tmp_path / last / "kept").write_text("mine")
    with pytest.raises(InputError, match="files cannot be written"):
        compiled.write(tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == [last]


def test_a_compiled_system_crosses_to_another_process(target):
    import pickle

    compiled = compile_system(eom.free_rigid_body(), target, {"I1": 2.0})
    other = pickle.loads(pickle.dumps(compiled))
    assert (other.target, other.fixed) == (target, {"I1": 2.0})
    np.testing.assert_array_equal(
        other.rhs(0.0, [1.0, 2.0, 3.0], [1.5, 1.2]), compiled.rhs(0.0, [1.0, 2.0, 3.0], [1.5, 1.2])
    )
