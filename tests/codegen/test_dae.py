"""Residual forms solved by IDA against the explicit way and a closed form."""

import math

import numpy as np
import pytest

import codegen
from codegen.native import native
from eom.errors import InputError
from eom.multibody import assemble, derive
from eom.multibody.system.implicit import implicit
from tests.eom.multibody.bound import LENGTHS, NEAR, four_bar, point_mass_free, sleigh

pytest.importorskip("sksundae")
from codegen.linearisation.dae import solve

TARGET = "auto" if native.compiler() else "numpy"


def pair_of(given):
    pair = implicit(given)
    compiled = [codegen.compile(s, TARGET) for s in (pair.residual, pair.explicit)]
    return pair, *compiled


@pytest.mark.slow
def test_a_four_bar_linkage_by_ida_is_the_same():
    given = four_bar()
    start = assemble(given, {**LENGTHS, **NEAR, "u_a": 10.0}, keep=("q_a", "u_a"))
    pair, F, f = pair_of(given)
    system = derive(given)
    times = np.linspace(0, 0.4, 5)
    initial = {n: start.values[n] for n in system.state_names}
    found = solve(F, f, initial, times, LENGTHS, rtol=1e-7, atol=1e-9)
    assert found.success
    compiled = codegen.compile(system, TARGET)
    other = codegen.simulate(compiled, initial, (0, 0.4), LENGTHS, "DOP853", 1e-9, t_eval=times)
    for name in system.state_names:
        assert found[name] == pytest.approx(other[name], rel=1e-4, abs=1e-4)
    states = np.array([found[n] for n in system.state_names])
    p = np.array([LENGTHS[n] for n in system.parameter_names])
    left = compiled.invariants(times, states, p, np.empty(0))[: len(system.maintained)]
    assert np.abs(left).max() < 1e-6
    assert pair.residual.state_names[-2:] == ("slack_pin_x", "slack_pin_y")


def test_the_generated_jacobian_is_the_derivative():
    _, F, f = pair_of(four_bar())
    draw = np.random.default_rng(5)
    n = len(F.layout.states)
    y, slopes, p = draw.normal(size=n), draw.normal(size=n), draw.uniform(0.5, 1.5, 5)
    for by, point in (("states", y), ("inputs", slopes)):
        exact = F.jacobian(by, "outputs")
        A = np.zeros((n, n))
        A[list(exact.rows), list(exact.columns)] = exact(0.0, y, p, slopes)
        h = 1e-5
        for k in range(n):
            ends = []
            for sign in (1, -1):
                moved = point.copy()
                moved[k] += sign * h
                args = (moved, p, slopes) if by == "states" else (y, p, moved)
                ends.append(F.outputs(0.0, *args))
            assert (ends[0] - ends[1]) / (2 * h) == pytest.approx(A[:, k], rel=1e-6, abs=1e-7)
    assert f.rhs(0.0, y, p, np.empty(0)).shape == (n,)


def test_a_sleigh_has_no_slack_and_ends_straight():
    p = {"b": 0.3, "m": 2.0, "J": 0.5}
    k = 0.3 * 1.2 * 2.0 / (0.5 + 2.0 * 0.09)
    pair, F, f = pair_of(sleigh())
    assert pair.residual.state_names[-1] == "impulse_edge"
    start = {"u_j": math.sqrt(k * 1.2 / 0.3)}
    found = solve(F, f, start, [0, 1, 2], p)
    assert found["v_j_1"][-1] == pytest.approx(1.2 * math.tanh(2 * k), rel=1e-6)


def test_what_is_no_residual_form_is_refused():
    given = four_bar()
    explicit = implicit(given).explicit
    with pytest.raises(InputError, match="not a residual form"):
        solve(codegen.compile(explicit, "numpy"), codegen.compile(explicit, "numpy"), {}, [0, 1])
    with pytest.raises(InputError, match="without constraints"):
        implicit(point_mass_free())
