import mpmath
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen.derivatives.derivative import JACOBIAN, jacobian
from codegen.derivatives.elimination import ORDERS
from codegen.derivatives.reverse import (
    HESSIAN,
    PRODUCT,
    gradient,
    hessian,
    hessian_product,
    jvp,
    vjp,
)
from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir.groups import INVARIANTS, OUTPUTS, RATES
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.passes import prune
from eom.opening import load_scene
from eom.scenes.scene import Scene
from tests.codegen.scenes import SCENES
from tests.codegen.test_derivative import EXPRESSIONS, SYSTEMS, values
from tests.draws import nonzero

x, y, z = sp.symbols("x y z", real=True)
CLOSE = mpmath.mpf(10) ** -40
RESULTS = "results"


def close(a, b):
    return abs(a - b) <= CLOSE * (1 + abs(b))


def exact(program, group, point):
    return interpret_exactly(program, point)[group]


def matrix(derived, group, point, shape):
    """Entries of a sparse result as a dense matrix."""
    dense = mpmath.zeros(*shape)
    entries = exact(derived.program, group, point)
    for (row, column), entry in zip(derived.pattern, entries, strict=True):
        dense[row, column] = entry
    return dense


def vector(product, point, kind, size):
    dense = [mpmath.mpf(0)] * size
    entries = exact(product.program, PRODUCT, point)
    for (k, slot), entry in zip(product.places, entries, strict=True):
        if k == kind:
            dense[slot] = entry
    return dense


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("kind", ["state", "parameter"])
def test_all_orders_of_elimination_agree(name, kind):
    system = SYSTEMS[name]()
    program = prune(lower_system(system), [RATES])
    point = values(system, 5)
    found = {}
    for mode in ORDERS:
        derived = jacobian(program, RATES, kind, [mode])
        assert derived.mode == mode
        assert exact(derived.program, RATES, point) == exact(program, RATES, point)
        entries = exact(derived.program, JACOBIAN, point)
        found[mode] = dict(zip(derived.pattern, entries, strict=True))
    for other in found.values():
        for place in {*found["forward"], *other}:
            assert close(other.get(place, 0), found["forward"].get(place, 0))


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", SYSTEMS)
def test_products_with_the_jacobian(name):
    """w^T J and J v against the matrix itself, weights and directions behind the inputs."""
    system = SYSTEMS[name]()
    program = prune(lower_system(system), [RATES])
    n, held = len(system.states), len(system.inputs)
    base = values(system, 7)
    w = [0.3 - 0.7 * k for k in range(n)]
    J = matrix(jacobian(program, RATES, "state", ["forward"]), JACOBIAN, base, (n, n))
    point = Point(base.t, base.x, base.p, [*base.u, *w])
    left = vjp(program, RATES, ("state", "parameter"), held)
    assert left.extra == (held, held + n)
    assert exact(left.program, RATES, point) == exact(program, RATES, base)
    with mpmath.workdps(50):
        for k, entry in enumerate(vector(left, point, "state", n)):
            assert close(entry, mpmath.fdot(w, J[:, k]))
        right = jvp(program, RATES, {"state": n}, held)
        for row, entry in enumerate(vector(right, point, "result", n)):
            assert close(entry, mpmath.fdot(J[row, :], w))
    P = matrix(jacobian(program, RATES, "parameter"), JACOBIAN, base, (n, len(system.parameters)))
    with mpmath.workdps(50):
        for k, entry in enumerate(vector(left, point, "parameter", len(system.parameters))):
            assert close(entry, mpmath.fdot(w, P[:, k]))


@given(st.sampled_from(EXPRESSIONS), st.tuples(*[nonzero(0.05, 2)] * 3), st.data())
def test_expressions_by_reverse_accumulation(expression, at, data):
    """The other modes are tested against differences in test_derivative."""
    program = lower_expressions({RESULTS: [expression, x * y]}, [x, y, z])
    w = data.draw(st.tuples(nonzero(0.1, 3), nonzero(0.1, 3)))
    forward = matrix(jacobian(program, RESULTS, modes=["forward"]), JACOBIAN, Point(x=at), (2, 3))
    found = vjp(program, RESULTS, modes=["reverse"])
    assert found.mode == "reverse"
    for k, entry in enumerate(vector(found, Point(x=at, u=w), "state", 3)):
        with mpmath.workdps(50):
            assert close(entry, w[0] * forward[0, k] + w[1] * forward[1, k])


SMOOTH = [
    x * y * z, x**3 * y**-2 + z, sp.sin(x * y) * sp.exp(z), sp.sqrt(x**2 + y**2 + z**2),
    sp.atan2(x, y * z), sp.tan(x) * sp.log(y**2 + 1), sp.tanh(x) / sp.cosh(y), x + 2 * y, sp.Integer(3),
    sp.Piecewise((x**2 * y, x < y), (y * z**3, True)), (x**2 + 1) ** (y / 3),
]  # fmt: skip


@pytest.mark.slow
@given(st.sampled_from(SMOOTH), st.tuples(*[nonzero(0.05, 2)] * 3))
def test_hessians_against_sympy(expression, at):
    program = lower_expressions({RESULTS: [expression]}, [x, y, z])
    found = hessian(program, RESULTS, place=0)
    assert all(column <= row for row, column in found.pattern)
    lower = matrix(found, HESSIAN, Point(x=at), (3, 3))
    exactly = dict(zip((x, y, z), map(sp.Rational, at), strict=True))
    wanted = sp.hessian(expression, (x, y, z)).subs(exactly).evalf(50)
    values = exact(found.program, RESULTS, Point(x=at))
    assert values == exact(program, RESULTS, Point(x=at))
    for row in range(3):
        for column in range(row + 1):
            with mpmath.workdps(50):
                assert close(lower[row, column], mpmath.mpf(str(wanted[row, column])))


@pytest.mark.sparse(3)
@pytest.mark.parametrize("name", SCENES)
def test_hessian_products_are_symmetric_and_those_of_the_hessian(name):
    """For w^T rates: u^T (H v) = v^T (H u), and both are the sparse matrix times the direction."""
    system = load_scene(name).derive()
    program = prune(lower_system(system), [RATES])
    n, held = len(system.states), len(system.inputs)
    base = values(system, 11)
    w, u, v = ([((k * a) % 7) / 3 - 1 for k in range(1, n + 1)] for a in (2, 3, 5))
    product = hessian_product(program, RATES, n, inputs=held)
    assert product.extra == (held, held + 2 * n)

    def times(direction):
        point = Point(base.t, base.x, base.p, [*base.u, *w, *direction])
        assert exact(product.program, RATES, point) == exact(program, RATES, base)
        return vector(product, point, "state", n)

    lower = matrix(
        hessian(program, RATES, inputs=held),
        HESSIAN,
        Point(base.t, base.x, base.p, [*base.u, *w]),
        (n, n),
    )
    with mpmath.workdps(50):
        assert close(mpmath.fdot(u, times(v)), mpmath.fdot(v, times(u)))
        for row, entry in enumerate(times(v)):
            whole = [lower[max(row, k), min(row, k)] for k in range(n)]
            assert close(entry, mpmath.fdot(whole, v))


@pytest.mark.sparse(3)
@pytest.mark.parametrize("name", [*SYSTEMS])
def test_gradients_cost_a_few_evaluations(name):
    """Griewank and Walther, sect. 3.3: a gradient costs at most four times the value; here by table."""
    system = SYSTEMS[name]()
    whole = lower_system(system)
    for group in (OUTPUTS, INVARIANTS):
        for place in range(len(whole.results[group])):
            program = prune(whole, [group])
            program = prune(
                type(program)(
                    program.instructions, {group: (program.results[group][place],)}, program.names
                )
            )
            derived = gradient(program, group)
            assert derived.program.cost() <= 4 * program.cost() + 4


def test_one_result_of_many_variables_is_differentiated_in_reverse():
    """Two layers of sines of sums: forward accumulation carries every variable through both."""
    layer = sp.symbols("x1:9")
    for factor in (3, 5):
        layer = [
            sp.sin(sum((k * factor + j) * value for j, value in enumerate(layer, 1)))
            for k in range(1, 7)
        ]
    program = lower_expressions({RESULTS: [sum(v**2 for v in layer)]}, sp.symbols("x1:9"))
    costs = {
        m: jacobian(program, RESULTS, modes=[m]).program.cost() for m in ("forward", "reverse")
    }
    chosen = jacobian(program, RESULTS)
    assert costs["reverse"] < costs["forward"] / 1.5
    assert chosen.mode != "forward"
    assert chosen.program.cost() <= costs["reverse"]


ZEROS = {
    "norm": (sp.sqrt(x**2 + y**2), (0, 0)),
    "angle": (sp.atan2(y, x), (0, 0)),
    "root": (x * sp.sqrt(y), (0, 0)),
    "end of asin": (sp.asin(x) * y, (1, 0)),
    "tie": (sp.Max(x, y) * sp.Min(x, y), (1, 1)),
    "modulus": (sp.Abs(x) * y, (0, 1)),
    "sinc": (sp.Piecewise((sp.sin(x) / x, sp.Ne(x, 0)), (1, True)) * y, (0, 1)),
    "cutoff": (sp.Piecewise((sp.log(x), x > 0), (y, True)), (0, 1)),
    "sine over root": (sp.Piecewise((x / sp.sqrt(x**2 + y**2), x**2 + y**2 > 0), (x, True)), (0, 0)),
}  # fmt: skip


@pytest.mark.parametrize("mode", ORDERS)
@pytest.mark.parametrize("name", ZEROS)
def test_derivatives_are_finite_where_mathematics_is(name, mode):
    expression, at = ZEROS[name]
    program = lower_expressions({RESULTS: [expression]}, [x, y])
    derived = jacobian(program, RESULTS, modes=[mode])
    assert all(map(mpmath.isfinite, exact(derived.program, JACOBIAN, Point(x=at))))
    left = vjp(program, RESULTS, modes=[mode])
    assert all(map(mpmath.isfinite, exact(left.program, PRODUCT, Point(x=at, u=(1.0,)))))


@pytest.mark.parametrize("mode", ORDERS)
def test_the_branch_that_is_not_chosen_leaves_no_trace(mode):
    """In the derivative of sin(x)/x for x != 0, else 1: at 0 the second branch alone counts."""
    program = lower_expressions({RESULTS: [ZEROS["sinc"][0]]}, [x, y])
    derived = jacobian(program, RESULTS, modes=[mode])
    entries = exact(derived.program, JACOBIAN, Point(x=(0.0, 3.0)))
    assert dict(zip(derived.pattern, entries, strict=True)) == {(0, 0): 0, (0, 1): 1}


def test_what_cancels_is_not_in_the_pattern():
    program = lower_expressions({RESULTS: [x * (y + z) - x * z]}, [x, y, z])
    assert jacobian(program, RESULTS).pattern == ((0, 0), (0, 1))


def test_the_same_program_gives_the_same_text():
    program = prune(lower_system(Scene.ready("gravity-gradient-satellite").derive()), [RATES])
    assert len({str(jacobian(program, RATES).program) for _ in range(2)}) == 1
    assert len({str(hessian(program, RATES).program) for _ in range(2)}) == 1
