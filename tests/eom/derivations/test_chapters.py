"""Chapters with frames, bodies or laws of their own: true by other means, as published, mutants found."""

import random

import pytest
import sympy as sp

from eom.derivations import derive, names
from eom.derivations.derivation import SIGNS, Derivation
from eom.derivations.verification import DerivationError, plain
from eom.exercises.lessons import topics
from eom.terms.rules.inferences import signs
from eom.terms.terms import Equation, expr
from tests.eom import oracle
from tests.eom.chapters import MOTIONS, is_conditional, is_true, judge
from tests.eom.mutants import judged_steps, mutants
from tests.eom.rows import long_too, only

HEAVY = ("law", "torque-", "euler-")
"""Lines with three accelerations by angles: they take SymPy's vectors half a minute each."""
LONG = "gravity-gradient-stability"
"""A chapter whose lines the other means take minutes for."""
KNOWN = (*MOTIONS, "virtual-work")
"""Chapters whose lines are known by other means: published motions, or places by coordinates."""
MOST = 12
"""Edits of a chapter whose truth is asked elsewhere."""


@pytest.mark.parametrize("name", long_too(only(KNOWN, "collisions"), LONG))
def test_every_equation_is_true_by_other_means(name):
    d, known = derive(name), 0
    lines = [s for s in judged_steps(d) if not is_conditional(s)]
    for step in lines:
        try:
            assert is_true(d, step.statement, step.assumptions), step.label
            known += 1
        except oracle.Undefined:
            continue
    assert known > 0.95 * len(lines)


@pytest.mark.parametrize("name", long_too(only(KNOWN, "collisions"), LONG))
def test_edits_that_are_false_are_rejected_and_true_ones_are_not(name):
    d, draw = derive(name), random.Random(name)
    lines = [
        s for s in judged_steps(d) if s.statement.relation != ">=" and not s.label.startswith(HEAVY)
    ]
    edits = [
        (s, m.equation) for s in lines for m in mutants(s.statement, s.assumptions) if m.equation
    ]
    wrong, refused = [], 0
    for step, edit in draw.sample(edits, MOST):
        verdict = judge(d, edit, step.assumptions)
        refused += verdict == "rejected"
        try:
            truth = is_true(d, edit, step.assumptions)
        except oracle.Undefined:
            continue
        if (verdict, truth) in {("accepted", False), ("rejected", True)}:
            wrong.append((step.label, verdict, plain(edit.left), plain(edit.right)))
    assert wrong == []
    assert refused > MOST / 2


# -- signs ----------------------------------------------------------------------------------------

SIGNED = (
    "collisions", "energy-dissipation", "gravity-gradient-stability", "gyrostat", "heavy-symmetric-top",
    "torque-free-motion",
)  # fmt: skip
"""Chapters with signs that follow from conditions: lines that are judged here alone."""


def conditions(d, step):
    """The conditions that a line rests on, from line to line."""
    waiting, found = [step.label], []
    while waiting:
        line = d[waiting.pop()]
        found += [line.statement.left.expression] if line.evidence == "supposed" else []
        waiting += [label for label in line.follows if label not in waiting]
    return found


def other_side(d, step):
    """What a sign is of; where an equation that it follows from has that as a side, the other side."""
    left = step.statement.left
    for line in (d[label].statement for label in step.follows):
        if line.relation == "=" and left in (line.left, line.right):
            other = (line.right if left == line.left else line.left).expression
            return left.expression if other.has(sp.Determinant) else other
    return left.expression


def spelt(d, e):
    known = {s: m.expression for s, m in d.scalars.items() if m.head == "expr"}
    while e.free_symbols & known.keys():
        e = e.xreplace(known)
    return e


@pytest.mark.parametrize("name", SIGNED)
def test_signs_hold_at_all_numbers_that_meet_their_conditions(name):
    d, draw = derive(name), random.Random(name)
    lines = [s for s in d.steps if s.evidence == SIGNS]
    assert lines
    for step in lines:
        value = spelt(d, other_side(d, step))
        needed = [spelt(d, e) for e in conditions(d, step)]
        letters = sorted(
            set().union(value.free_symbols, *(e.free_symbols for e in needed)), key=str
        )
        functions = [sp.lambdify(letters, e) for e in (value, *needed)]
        met = 0
        for _ in range(4000):
            point = [draw.uniform(-2, 3) for _ in letters]
            first, *others = (f(*point) for f in functions)
            if min(others, default=0) >= 0:
                assert first > -1e-9, step.label
                met += 1
            if met > 20:
                break
        assert met > 3, step.label


@pytest.mark.slow
def test_signs_of_every_chapter_are_judged_here():
    """`verified` alone leaves these out: what a condition says is true where it is met."""
    assert {n for n in names() if any(map(is_conditional, derive(n).steps))} == set(SIGNED)


def test_a_sign_needs_its_conditions_and_a_condition_has_to_be_possible():
    d = Derivation("signs", "Signs", "Trials")
    a, b = d.constants(a="one", b="another")
    first = d.suppose(Equation(a, 0, ">="), "let it be so", label="a")
    made = first.infer("by a square", signs(expr(a * b**2), (expr(a), expr(b**2))), label="ab2")
    assert made.step.follows == ("a",)
    with pytest.raises(DerivationError, match="sign cannot be decided"):
        first.infer("b is unknown", signs(expr(a * b), (expr(a), expr(b))))
    with pytest.raises(DerivationError, match="false"):
        first.infer("another sum", signs(expr(a + b), (expr(a),)))
    with pytest.raises(DerivationError, match="no world meets"):
        d.suppose(Equation(-(b**2) - 1, 0, ">="), "never")
    with pytest.raises(DerivationError, match="no condition"):
        d.suppose(Equation(a, b), "no sign")
    assert [s.label for s in d.steps if s.evidence] == [s.label for s in d.steps]


# -- as published ---------------------------------------------------------------------------------

RESULTS = {
    ("heavy-symmetric-top", "sleeping-stable"): "a**2/beta - 2",  # Goldstein 5.79
    ("heavy-symmetric-top", "quadratic"): "I_1*Omega**2*cos(theta_0) - I_3*Omega*omega_3 + g*l*m",
    ("heavy-symmetric-top", "cubic"): "u_dot**2",  # 5.62
    ("gravity-gradient-stability", "small-1"): (  # Hughes 9.2
        "I_1*alpha_1_ddot + 4*alpha_1*n**2*(I_2 - I_3) - alpha_3_dot*n*(I_1 - I_2 + I_3)"
    ),
    ("gravity-gradient-stability", "small-2"): "I_2*alpha_2_ddot + 3*alpha_2*n**2*(I_1 - I_3)",
    ("gravity-gradient-stability", "small-3"): (
        "I_3*alpha_3_ddot + alpha_1_dot*n*(I_1 - I_2 + I_3) + alpha_3*n**2*(I_2 - I_1)"
    ),
}
"""Left sides of results as books have them, which then say = 0, >= 0 or a cubic."""


@pytest.mark.parametrize("where", RESULTS)
def test_results_are_those_of_the_books(where):
    name, label = where
    left = derive(name)[label].statement.left.expression
    letters = {s.name: s for s in left.free_symbols}
    assert sp.expand(left - sp.sympify(RESULTS[where], locals=letters)) == 0


def test_a_satellite_is_stable_in_the_regions_of_debra_and_delp():
    """DeBra and Delp (1961): Lagrange's region, and a piece where both ratios are negative."""
    d = derive("gravity-gradient-stability")
    polynomial = d["roll-yaw"].statement.right.expression
    letters = {s.name: s for s in polynomial.free_symbols}
    by = sp.lambdify([letters[n] for n in ("k_1", "k_3")], [
        sp.Poly(polynomial.subs(letters["n"], 1), letters["lambda"]).all_coeffs()[k] for k in (2, 4)
    ])  # fmt: skip
    for (k1, k3), stable in {
        (0.6, 0.3): True, (0.9, 0.8): True, (-0.05, -0.9): True,
        (0.5, -0.5): False, (-0.9, -0.5): False, (-0.5, 0.5): False,
    }.items():  # fmt: skip
        b, c = by(k1, k3)
        assert (b > 0 and c > 0 and b * b > 4 * c) == stable, (k1, k3)


def test_a_rod_is_struck_at_two_thirds_and_a_rocket_burns_as_the_exponential():
    """Greenwood 8.2: the centre of percussion; Goldstein: nearly all of the mass is fuel."""
    reaction = derive("collisions")["percussion"].statement.right.expression
    letters = {s.name: s for s in reaction.free_symbols}
    assert reaction.subs(letters["h"], 2 * letters["l"] / 3) == 0
    left = derive("rocket-equation")["mass-left"].statement.right.expression
    at = {s: {"m_0": 1, "v": 2, "v_0": 0, "c": 1}[s.name] for s in left.free_symbols}
    assert round(float(1 - left.subs(at)), 2) == 0.86


def test_exercises_are_made_on_every_chapter():
    assert {n for made in topics().values() for n in made} == set(names())
