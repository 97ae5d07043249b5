"""Single edits of the steps of every derivation: false ones are caught, true ones are let pass.

The truth is decided by numerics that know nothing of the checker (`oracle`). The complete form is
``python -m benchmarks.mutants``.
"""

import random
import signal
import subprocess
import sys

import pytest

from eom.derivations import derive, names
from eom.terms.terms import Equation, column, cross, der, dot, integral, matmul, number, tilde, zero
from eom.terms.vocabulary import omega, position, quantity, unit, velocity
from tests.eom import chapters, oracle
from tests.eom import mutants as trial
from tests.eom.mutants import Count, edits_of, judged_steps, mutants
from tests.eom.rows import DERIVED, derivations, long_too

MADE = [(8, DERIVED), pytest.param((60, names()), marks=pytest.mark.slow)]
"""How many steps are drawn, and of which derivations."""
TORQUE = quantity("torque", "body", "C")


@pytest.fixture(scope="module", params=MADE, ids=["some", "all"])
def sample(request):
    """Six edits of each of some steps, drawn at random."""
    count, chosen_names = request.param
    generator = random.Random(1)
    made = [derive(n) for n in chosen_names]
    chosen = []
    steps = [(d, step) for d in made for step in judged_steps(d)]
    for d, step in generator.sample(steps, count):
        found = list(mutants(step.statement, step.assumptions))
        chosen += [(d, step, m) for m in generator.sample(found, min(6, len(found)))]
    return chosen


def test_edits_that_are_really_false_are_rejected_and_true_ones_are_not(sample):
    count = Count()
    for one in sample:
        count.add(*one)
    assert count.really_false > 0.55 * len(sample)
    assert not count.missed, "\n".join(count.wrong)


@pytest.mark.parametrize("verdict", ["accepted", "rejected"])
def test_a_checker_that_does_not_look_is_found_out(sample, monkeypatch, verdict):
    monkeypatch.setattr(trial, "judge", lambda *_: verdict)
    count = Count()
    for one in sample:
        count.add(*one)
    assert count.missed
    assert count.wrong


@pytest.mark.parametrize("name", long_too(derivations(), "gravity-gradient-stability"))
def test_every_step_is_true_by_numerics(name):
    d = derive(name)
    for step in judged_steps(d):
        if chapters.is_conditional(
            step
        ):  # `derivations.test_chapters` draws what meets the conditions
            continue
        try:
            assert chapters.is_true(d, step.statement, step.assumptions), step.label
        except oracle.Undefined:
            assert d.own, step.label


@pytest.mark.parametrize(
    ("assumption", "vector"),
    [
        (("torque_free",), TORQUE),
        (("torque_free", "symmetric"), TORQUE),
        (("rigid", "body_frame"), der(position("dm", "C"), "B")),
        (("O_fixed_in_body", "body_frame"), der(position("O", "C"), "B")),
        (("C_at_rest", "rigid"), velocity("C")),
        (("O_at_origin",), position("O")),
    ],
)
def test_motions_of_the_oracle_satisfy_their_assumptions_and_no_more(assumption, vector):
    equation = Equation(vector, zero("vector"))
    assert oracle.is_true(equation, assumption, {})
    assert not oracle.is_true(equation, ("newton_2", "rigid", "third_law_strong"), {})


@pytest.mark.parametrize("axis", [2, 3])
def test_spin_without_torque_needs_none_about_that_axis_alone(axis):
    about = ("third_law_strong", "newton_2", f"no_torque_{axis}")
    for k in (1, 2, 3):
        row = Equation(dot(unit("B", k), TORQUE), number(0))
        assert oracle.is_true(row, about, {}) == (k == axis)


def test_frames_of_the_oracle_turn_with_their_angular_velocity():
    C = quantity("rotation", "B", "I")
    turning = matmul(tilde(column(omega(), "B")), C)
    for assumed in ((), ("torque_free",), ("spin_312",), ("viscous_slug",), ("no_torque_3",)):
        assert oracle.is_true(Equation(der(C), -turning), assumed, {})
        assert not oracle.is_true(Equation(der(C), turning), assumed, {})


def test_edits_are_single_distinct_and_of_every_kind():
    d = derive("rigid-body-momentum")
    found = [m for _, _, m in edits_of([d]) if m.equation is not None]
    kinds = {m.kind for m in found}
    assert kinds == set("sign factor transpose dropped exchanged frame derivative index".split())
    step = d["H-terms"]
    one = [m.equation for m in mutants(step.statement, ()) if m.equation]
    assert len(set(one)) == len(one) > 20
    assert step.statement not in one
    r = position("dm", "C")
    crossed = Equation(integral(cross(r, der(r))), zero("vector"))
    swapped = Equation(integral(cross(der(r), r)), zero("vector"))
    assert swapped in [m.equation for m in mutants(crossed, ())]


def test_a_run_that_is_stopped_tells_what_it_has_judged():
    asked = ["inertia-of-rod", "inertia-properties"]
    run = subprocess.Popen(
        [sys.executable, "-m", "benchmarks.mutants", *asked],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    first = run.stderr.readline()
    run.send_signal(signal.SIGTERM)
    told, _ = run.communicate(timeout=60)
    assert first.startswith("inertia-of-rod: 334 edits in ")
    assert "false, rejected" in first
    last_row, left = told.splitlines()[-3], told.splitlines()[-1]
    assert int(last_row.split("│")[2]) >= 334
    assert left == "Stopped before the end; not judged, or not wholly: inertia-properties."
    assert run.returncode == 1
