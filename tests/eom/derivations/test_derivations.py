"""Every derivation of the registry: made, verified again in other worlds, quick, and of use."""

import subprocess
import sys
from itertools import islice

import pytest
import sympy as sp

from eom.derivations import derive, names, titles
from eom.derivations.derivation import Derivation
from eom.derivations.verification import DerivationError, verify, written
from eom.errors import InputError
from eom.exact.numbers import SIGNED
from eom.fields import RATIONALS, RESIDUES, Singular
from eom.mass.solids import SOLIDS
from eom.system import System
from eom.terms.rules import transport
from eom.terms.terms import Equation, der
from eom.terms.vocabulary import quantity
from eom.worlds.evaluate import Evaluator, is_signed
from eom.worlds.generators import world
from eom.worlds.own import furnished
from eom.worlds.worlds import closure
from tests.clock import growth_in_calls
from tests.eom.carried import carried
from tests.eom.rows import derivations, every, only

ALL = names()


def test_registry_and_titles_agree():
    listed = [n for group in titles().values() for n in group]
    assert sorted(listed) == sorted(ALL)
    assert len(set(ALL)) == len(ALL)
    assert {n.removeprefix("inertia-of-").replace("-", " ") for n in ALL} >= set(SOLIDS)


@pytest.mark.parametrize("name", derivations())
def test_each_is_made_with_every_step_verified(name):
    d = derive(name)
    titled = {n: (group, title) for group, made in titles().items() for n, title in made.items()}
    assert (d.group, d.title) == titled[name]
    assert len(d.steps) > 3
    assert all(s.evidence for s in d.steps)
    assert all(s.kind == "definition" or s.evidence != "definition" for s in d.steps)
    assert len({s.label for s in d.steps}) == len(d.steps)
    assert all(s.reason for s in d.steps)


@pytest.mark.parametrize("name", derivations())
def test_each_step_holds_in_worlds_of_other_seeds(name):
    d = derive(name)
    scalars = {s: carried(d, Equation(t, t)).left for s, t in d.scalars.items()}
    for step in d.steps:
        if step.evidence.startswith("held"):
            assumed, line = closure(step.assumptions), carried(d, step.statement)
            held = drawn(d, assumed, scalars, line)
            assert [Evaluator(w, scalars).holds(line) for w in islice(held, 2)] == [True] * 2, step


def drawn(d, assumed, scalars, line):
    """Worlds of other seeds in which a line has a value, with what the derivation has of its own."""
    signed = any(
        is_signed(e, scalars) for t in (line.left, line.right) for e in written(t, scalars)
    )
    for seed in range(1000, 1030):
        try:
            plain = world(assumed, seed, SIGNED if signed else RESIDUES)
            furnished_one = furnished(plain, d.own, scalars) if d.own else plain
            Evaluator(furnished_one, scalars).holds(line)
        except Singular:
            continue
        yield furnished_one


@pytest.mark.parametrize(
    "name",
    only(["particle-system", "euler-equations", "spinning-symmetric-body"], "euler-equations"),
)
def test_steps_hold_in_exact_rationals_too(name):
    d = derive(name)
    checked = 0
    for step in d.steps[:: max(1, len(d.steps) // 6)]:
        if step.evidence.startswith("held"):
            exact = world(closure(step.assumptions), 7, RATIONALS)
            assert Evaluator(exact, d.scalars).holds(step.statement), step.label
            checked += 1
    assert checked > 2


NEEDED = [
    ("point-mass", "force-is-momentum-rate", "constant_mass"),
    ("point-mass", "H-is-h", "O_fixed_in_space"),
    ("particle-system", "internal-forces", "third_law_weak"),
    ("particle-system", "torque-law", "third_law_strong"),
    ("particle-system", "torque-law", "newton_2"),
    ("particle-system", "H-is-h", "about_centre"),
    ("rigid-body-momentum", "h-tilde", "body_frame"),
    ("rigid-body-momentum", "h-J", "O_fixed_in_body"),
    ("rigid-body-momentum", "torque-law-centre", "about_centre"),
    ("euler-equations", "euler-dyadic", "body_frame"),
    ("euler-equations", "euler-1", "principal_axes"),
    ("euler-equations", "euler-pivot", "O_fixed_in_space"),
    ("euler-equations", "euler-pivot", "O_fixed_in_body"),
    ("kinetic-energy", "T-pivot", "O_fixed_in_space"),
    ("kinetic-energy", "power", "third_law_strong"),
    ("torque-free-motion", "precession", "symmetric"),
    ("torque-free-motion", "invariable-plane", "torque_free"),
    ("spinning-symmetric-body", "first-integral", "no_torque_2"),
    ("spinning-symmetric-body", "psi-equation", "no_torque_3"),
]


@pytest.mark.parametrize(("name", "label", "assumption"), every(6, NEEDED))
def test_without_its_assumption_the_step_is_false(name, label, assumption):
    d = derive(name)
    step = d[label]
    assert assumption in closure(step.assumptions)
    rest = {a for a in closure(step.assumptions) if assumption not in closure([a])}
    with pytest.raises(DerivationError, match="false"):
        verify(step.statement, rest, d.scalars)


@pytest.mark.parametrize(
    "made",
    [("point-mass", "inertia-of-rod"), pytest.param(ALL, marks=pytest.mark.slow)],
    ids=["some", "all"],
)
def test_work_of_each_and_of_all(made):
    """From cold. Lines and their smallest sets of assumptions are the work: the sum grows with them."""
    code = (
        "from eom.derivations import derive\n"
        "from tests.clock import calls\n"
        f"for n in {made}:\n print(n, calls(derive, n))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    each = [int(line.split()[1]) for line in run.stdout.splitlines()]
    assert min(each) > 1000
    assert max(each) < 10_000_000
    assert sum(each) < 70_000_000


def test_titles_need_no_sympy():
    code = "import eom.derivations as d, sys; d.titles(); print('sympy' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"


def test_unknown_names_are_refused_with_a_near_match():
    with pytest.raises(InputError, match="euler-equations"):
        derive("euler-equation")


@pytest.mark.parametrize(
    "name", ["euler-equations", "torque-free-motion", "spinning-symmetric-body", "gyrostat"]
)
def test_results_are_systems(name):
    assert isinstance(derive(name).system, System)


def test_results_of_the_spinner_are_those_of_the_lecture():
    """Lecture 001, the boxed column and both equations of motion, with I2 dOmega/dt restored."""
    d = derive("spinning-symmetric-body")
    theta, th, ps, thdd, psdd, Om, Omd = sp.symbols(
        "theta theta_dot psi_dot theta_ddot psi_ddot Omega Omega_dot", real=True
    )
    I1, I2 = sp.symbols("I1 I2", positive=True)
    s, c = sp.sin(theta), sp.cos(theta)
    expected = sp.Matrix(
        [
            I1 * ps**2 * s * c + I1 * thdd - I2 * ps * (Om + ps * s) * c,
            I2 * (psdd * s + ps * th * c) + I2 * Omd,
            I1 * psdd * c - 2 * I1 * ps * th * s + I2 * th * (Om + ps * s),
        ]
    )
    assert (d.result["rate"] - expected).applyfunc(sp.expand).is_zero_matrix


def test_a_step_knows_what_it_rests_on():
    d = derive("euler-equations")
    assert d["euler-1"].states == ("000:E25", "001:E3", "002:E37")
    assert "principal_axes" in d["euler-1"].assumptions
    assert "principal_axes" not in d["euler-dyadic"].assumptions
    with pytest.raises(KeyError):
        d["nobody"]


def test_making_is_linear_in_the_steps():
    assert growth_in_calls(2.2, many_steps, 100, 200)


def many_steps(count):
    d = Derivation("many", "many", "tests")
    for k in range(count):
        d.start(der(quantity("vector", f"v{k}"))).then("transport", transport("B"))
    assert len(d.finish().steps) == count
