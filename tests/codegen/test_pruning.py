"""Only what requested outputs need is integrated, and the rest of the result is the same."""

import pickle

import numpy as np
import pytest
import sympy as sp

import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.native import native
from codegen.runs import pruning
from eom.errors import InputError
from eom.quantities import Singularity
from eom.system import System

WHEEL = eom.Scene.ready("lecture-wheel").full_system
START = {"theta": 0.3, "psi": 1.0, "phi": -2.0, "theta_dot": 0.1, "psi_dot": 0.2, "C": 30.0}


@pytest.fixture(scope="module", params=["c", "numpy"])
def wheel(request):
    if request.param == "c" and not native.compiler():
        pytest.skip("needs a C compiler")
    return compile_system(WHEEL, request.param)


@pytest.fixture(scope="module")
def values(wheel):
    known = eom.Scene.ready("lecture-wheel").parameter_values()
    return {q.name: known[q.name] for q in wheel.layout.parameters}


def run(wheel, values, **options):
    start = {q.name: START[q.name] for q in wheel.layout.states}
    return simulate(wheel, start, (0, 0.5), values, "DOP853", 1e-11, t_eval=[0.1, 0.5], **options)


def test_cyclic_angles_are_left_out_and_reported(wheel, values):
    whole, less = run(wheel, values), run(wheel, values, outputs=["theta", "Omega"])
    assert {"psi", "phi"} <= set(less.left_out)
    assert "psi" not in less.names
    assert list(less.outputs) == ["Omega"]
    for name in ("theta", "Omega", "theta_dot"):
        np.testing.assert_allclose(less[name], whole[name], rtol=0, atol=1e-8)
    assert whole.left_out == ()


def test_an_angle_that_is_asked_for_is_integrated(wheel, values):
    less = run(wheel, values, outputs=["phi"])
    assert "phi" in less.names
    assert "psi" in less.left_out
    assert less.outputs == {}


def test_invariants_stay_where_all_their_states_do(wheel, values):
    whole, less = run(wheel, values), run(wheel, values, outputs=["theta"])
    assert set(less.drift) <= set(whole.drift)
    for name in set(whole.drift) - set(less.drift):
        assert name in less.left_out
    for name, drift in less.drift.items():
        assert drift.start == pytest.approx(whole.drift[name].start, rel=1e-14)


def test_everything_asked_for_is_the_same_object(wheel):
    names = [*WHEEL.state_names, *WHEEL.output_names]
    part = pruning.part(wheel, names)
    assert part.compiled is wheel
    assert pruning.part(wheel, ["theta"]).compiled is pruning.part(wheel, ["theta"]).compiled


def test_initial_values_may_be_in_order_or_without_what_is_left_out(wheel, values):
    options = {"method": "DOP853", "outputs": ["theta"]}
    ordered = [START[q.name] for q in wheel.layout.states]
    a = simulate(wheel, ordered, (0, 0.2), values, **options)
    few = {n: v for n, v in START.items() if n in a.names}
    b = simulate(wheel, few, (0, 0.2), values, **options)
    assert np.array_equal(a.y, b.y)
    with pytest.raises(InputError, match="unknown"):
        simulate(wheel, {**few, "thetta": 1.0}, (0, 0.2), values, **options)
    with pytest.raises(InputError, match="unknown"):
        simulate(wheel, few, (0, 0.2), values, outputs=["tehta"])


def test_states_close_ranks_and_singularities_go_with_their_states():
    a, b, c, d = sp.symbols("a b c d", real=True)
    base = System.from_rates(
        "mixed", {a: b, b: c * d, c: -d, d: c}, outputs={"sum": c + d, "all": a + b}
    )
    places = (Singularity(b - 100, b, "far"), Singularity(c - sp.Rational(1, 2), c, "half"))
    system = System("mixed", base.states, base.rates, outputs=base.outputs, singularities=places)
    result = simulate(system, (0.0, 0.0, 1.0, 0.0), (0, 3), outputs=["sum"], rtol=1e-12)
    assert result.names == ("c", "d")
    assert result.left_out == ("a", "b")
    assert result.status == 1
    assert "c = 0.50000" in result.message
    assert "half" in result.message
    assert result.t_stop == pytest.approx(np.pi / 3, abs=1e-5)
    assert set(simulate(system, (0.0, 0.0, 1.0, 0.0), (0, 1), outputs=["all"]).names) == {*"abcd"}


def test_outputs_of_parameters_alone_keep_one_state():
    a, b, k = sp.symbols("a b k", real=True)
    system = System.from_rates("still", {a: -a, b: a}, outputs={"twice": 2 * k})
    result = simulate(system, (1.0, 0.0), (0, 1), {"k": 2.0}, outputs=["twice"])
    assert result.names == ("a",)
    assert np.all(result["twice"] == 4.0)


def test_a_part_is_pickled_by_what_it_is_a_part_of():
    a, b = sp.symbols("a b", real=True)
    whole = compile_system(System.from_rates("pair", {a: -a, b: a}), "numpy")
    part = pruning.part(whole, ["a"]).compiled
    again = pickle.loads(pickle.dumps(part))
    assert again.layout == part.layout
    assert again.rhs(0.0, [2.0]) == pytest.approx([-2.0])
