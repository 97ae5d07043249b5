"""The passes of every compiled program: values and bits by their laws, costs that never rise."""

import dataclasses

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from sympy.physics.mechanics.models import n_link_pendulum_on_cart

import codegen
from codegen.derivatives.derivative import jacobian
from codegen.frontend.from_sympy_mechanics import as_system
from codegen.frontend.lower import lower_expressions, lower_system
from codegen.ir.fold import RULE_SETS
from codegen.ir.interpret import Point, interpret, interpret_exactly
from codegen.ir.passes import prune
from codegen.ir.program import RATES, Builder
from codegen.passes.pipeline import PASSES, costs, join, optimise, steps
from eom.kinematics.coordinates import attitude
from eom.mechanics.gyrostat import gyrostat
from eom.mechanics.rigidbody import full_inertia, rigid_body
from eom.mechanics.torques import weight
from eom.opening import load_scene
from eom.scenes import catalogue
from tests.clock import growth_in_calls

ULP = 2.0**-53


def full(sequence):
    return rigid_body(full_inertia(), lambda C, J: weight(C), attitude(sequence), name="full")


SYSTEMS = {
    **{n: lambda n=n: load_scene(n).derive() for n in catalogue.names()},
    "full 3-1-2": lambda: full("3-1-2"),
    "full 1-2-3": lambda: full("1-2-3"),
    "full quaternion": lambda: full("quaternion"),
    "gyrostat": lambda: gyrostat(3, inertia=full_inertia(), attitude=attitude("3-1-2")),
    "pendulum": lambda: as_system(n_link_pendulum_on_cart(3), "pendulum"),
}


def point(system, seed):
    draw = np.random.default_rng(seed).uniform
    p = draw(0.5, 1.5, len(system.parameters))
    if "I12" in system.parameter_names:  # a positive definite tensor of inertia
        off = [n[1:] in {"12", "13", "23"} for n in system.parameter_names]
        p = np.where(off, 0.1 * p, 3 * p)
    x, u = draw(-1, 1, len(system.states)), draw(-1, 1, len(system.inputs))
    return Point(float(draw()), list(map(float, x)), list(map(float, p)), list(map(float, u)))


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", SYSTEMS)
def test_systems_keep_their_values_and_no_group_costs_more(name):
    system = SYSTEMS[name]()
    before = lower_system(system)
    after = optimise(before)
    assert list(after.results) == list(before.results)
    worst = {"before": 0.0, "after": 0.0}
    for seed in range(3):
        at = point(system, seed)
        exact, again = interpret_exactly(before, at), interpret_exactly(after, at)
        rounded = {"before": interpret(before, at), "after": interpret(after, at)}
        for group, values in exact.items():
            scale = max(map(abs, values), default=0)
            for k, value in enumerate(values):
                assert abs(value - again[group][k]) <= 1e-42 * (1 + scale)
                for which, found in rounded.items():
                    error = float(abs(found[group][k] - value) / scale) if scale else 0.0
                    worst[which] = max(worst[which], error)
    assert worst["after"] <= 2 * worst["before"] + 8 * ULP
    for group in before.results:
        old, new = (costs(prune(p, [group])) for p in (before, after))
        assert new <= old


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", ["gravity-gradient-satellite", "full 3-1-2", "pendulum"])
def test_jacobians_keep_their_values_and_cost_less(name):
    system = SYSTEMS[name]()
    before = jacobian(prune(lower_system(system), [RATES]), RATES).program
    after = optimise(before)
    at = point(system, 1)
    exact, again = interpret_exactly(before, at), interpret_exactly(after, at)
    for group, values in exact.items():
        for u, v in zip(values, again[group], strict=True):
            assert abs(u - v) <= 1e-42 * (1 + abs(u))
    entries = (prune(p, ["jacobian"]) for p in (after, before))
    assert costs(next(entries)) < costs(next(entries))


def test_a_pendulum_of_six_links_costs_two_thirds():
    """The unrolled factorisation and the forces of SymPy's method: 1,193 additions before."""
    program = prune(lower_system(as_system(n_link_pendulum_on_cart(6), "six")), [RATES])
    assert optimise(program).cost() < 0.67 * program.cost()


def test_each_step_is_a_pass_of_the_table_that_lowers_the_cost_or_keeps_all_operations():
    program = prune(lower_system(SYSTEMS["pendulum"]()), [RATES])
    met = set()
    for p, after in steps(program):
        met.add(p.name)
        if p.exact:
            assert after.counts() == program.counts()
        else:
            assert costs(after) < costs(program)
        program = after
    assert met <= {p.name for p in PASSES}
    assert all(p.law for p in PASSES)
    assert len(met) >= 4


def test_the_same_program_gives_the_same_text():
    system = SYSTEMS["pendulum"]()
    assert str(optimise(lower_system(system))) == str(optimise(lower_system(system)))


x, y, z = sp.symbols("x y z", real=True)
SPECIAL = [0.0, -0.0, np.inf, -np.inf, np.nan, 1.5, -2.25, 5e-324, 1.7e308]


@given(st.tuples(*[st.sampled_from(SPECIAL)] * 3))
def test_exact_rules_keep_every_bit(at):
    """Operation by operation as lowered without any folding."""
    expressions = [x * y + x * z, x / z + y / z - x, (x + y) - (y + x), x * y * z + y * z * x / 2]
    found = []
    for rules in (
        RULE_SETS["exact"],
        dataclasses.replace(RULE_SETS["exact"], laws={}),
    ):
        b = Builder(rules)
        leaves = {s: b.leaf("state", k) for k, s in enumerate((x, y, z))}
        program = b.program({"f": [_as_written(b, e, leaves) for e in expressions]})
        found.append(interpret(optimise(program) if not found else program, Point(x=at))["f"])
    assert [repr(v) for v in found[0]] == [repr(v) for v in found[1]]


def _as_written(b, e, leaves):
    if e in leaves:
        return leaves[e]
    if e.is_Rational:
        return (
            b.const(int(e)) if e.is_Integer else b.add("div", b.const(int(e.p)), b.const(int(e.q)))
        )
    op = {sp.Add: "add", sp.Mul: "mul", sp.Pow: "pow"}[e.func]
    first, *rest = (_as_written(b, a, leaves) for a in e.args)
    for k in rest:
        first = b.add(op, first, k)
    return first


def test_rules_are_chosen_by_name(target):
    system = eom_system()
    algebraic, exact = (
        codegen.compile(system, target, rules=rules) for rules in ("algebraic", "exact")
    )
    assert algebraic.rhs(0.0, [np.inf, 1.0]).tolist()[0] == 0.0
    assert np.isnan(exact.rhs(0.0, [np.inf, 1.0])[0])
    with pytest.raises(codegen.compiling.compiled.InputError, match="did you mean exact"):
        codegen.compile(system, target, rules="exakt")


def eom_system():
    """SymPy does not see that the difference is zero; the value numbers do."""
    from eom.quantities import Definition, Quantity
    from eom.system import System

    r, s = sp.symbols("r s", real=True)
    named = [Definition(Quantity(q), x * y) for q in (r, s)]
    return System("difference", (Quantity(x), Quantity(y)), (r - s, x), definitions=tuple(named))


def test_join_folds_nothing_and_keeps_each_group():
    left = lower_expressions({"f": [x + y * z]}, (x, y, z))
    right = lower_expressions({"g": [y * z, z - y]}, (x, y, z))
    both = join({"f": left, "g": right})
    at = Point(x=[1.0, 2.0, 5.0])
    assert interpret(both, at) == interpret(left, at) | interpret(right, at)
    assert both.counts() == {"add": 1, "sub": 1, "mul": 1}
    assert prune(both, ["f"]).counts() == left.counts()


def chain(count):
    b = Builder()
    leaves = [b.leaf("state", k) for k in range(12)]
    values = list(leaves)
    for k in range(count):
        i, j = (7 * k + 3) % 12, (5 * k + k // 12) % 12
        product = b.add("mul", values[-1 - i], leaves[j])
        values.append(b.add("add" if k % 2 else "sub", product, values[-1 - (3 * k) % 12]))
    return b.program({"f": values[-12:]})


@pytest.mark.slow
def test_work_is_nearly_linear():
    assert growth_in_calls(9, optimise, chain(800), chain(6400))
