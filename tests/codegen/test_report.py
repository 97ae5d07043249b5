import pytest
import sympy as sp

from codegen.ir.passes import prune
from codegen.ir.program import RATES
from codegen.passes.pipeline import specialised
from codegen.precision.accuracy_report import report, tree_operations
from eom.opening import load_scene
from eom.quantities import Definition, Quantity
from eom.system import System
from tests.codegen.scenes import SCENES

x, y = sp.symbols("x y", real=True)


@pytest.mark.sparse(3)
@pytest.mark.parametrize("name", SCENES)
def test_stages_never_cost_more_and_end_with_what_is_compiled(name):
    scene = load_scene(name)
    system, values = scene.derive(), scene.parameter_values()
    found = report(system, values)
    counts = [s.operations for s in found.stages]
    assert counts == sorted(counts, reverse=True)
    program, _ = specialised(system, values)
    assert found.kinds == prune(program, [RATES]).counts()
    assert sum(found.kinds.values()) == counts[-1]
    assert all(size > 100 for size in found.sizes.values())


def test_operations_of_the_tree_count_every_use():
    shared = x * y + 1
    system = System.from_rates("shared", {x: shared**2 + shared, y: sp.sin(shared)})
    assert tree_operations(system) == (2 + 1) + 1 + 2 + (2 + 1)


def test_definitions_are_counted_in_linear_time():
    deep, definitions = x, []
    for k in range(200):
        named = sp.Symbol(f"d{k}", real=True)
        definitions.append(Definition(Quantity(named), sp.sin(deep) + deep * y))
        deep = named
    system = System(
        "deep",
        (Quantity(x), Quantity(y)),
        (deep, sp.Integer(0)),
        definitions=tuple(definitions),
    )
    assert tree_operations(system) > 2**200
