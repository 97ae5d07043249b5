"""What is known of a system's structure: slots disappear, values stay, refusals say why."""

import pickle
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import codegen
import eom
from codegen.frontend.layout import names_of
from codegen.frontend.lower import lower_expressions
from codegen.frontend.structure import first_not_zero
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.passes import prune, substitute
from codegen.ir.program import RATES
from codegen.passes.pipeline import costs, specialised
from eom.errors import AssumptionError, InputError
from eom.mechanics.rigidbody import principal_inertia, rigid_body
from eom.mechanics.torques import applied
from eom.quantities import Quantity
from eom.system import System

PLANAR = {"psi": 0.0, "phi": 0.0, "omega_2": 0.0, "omega_3": 0.0}
"""A top that swings about one axis."""


def top():
    return eom.heavy_top("3-1-2")


def rates(program):
    return prune(program, [RATES])


def point(layout, values):
    groups = (layout.states, layout.parameters, layout.inputs)
    return Point(0.0, *([values[n] for n in names_of(group)] for group in groups))


def numbers(system, **fixed):
    names = (*system.state_names, *system.parameter_names, *system.input_names)
    return {n: 0.3 + 0.17 * k for k, n in enumerate(names)} | fixed


def test_a_symmetric_free_body_keeps_its_spin():
    """I2 = I1: the rate of omega_3 is zero, and one difference of inertias serves both others."""
    system = eom.free_rigid_body()
    program, layout = specialised(system, {"I2": "I1"})
    whole, _ = specialised(system)
    spin = program.instructions[program.results[RATES][2]]
    assert (spin.op, spin.value) == ("const", 0)
    assert names_of(layout.parameters) == ("I1", "I3")
    assert [costs(rates(p)) for p in (whole, program)] == [(6, 24), (4, 10)]
    sphere, layout = specialised(system, {"I2": "I1", "I3": "I2"})
    assert rates(sphere).cost() == 0
    assert names_of(layout.parameters) == ("I1",)


CASES = {
    "equal": ({"I2": "I1"}, {}, {}),
    "equal to a number": ({"I2": "I1", "I1": 2.0}, {}, {}),
    "a chain": ({"I1": "I2", "I2": "I3"}, {}, {}),
    "planar": ({}, PLANAR, {}),
    "planar, equal, numbers": ({"I2": "I1", "m": 2.0}, PLANAR, {}),
}


@pytest.mark.parametrize("case", CASES)
def test_results_are_those_of_the_whole_system_at_the_values_that_are_fixed(case):
    parameters, states, inputs = CASES[case]
    system = top()
    program, layout = specialised(system, parameters, states, inputs)
    whole, everything = specialised(system)
    values = numbers(system, **states, **inputs)
    values |= {n: v for n, v in parameters.items() if not isinstance(v, str)}
    for _ in range(3):  # names of names
        values |= {n: values[v] for n, v in parameters.items() if isinstance(v, str)}
    expected = interpret_exactly(whole, point(everything, values))
    found = interpret_exactly(program, point(layout, values))
    kept = [k for k, n in enumerate(system.state_names) if n not in states]
    dropped = [expected[RATES][k] for k in range(len(system.states)) if k not in kept]
    expected[RATES] = [expected[RATES][k] for k in kept]
    assert all(abs(v) < 1e-40 for v in dropped)
    assert layout.results[RATES] == tuple(system.state_names[k] for k in kept)
    for group, wanted in expected.items():
        for u, v in zip(wanted, found[group], strict=True):
            assert abs(u - v) <= 1e-40 * (1 + abs(u))
    assert rates(program).cost() <= rates(whole).cost()


def test_planar_motion_is_a_pendulum():
    program, layout = specialised(top(), states=PLANAR)
    assert names_of(layout.states) == ("omega_1", "theta")
    assert layout.coordinates == (1,)
    assert rates(program).cost() < 30
    assert rates(specialised(top())[0]).cost() > 100


def test_inputs_that_are_held_at_zero_leave_a_free_body():
    torques = [Quantity(sp.Symbol(f"tau_{k}", real=True)) for k in (1, 2, 3)]
    law = applied([q.symbol for q in torques], inputs=torques)
    system = rigid_body(principal_inertia(), lambda C, J: law, None, name="driven")
    inputs = dict.fromkeys(system.input_names, 0.0)
    assert inputs
    program, layout = specialised(system, inputs=inputs)
    assert layout.inputs == ()
    free, _ = specialised(eom.free_rigid_body())
    assert rates(program).counts() == rates(free).counts()


@pytest.mark.sparse(only=("numpy",))
def test_held_states_in_a_simulation(target):
    compiled = codegen.compile(top(), target, states=PLANAR)
    values = {"I1": 0.5, "I2": 0.4, "I3": 0.3, "m": 1.2, "g": 9.81, "r3": 0.2}
    start = {"omega_1": 0.4, "theta": 0.1}
    planar = codegen.simulate(compiled, start, (0.0, 0.2), values, rtol=1e-10)
    whole = codegen.simulate(top(), {**start, **PLANAR}, (0.0, 0.2), values, rtol=1e-10)
    same = codegen.simulate(compiled, {**start, **PLANAR}, (0.0, 0.2), values, rtol=1e-10)
    for name in start:
        assert planar[name][-1] == pytest.approx(whole[name][-1], rel=1e-8)
    assert np.array_equal(planar.y, same.y)
    with pytest.raises(InputError, match="state psi was compiled in"):
        codegen.simulate(compiled, {**start, **PLANAR, "psi": 0.1}, (0.0, 1.0), values)


def test_equal_parameters_in_a_simulation(target):
    compiled = codegen.compile(eom.free_rigid_body(), target, {"I2": "I1"})
    start = {"omega_1": 0.1, "omega_2": 0.0, "omega_3": 2.0}
    result = codegen.simulate(compiled, start, (0.0, 5.0), {"I1": 1.0, "I3": 1.5})
    assert np.all(result["omega_3"] == 2.0)
    with pytest.raises(InputError, match="parameter I2 was compiled in"):
        codegen.simulate(compiled, start, (0.0, 5.0), {"I1": 1.0, "I2": 1.0, "I3": 1.5})


def test_a_compiled_object_travels_with_its_structure():
    compiled = codegen.compile(top(), "numpy", {"I2": "I1", "m": 2.0}, PLANAR)
    other = pickle.loads(pickle.dumps(compiled))
    assert other.structure == compiled.structure
    assert str(other.program) == str(compiled.program)
    assert other.fixed == {"m": 2.0}
    assert repr(other) == repr(compiled)
    assert "m, I2, psi, phi, omega_2, omega_3 fixed" in repr(other)


@pytest.mark.parametrize(
    ("fixed", "words"),
    [
        ({"states": {"theta": 0.0}}, r"theta does not stay(.|\n)*omega_1, omega_3, phi: hold"),
        ({"states": {"phi": 0.0}}, r"d\(phi\)/dt = omega_2 - "),
        ({"states": {"thet": 0.0}}, "did you mean theta"),
        ({"states": {"theta": float("nan")}}, "state theta is not finite"),
        ({"states": {"theta": "phi"}}, "states are not numbers"),
        ({"inputs": {"tau": 0.0}}, "unknown input 'tau'"),
        ({"parameters": {"I2": "I4"}}, "unknown parameter 'I4'"),
        ({"parameters": {"J": "I1"}}, "unknown parameter 'J'"),
        ({"parameters": {"I2": "I2"}}, "circle(.|\n)*I2 = I2"),
        ({"parameters": {"I1": "I2", "I2": "I3", "I3": "I1"}}, "I1 = I2 = I3 = I1"),
        ({"parameters": {"I2": "I1", "I1": -1.0}}, "I1 is not positive"),
        ({"states": dict.fromkeys((*PLANAR, "omega_1", "theta"), 0.0)}, "no state is left"),
    ],
)  # fmt: skip
def test_refusals(fixed, words):
    with pytest.raises(InputError, match=words):
        specialised(top(), **fixed)


def test_equal_numbers_that_contradict_an_assumption_are_refused():
    """The third side of the triangle of principal moments: I1 + I2 >= I3."""
    with pytest.raises(AssumptionError):
        specialised(eom.free_rigid_body(), {"I2": "I1", "I1": 1.0, "I3": 2.5})


def test_a_rate_that_is_zero_only_by_an_identity_counts_as_zero():
    u, v = sp.symbols("u v", real=True)
    hidden = sp.sin(v) ** 2 + sp.cos(v) ** 2 - 1
    system = System.from_rates("hidden", {u: u * v + hidden, v: -u - v})
    program, layout = specialised(system, states={"u": 0.0})
    assert names_of(layout.states) == ("v",)
    assert rates(program).counts() == {"neg": 1}
    almost = System.from_rates("almost", {u: hidden + sp.Rational(1, 10**30) * v, v: -u - v})
    with pytest.raises(InputError, match="u does not stay"):
        specialised(almost, states={"u": 0.0})


def test_a_rate_without_a_value_is_not_zero():
    u, v = sp.symbols("u v", real=True)
    program = lower_expressions({"f": [sp.log(-u - v) * 0 + sp.log(-v)]}, [u, v])
    assert first_not_zero(program, "f")[0] == 0


def test_slots_and_numbers_take_the_place_of_slots():
    u, v, p, q = sp.symbols("u v p q", real=True)
    program = lower_expressions({"f": [u * p - v * q]}, [u, v], [p, q])
    leaves = {("parameter", 1): ("parameter", 0), ("state", 1): ("state", 0)}
    assert substitute(program, leaves).counts() == {}
    held = substitute(program, {("state", 0): Fraction(2), ("state", 1): ("state", 0)})
    (value,) = interpret_exactly(held, Point(x=[3.0], p=[5.0, 7.0]))["f"]
    assert value == 2 * 5 - 3 * 7


def test_attitude_of_a_planar_body_needs_no_sequence_left():
    """A free body that turns about one axis: the angle alone remains."""
    system = eom.free_rigid_body("3-1-2")
    held = dict.fromkeys(set(system.state_names) - {"omega_3", "psi"}, 0.0)
    program, layout = specialised(system, states=held)
    assert names_of(layout.states) == ("omega_3", "psi")
    assert rates(program).counts() == {}
