import mpmath
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen.derivatives.derivative import JACOBIAN, ORDERS, PARTIALS, colouring, columns, jacobian
from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.ops import INTEGER_FIRST, OPS, SOLVE, WITH_DATA, Instruction, row_of
from codegen.ir.passes import dependence, prune
from codegen.ir.program import RATES, Builder
from eom.kinematics.coordinates import attitude
from eom.mechanics.rigidbody import full_inertia, rigid_body
from eom.mechanics.torques import weight
from eom.opening import load_scene
from eom.tables import Table
from tests.codegen.scenes import SCENES
from tests.draws import nonzero

x, y, z = sp.symbols("x y z", real=True)

INSIDE = {
    "sqrt": (0.7,), "pow": (1.3, 0.6), "asin": (0.3,), "acos": (-0.4,), "acosh": (1.7,),
    "atanh": (0.2,), "log": (2.5,), "bessely": (2, 1.7), "besselj": (3, -2.1), "stumpff": (2, 1.3),
    "mod": (7.3, -2.1), "table": (0.4,), "min": (0.3, 0.9), "max": (0.3, 0.9), "select": (1.0, 0.3, 0.8),
}  # fmt: skip
CURVE = Table("curve", [0, 1, 3], [1, 2, -1], "cubic")
POINTS = {op: INSIDE.get(op, (0.37, -1.21, 0.83)[: row.arity]) for op, row in OPS.items()}


def program_of_op(op):
    b = Builder()
    args = [b.leaf("state", k) for k in range(OPS[op].arity)]
    if op in INTEGER_FIRST:
        args[0] = b.const(INSIDE[op][0])
    return b.program({RATES: [b.add(op, *args, value=CURVE if op in WITH_DATA else None)]})


def slopes(program, at, base, column):
    """Central differences of the results; the values have 50 digits, the points are doubles."""
    sides = []
    for shift in (2.0**-24, -(2.0**-24)):
        moved = list(base)
        moved[column] += shift
        sides.append((moved[column], interpret_exactly(program, at(moved))[RATES]))
    (right, above), (left, below) = sides
    width = mpmath.mpf(right) - mpmath.mpf(left)
    return [(a - b) / width for a, b in zip(above, below, strict=True)]


def entries(derived, point):
    """Entries of the Jacobian by place, 50 digits."""
    values = interpret_exactly(derived.program, point)[JACOBIAN]
    return dict(zip(derived.pattern, values, strict=True))


def test_every_operation_has_its_partial_derivatives():
    assert set(PARTIALS) == set(OPS) - {"back", "item"}


@pytest.mark.parametrize("op", sorted(set(OPS) - SOLVE))
def test_partials_are_those_of_the_table_of_operations(op):
    at = POINTS[op]
    derived = jacobian(program_of_op(op), RATES)
    found = entries(derived, Point(x=at))
    with mpmath.workdps(60):
        exact = [mpmath.mpf(a) for a in at]
        row = row_of(Instruction(op, (), CURVE if op in WITH_DATA else None))
        value = row.exact(mpmath.mp, *exact)
        expected = row.partials(mpmath.mp, value, *exact)
        for k, wanted in enumerate(expected):
            assert abs(found.get((0, k), mpmath.mpf(0)) - wanted) < mpmath.mpf(10) ** -45


@pytest.mark.parametrize(
    ("op", "at"),
    [("sqrt", (0,)), ("atan2", (0, 0)), ("asin", (1,)), ("acos", (-1,)), ("acosh", (1,)),
     ("hypot", (0, 0)), ("besselj", (3, 0)), ("stumpff", (2, 0)), ("table", (1,)),
     ("abs", (0,)), ("pow", (0, 2)), ("sign", (0,)), ("min", (1, 1)), ("select", (0, 1, 2))],
)  # fmt: skip
def test_where_there_is_no_derivative_it_is_finite(op, at):
    derived = jacobian(program_of_op(op), RATES)
    assert all(mpmath.isfinite(v) for v in entries(derived, Point(x=at)).values())


def test_the_norm_of_zero_has_the_derivative_zero():
    program = lower_expressions({RATES: [sp.sqrt(x**2 + y**2)]}, [x, y])
    assert list(entries(jacobian(program, RATES), Point(x=(0.0, 0.0))).values()) == [0, 0]


EXPRESSIONS = [
    x * y + z, x / y, x**3 * y**-2, sp.sin(x * y) * sp.exp(z), sp.sqrt(x**2 + y**2 + z**2),
    sp.atan2(x, y * z), sp.tan(x) * sp.log(y**2 + 1), sp.Abs(x - y) * z, sp.Max(x, y) * sp.Min(y, z),
    sp.Piecewise((x**2, x < y), (y * z, True)), sp.tanh(x) / sp.cosh(y), (x**2 + 1) ** (y / 3),
    sp.asin(x / 10) + sp.acos(y / 10) + sp.atan(z), sp.asinh(x) * sp.acosh(y**2 + 2), 5, x - x,
]  # fmt: skip


@given(
    st.sampled_from(EXPRESSIONS),
    st.tuples(*[nonzero(0.05, 2)] * 3),
)
def test_expressions_against_differences_at_high_precision(expression, at):
    program = lower_expressions({RATES: [expression]}, [x, y, z])
    found = entries(jacobian(program, RATES), Point(x=at))
    with mpmath.workdps(60):
        for k in range(3):
            (slope,) = slopes(program, lambda v: Point(x=v), at, k)
            if abs(at[0] - at[1]) > 1e-6 and abs(at[1] - at[2]) > 1e-6:
                assert abs(found.get((0, k), 0) - slope) <= 1e-9 * (1 + abs(slope))


SYSTEMS = {
    **{n: lambda n=n: load_scene(n).derive() for n in SCENES},
    "full inertia": lambda: rigid_body(
        full_inertia(), lambda C, J: weight(C), attitude("3-1-2"), name="full"
    ),
}


def values(system, seed):
    numbers = iter(0.3 + ((seed * 37 + k * 61) % 97) / 97 for k in range(1000))
    take = lambda group: [next(numbers) for _ in group]  # noqa: E731
    p = take(system.parameters)
    if system.mass_matrix is not None:
        named = dict(zip(system.parameter_names, p, strict=True))
        named |= {k: v * (0.1 if k[1:] in {"12", "13", "23"} else 3) for k, v in named.items()}
        p = list(named.values())
    return Point(t=next(numbers), x=take(system.states), p=p, u=take(system.inputs))


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("kind", ["state", "parameter"])
def test_systems_against_central_differences(name, kind):
    system = SYSTEMS[name]()
    program = prune(lower_system(system), [RATES])
    derived = jacobian(program, RATES, kind)
    point = values(system, 3)
    found = entries(derived, point)
    assert (
        interpret_exactly(derived.program, point)[RATES] == interpret_exactly(program, point)[RATES]
    )
    base = list(point.x if kind == "state" else point.p)

    def at(moved):
        return Point(
            point.t,
            moved if kind == "state" else point.x,
            moved if kind == "parameter" else point.p,
            point.u,
        )

    with mpmath.workdps(60):
        for column in range(len(base)):
            for row, slope in enumerate(slopes(program, at, base, column)):
                got = found.get((row, column), mpmath.mpf(0))
                assert abs(got - slope) < 1e-9 * (1 + abs(slope))


@pytest.mark.sparse(4)
@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("kind", ["state", "parameter"])
def test_nothing_depends_on_what_it_does_not_read(name, kind):
    program = lower_system(SYSTEMS[name]())
    covered = dependence(program, RATES, kind)
    assert covered >= set(jacobian(program, RATES, kind).pattern)
    used = {(r, int(i.value)) for r in range(3) for i in program.instructions if i.op == kind}
    if name == "t-handle" and kind == "state":  # each rate is the product of the other two
        assert covered == {(r, s) for r, s in used if r != s}


@given(st.sets(st.tuples(st.integers(0, 8), st.integers(0, 8))))
def test_columns_of_one_colour_share_no_row(pattern):
    rows, colours = columns(pattern), colouring(pattern)
    assert set(colours) == {c for _, c in pattern}
    for c in rows:
        for other in rows:
            if c < other and colours[c] == colours[other]:
                assert not rows[c] & rows[other]
    widest = max((sum(1 for r, _ in pattern if r == row) for row in range(9)), default=0)
    assert max(colours.values(), default=-1) + 1 >= widest


@pytest.mark.sparse(2)
@pytest.mark.parametrize("name", SCENES)
def test_value_and_jacobian_cost_little_more_than_the_value(name):
    program = prune(lower_system(load_scene(name).derive()), [RATES])
    derived = jacobian(program, RATES)
    counts = [sum(p.counts().values()) for p in (derived.program, program)]
    assert counts[0] <= 3 * counts[1]
    assert derived.program.cost() <= 2.5 * program.cost()


@pytest.mark.sparse(3)
@pytest.mark.parametrize("name", SCENES)
def test_the_cheapest_mode_is_chosen(name):
    program = prune(lower_system(load_scene(name).derive()), [RATES])
    costs = {m: jacobian(program, RATES, modes=[m]).program.cost() for m in ORDERS}
    chosen = jacobian(program, RATES)
    assert chosen.program.cost() == costs[chosen.mode] == min(costs.values())
