"""Early factors go together and powers of two where they cost less; values stay the same."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings

import eom
from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir.interpret import Point, interpret, interpret_exactly, random_point
from codegen.ir.passes import prune
from codegen.ir.program import RATES, Builder
from codegen.passes.gather import gather
from codegen.passes.pipeline import by_parameters, join, reciprocals, specialised
from codegen.passes.strength import rescale
from eom.opening import load_scene
from tests.codegen.scenes import SCENES
from tests.codegen.test_compiled import TIME, expressions, modest, p, points, q, reliable, x, y, z
from tests.codegen.test_stages import PROGRAMS

a, b, c = sp.symbols("a b c", positive=True)
PASSES = {"gather": gather, "rescale": rescale}
CHANGES = pytest.mark.parametrize("change", PASSES.values(), ids=PASSES)


def late(program):
    return by_parameters(program).late


def lowered(*found):
    return lower_expressions({"f": found}, (x, y, z), (a, b, c))


@pytest.mark.sparse(1)
@CHANGES
@pytest.mark.parametrize("name", PROGRAMS)
def test_values_of_scenes_do_not_change(name, change):
    program = reciprocals(PROGRAMS[name]())
    changed = join({g: change(prune(program, [g])) for g in program.results})
    point = random_point(program, 5)
    before, after = (interpret_exactly(q, point) for q in (program, changed))
    for group, numbers in before.items():
        for one, other in zip(numbers, after[group], strict=True):
            assert abs(one - other) <= 1e-45 * (1 + abs(one))
    for group in program.results:
        assert late(prune(changed, [group])).cost() <= late(prune(program, [group])).cost()


@pytest.mark.slow
@settings(max_examples=150)
@given(expressions, points(modest))
def test_values_of_random_expressions_do_not_change(e, v):
    program = lower_expressions({"f": [e]}, (x, y, z), (p, q, TIME))
    changed = rescale(gather(program))
    point = Point(x=v[:3], p=v[3:])
    (one,), (other,) = (interpret_exactly(r, point)["f"] for r in (program, changed))
    if reliable(program, point)[program.results["f"][0]]:
        assert one == other or abs(one - other) <= 1e-40 * (1 + abs(one)), (one, other)
    assert late(changed).cost() <= late(program).cost()


GATHERED = {
    "a factor of each": (a * x * (b * y), {"mul": 2}),
    "through a quotient": (a * x / (b * y), {"mul": 1, "div": 1}),
    "into a sum": ((a * x - b * y) * c, {"mul": 2, "sub": 1}),
    "into a sum of three": ((a * x - b * y + 2 * z) / c, {"mul": 3, "sub": 1, "add": 1}),
    "not into a bare term": ((a * x + y) * c, {"mul": 2, "add": 1}),
    "out of a sum": (a * x + a * y, {"mul": 1, "add": 1}),
    "a sign into a difference": (-a * (x - y) - b * z, {"mul": 2, "sub": 2}),
    "numbers": (2 * x * (3 * y), {"mul": 2}),
}


@pytest.mark.parametrize("name", GATHERED)
def test_what_is_left_to_a_call(name):
    expression, counts = GATHERED[name]
    program = lowered(expression)
    assert late(gather(reciprocals(program))).counts() == counts
    before, after = (
        interpret_exactly(r, Point(x=(0.3, 0.7, -1.1), p=(1.3, 0.6, 2.1)))["f"][0]
        for r in (program, gather(reciprocals(program)))
    )
    assert abs(before - after) < 1e-45


def test_shared_products_are_not_taken_apart():
    shared = a * x * y
    found = (shared * z, shared + x, shared - z)
    program = lowered(*found)
    assert late(gather(program)).cost() <= late(program).cost()


def test_halves_of_a_quaternion_s_rates_go_into_the_angular_velocity():
    program = prune(lower_system(eom.free_rigid_body("quaternion")), [RATES])
    before, after = late(gather(program)).counts(), late(rescale(gather(program))).counts()
    assert before["mul"] - after["mul"] == 1
    point = random_point(program, 1)
    assert interpret(rescale(gather(program)), point) == interpret(gather(program), point)


def test_a_product_with_a_power_of_two_inside_another_one():
    b = Builder()
    u, v, w = (b.leaf("state", k) for k in range(3))
    inner = b.add("mul", b.const(2), b.add("add", u, v))
    outer = b.add("mul", b.const(2), b.add("add", inner, w))
    program = b.program({"f": [outer, b.add("mul", b.const(2), w)]})
    point = random_point(program, 1)
    assert interpret(rescale(program), point) == interpret(program, point)
    assert rescale(program).counts() == {"add": 2, "mul": 2}


@pytest.mark.sparse(3)
@pytest.mark.parametrize("name", SCENES)
def test_errors_stay_within_a_few_units_in_the_last_place(name):
    system = load_scene(name).derive()
    program = lower_system(system)
    changed, _ = specialised(system, {})
    for seed in range(20):
        point = random_point(program, seed)
        exact = np.array(interpret_exactly(program, point)[RATES], dtype=float)
        found = np.array(interpret(changed, point)[RATES])
        assert np.abs(found - exact).max() <= 16 * np.finfo(float).eps * np.abs(exact).max()
