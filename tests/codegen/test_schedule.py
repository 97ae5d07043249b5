"""Another order of the same instructions: bit for bit the same values, fewer of them waiting."""

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir.interpret import Point, interpret
from codegen.ir.passes import prune
from codegen.ir.program import RATES, Builder
from codegen.passes.pipeline import MAX_SHARE, _Scheduler, pressure, reordered, schedule
from eom.opening import load_scene
from tests.clock import growth_in_calls
from tests.codegen.scenes import SCENES

x, y, z = sp.symbols("x y z", real=True)


def chosen(program):
    """The new order, whether it is better or not."""
    return reordered(program, _Scheduler(program).order())


def wide(count):
    """All products first, then their sum: as many values wait as there are terms."""
    b = Builder()
    leaves = [b.leaf("state", k) for k in range(8)]
    products = [b.add("mul", leaves[k % 8], b.const(k + 3)) for k in range(count)]
    total = products[0]
    for k in products[1:]:
        total = b.add("add", total, k)
    return b.program({"f": [total]})


def test_pressure_counts_what_waits():
    b = Builder()
    u, v = b.leaf("state", 0), b.leaf("state", 1)
    s, d = b.add("add", u, v), b.add("sub", u, v)
    assert pressure(b.program({"f": [s, d]})) == 2
    assert pressure(b.program({"f": [b.add("mul", s, d)]})) == 2
    assert pressure(lower_expressions({"f": [x]}, [x])) == 0
    chain = lower_expressions({"f": [sp.sin(sp.sin(sp.sin(x)))]}, [x])
    assert pressure(chain) == 1


def test_a_sum_of_products_needs_few_values():
    program = wide(60)
    after = schedule(program)
    assert pressure(program) == 60
    assert pressure(after) == 2
    at = Point(x=[0.1 * k - 0.3 for k in range(8)])
    assert interpret(after, at) == interpret(program, at)


@pytest.mark.sparse(3)
@pytest.mark.parametrize("name", SCENES)
def test_ready_scenes_keep_their_instructions_and_bits(name):
    system = load_scene(name).derive()
    program = prune(lower_system(system), [RATES])
    after = chosen(program)
    assert after.counts() == program.counts()
    point = Point(
        0.3,
        [0.2 + 0.1 * k for k in range(len(system.states))],
        [1.0 + 0.3 * k for k in range(len(system.parameters))],
        [0.5 - 0.2 * k for k in range(len(system.inputs))],
    )
    assert interpret(after, point) == interpret(program, point)
    assert {n.name for n in after.names.values()} == {n.name for n in program.names.values()}


steps = st.tuples(
    st.sampled_from(["add", "sub", "mul", "sin", "neg"]), st.integers(0), st.integers(0)
)


@given(st.lists(steps, min_size=1, max_size=40), st.lists(st.integers(0), min_size=1, max_size=5))
def test_any_program_keeps_its_values(steps, results):
    b = Builder()
    numbers = [b.leaf("state", k) for k in range(3)]
    for op, i, j in steps:
        args = [numbers[i % len(numbers)], numbers[j % len(numbers)]]
        numbers.append(b.add(op, *args[: 1 if op in {"sin", "neg"} else 2]))
    program = prune(b.program({"f": [numbers[-1 - k % len(numbers)] for k in results]}))
    at = Point(x=[0.7, -1.3, 2.1])
    after, kept = chosen(program), schedule(program)
    assert repr(interpret(after, at)) == repr(interpret(program, at))
    assert kept is program or pressure(kept) <= MAX_SHARE * pressure(program)


@pytest.mark.slow
def test_work_is_nearly_linear():
    assert growth_in_calls(11, schedule, wide(1000), wide(10_000))
