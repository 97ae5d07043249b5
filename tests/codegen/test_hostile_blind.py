"""Hostile systems by someone who knew no code: a part of them, and all that were wrong or had no end."""

import numpy as np
import pytest

from benchmarks import hostile_blind
from codegen.native import native

CASES = hostile_blind.cases()
MENDED = {
    "gauss_bump_in_state": ("DOP853", "DP5", "Tsit5", "scipy:RK45"),
    "sin_to_the_4000": ("DOP853", "scipy:RK45", "scipy:Radau"),
    "backward_floor": ("DOP853", "scipy:RK45", "scipy:LSODA"),
}
"""A bump met between stages; a power at zero, which took tiny steps; a jump looked for without end."""
needs_compiler = pytest.mark.skipif(not native.compiler(), reason="methods in C")


def test_every_reference_is_a_state_of_its_problem():
    assert len(CASES) == 103
    for case in CASES.values():
        assert len(case["rates"]) == len(case["start"]) == len(case["end"]) == len(case["sizes"])
        assert np.isfinite(case["end"]).all()
        assert case["growth"] >= 1


@pytest.mark.sparse(only=("backward_floor",))
@needs_compiler
@pytest.mark.parametrize("name", MENDED)
def test_what_was_wrong_is_right(name):
    for method in MENDED[name]:
        assert hostile_blind.judged(name, CASES[name], method, 1e-6) == "ok", method


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize("method", ["auto", "taylor", "DP5", "scipy:LSODA"])
def test_an_edge_that_no_double_holds_is_reported(method):
    """A force of 1e6 begins there: what its time is known to is more than the tolerance allows."""
    case = CASES["window_last_microsecond"]
    assert hostile_blind.judged("edge", case, method, 1e-12) in {"ok", "reported"}


@pytest.mark.sparse(4)
@needs_compiler
@pytest.mark.parametrize("name", list(CASES)[::12])
def test_the_default_method_is_not_silently_wrong(name):
    assert not hostile_blind.judged(name, CASES[name], "auto", 1e-9).startswith("WRONG")


def test_an_error_is_seen():
    case = CASES["disguised_pendulum"]
    off = np.array(case["end"]) + 2e-3 * case["growth"] * np.array(case["sizes"])
    assert hostile_blind.known(case).share(off[:, None], 1e-6) == pytest.approx(2.0, rel=1e-6)
