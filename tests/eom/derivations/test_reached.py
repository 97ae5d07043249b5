"""Every line is reached: by rules, from lines before, under no more assumptions than it needs."""

import pytest
import sympy as sp

from eom.checker.mean.solid_models import SPELLINGS
from eom.derivations import derive, names
from eom.derivations.chapters.solids import LETTERS
from eom.derivations.deciding import surplus
from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.derivations.reached import (
    KINDS,
    RESULT,
    asserted,
    is_tautology,
    refuse_asserted,
    same,
    smallest,
)
from eom.derivations.steps import Step
from eom.derivations.verification import DerivationError
from eom.errors import InputError
from eom.terms import rules
from eom.terms.rules.inferences import solved
from eom.terms.terms import Equation, add, cross, der, dot, expr, mul, nodes, number, zero
from eom.terms.vocabulary import mass, omega, position, quantity, velocity
from eom.worlds.worlds import closure
from tests.eom.rows import derivations

ALL = names()
A, B = quantity("vector", "a"), quantity("vector", "b")


@pytest.fixture
def maker():
    return Derivation("trial", "A trial", "Trials")


# -- the shipped derivations -----------------------------------------------------------------


def faults(name):
    """What is wrong with the lines of a derivation: asserted, trivial, repeated, from nowhere."""
    before, statements = set(), set()
    for step in derive(name).steps:
        if step.kind not in KINDS:
            yield step.label, f"kind {step.kind}"
        if step.kind == RESULT and not step.by:
            yield step.label, "asserted"
        if step.kind != RESULT and (step.by or step.follows):
            yield step.label, "stated, and yet derived"
        if is_tautology(step.statement) or step.statement in statements:
            yield step.label, "says nothing"
        if not set(step.follows) <= before:
            yield step.label, "follows from a later line"
        before.add(step.label)
        statements.add(step.statement)


@pytest.mark.parametrize("name", derivations())
def test_no_result_is_asserted_and_no_line_says_nothing(name):
    assert list(faults(name)) == []


@pytest.mark.slow
def test_none_of_all_derivations_asserts_a_result():
    assert {n: found for n in ALL if (found := list(faults(n)))} == {}
    results = [s for n in ALL for s in derive(n).steps if s.kind == RESULT]
    assert len(results) > 500
    assert not [s for n in ALL for s in asserted(derive(n))]


@pytest.mark.parametrize(
    "name",
    [
        "point-mass",
        "spinning-symmetric-body",
        *(pytest.param(n, marks=pytest.mark.slow) for n in ALL),
    ],
)
def test_no_step_names_an_assumption_that_it_does_not_need(name):
    assert list(surplus(derive(name))) == []


def test_every_rule_and_inference_that_is_applied_has_a_name():
    words = {w for n in ALL[:12] for s in derive(n).steps for w in s.by}
    assert "rewriting" not in words
    assert all(words)
    assert len(words) > 30


# -- the mechanism ---------------------------------------------------------------------------


def test_a_rule_must_not_use_what_no_line_states(maker):
    maker.only("one_particle", "newton_2", "constant_mass")
    newton = Equation(quantity("force", "P"), mul(mass("P"), der(velocity("P"))))
    chain = maker.start(cross(position("P"), quantity("force", "P")))
    with pytest.raises(DerivationError, match="no line before states"):
        chain.then("Newton", rules.use(newton))
    law = maker.law(newton, "Newton's second law", label="newton")
    step = chain.then("Newton", rules.use(law.equation), rules.distribute).step
    assert step.follows == ("newton",)
    assert step.by == ("substitution", "linearity")
    assert step.assumptions == ("one_particle", "newton_2")


def test_lines_are_cited_for_other_indices_and_turned_round(maker):
    maker.only("third_law_weak")
    f_ij, f_ji = (quantity("internal_force", *pair) for pair in ("ij", "ji"))
    maker.law(Equation(f_ji, -f_ij), "third law", label="third")
    turned = maker.start(cross(A, quantity("internal_force", "l", "n"))).then(
        "third law", rules.use(Equation(f_ji, -f_ij)), rules.distribute
    )
    assert turned.step.follows == ("third",)
    maker.law(Equation(cross(A, A), zero("vector")), "a law", label="zero")
    back = maker.start(dot(B, cross(A, A))).then("zero", rules.vanish(cross(A, A)))
    assert back.step.follows == ("zero",)


def test_definitions_of_the_vocabulary_need_no_line(maker):
    p = quantity("linear_momentum", "P")
    step = maker.start(cross(A, p)).then("p = m v", rules.unfold("linear_momentum")).step
    assert (step.follows, step.by) == ((), ("definition",))
    maker.define(p, "momentum", label="p")
    cited = maker.start(cross(B, p)).then("p = m v", rules.unfold("linear_momentum")).step
    assert cited.follows == ("p",)


def test_both_sides_of_what_is_shown_have_to_meet(maker):
    step = maker.show(
        Equation(cross(A, cross(A, B)), add(mul(dot(A, B), A), -mul(dot(A, A), B))),
        "double product",
        rules.bac_cab,
    ).step
    assert "double cross product" in step.by
    with pytest.raises(DerivationError, match="do not lead here"):
        maker.show(Equation(der(cross(A, B)), cross(der(A), B)), "lost a term", rules.differentiate)
    assert len(maker.steps) == 1


def test_what_repeats_a_line_or_says_nothing_is_refused(maker):
    once = Equation(cross(A, B), -cross(B, A))
    maker.law(once, "turned", label="once")
    with pytest.raises(DerivationError, match="changes nothing"):
        maker.state(once, "once more")
    with pytest.raises(DerivationError, match="says nothing"):
        maker.law(Equation(A, A), "the same")
    with pytest.raises(DerivationError, match="unknown kind"):
        maker.state(Equation(cross(B, A), -cross(A, B)), "of no kind", "guess")
    assert [s.label for s in maker.steps] == ["once"]


def test_a_shipped_derivation_that_asserts_is_refused(maker):
    maker.state(Equation(cross(A, B), -cross(B, A)), "it is so", label="so")
    made = maker.finish()
    assert [s.label for s in asserted(made)] == ["so"]
    with pytest.raises(DerivationError, match="stated, not derived"):
        refuse_asserted(made)
    stated = Step("so", Equation(cross(A, B), -cross(B, A)), "a law", "law")
    kept = Derived("t", "t", "t", (stated,), {}, {})
    assert refuse_asserted(kept) is kept


def test_the_smallest_set_spares_and_weakens():
    assumed = ("body_frame", "newton_2", "third_law_strong", "O_fixed_in_space")

    def holds(needed):
        def check(names):
            if not set(needed) <= closure(names):
                raise InputError("needed")

        return check

    assert smallest(assumed, holds([])) == ()
    assert smallest(assumed, holds(["newton_2"])) == ("newton_2",)
    assert smallest(assumed, holds(["rigid", "third_law_weak"])) == ("third_law_weak", "rigid")
    assert set(smallest(assumed, holds(assumed))) == set(assumed)


def test_same_is_algebra_and_no_physics():
    assert same(cross(A, B), -cross(B, A))
    assert same(add(mul(number(2), A), -A), A)
    assert same(dot(A, add(A, B)), add(dot(B, A), dot(A, A)))
    assert not same(der(A), der(A, "B"))
    assert not same(cross(A, B), cross(B, A))


def test_a_line_that_is_solved_keeps_what_it_came_from(maker):
    w, v = omega(), quantity("vector", "v")
    first = maker.start(der(v)).then("transport", rules.transport("B"), label="seen")
    step = first.infer("solved", solved(cross(w, v)), label="out").step
    assert step.follows == ("seen",)
    assert step.by[0] == "solving"
    assert step.statement == Equation(cross(w, v), add(der(v), -der(v, "B")))
    with pytest.raises(InputError, match="solving does not apply"):
        first.infer("not in it", solved(expr(number(3).data[0])))


@pytest.mark.parametrize("name", derivations())
def test_every_symbol_is_in_the_list(name):
    d = derive(name)
    parts = [n for s in d.steps for t in (s.statement.left, s.statement.right) for n in nodes(t)]
    used = {s.name for n in parts if n.head == "expr" for s in n.data[0].free_symbols}
    told = {s.name for s in d.scalars} | {s.name for s in d.letters if isinstance(s, sp.Symbol)}
    told |= {q.symbol.name for q in (*d.system.parameters, *d.system.states)} if d.system else set()
    assert used <= told


def test_letters_of_sizes_are_those_of_the_notes():
    assert {n: SPELLINGS[n][0] for n in LETTERS if n in SPELLINGS} == {
        n: letter for n, letter in LETTERS.items() if n in SPELLINGS
    }
