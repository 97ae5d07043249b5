"""Passes that make a system smaller, each against its law on small systems."""

from __future__ import annotations

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.quantities import Definition, Quantity, Singularity
from eom.scenes import reduce
from eom.scenes.reduce import Explanation, Reduction
from eom.system import System
from tests.draws import examples

a, b, c, k, d, e, t = sp.symbols("a b c k d e t", real=True)
SYMBOLS = sp.symbols("s0:6", real=True)


def made(rates, **parts):
    return System.from_rates("made", rates, **parts)


def test_prune_keeps_what_the_request_depends_on():
    system = made({a: b, b: -k * a, c: a * d, e: sp.Integer(1)}, outputs={"sum": a + 1, "far": c})
    small = reduce.prune(system, ["sum"])
    assert small.state_names == ("a", "b")
    assert small.parameter_names == ("k",)
    assert small.output_names == ("sum",)
    assert reduce.prune(system, ["far"]).state_names == ("a", "b", "c")
    assert reduce.prune(system, ["e"]).state_names == ("e",)


def test_prune_keeps_one_whole_part_if_no_state_is_asked_for():
    system = made({a: b, b: -a, c: sp.Integer(1)}, outputs={"number": k})
    small = reduce.prune(system, ["number"])
    assert small.state_names == ("a", "b")
    assert small.parameter_names == ("k",)


@examples(60)
@given(
    edges=st.sets(st.tuples(st.integers(0, 5), st.integers(0, 5)), max_size=12),
    wanted=st.sets(st.integers(0, 5), min_size=1, max_size=3),
)
def test_pruned_states_are_those_reachable_through_the_rates(edges, wanted):
    """The oracle is Warshall's closure of who needs whom."""
    rates = {
        s: sp.Integer(1) + sum(SYMBOLS[j] ** 2 for i, j in edges if i == n)
        for n, s in enumerate(SYMBOLS)
    }
    needs = {(i, j) for i, j in edges} | {(i, i) for i in range(6)}
    for middle in range(6):
        needs |= {(i, j) for i, m in needs if m == middle for n, j in needs if n == middle}
    expected = sorted({j for i, j in needs if i in wanted})
    small = reduce.prune(made(rates), [f"s{w}" for w in wanted])
    assert small.state_names == tuple(f"s{j}" for j in expected)
    assert small.rates == tuple(rates[SYMBOLS[j]] for j in expected)


def with_mass(mass, rates=(b, -a, k)):
    return System(
        name="heavy",
        states=(Quantity(a), Quantity(b), Quantity(c)),
        rates=rates,
        parameters=(Quantity(k),),
        mass_matrix=sp.ImmutableMatrix(mass),
    )


def test_prune_keeps_states_that_share_a_mass_block():
    coupled = with_mass([[1, 0, 1], [0, 1, 0], [1, 0, 2]])
    assert reduce.prune(coupled, ["a"]).state_names == ("a", "b", "c")
    assert reduce.prune(coupled, ["a"]).mass_matrix == coupled.mass_matrix
    apart = with_mass([[2, 0, 0], [0, 1, 0], [0, 0, 1]])
    small = reduce.prune(apart, ["a"])
    assert small.state_names == ("a", "b")
    assert sp.Matrix(small.mass_matrix) == sp.diag(2, 1)
    assert reduce.prune(apart, ["c"]).mass_matrix is None


def test_constant_states_are_those_of_zero_rate_and_no_coupling():
    assert [q.name for q in reduce.constant_states(made({a: b, b: sp.Integer(0)}))] == ["b"]
    assert reduce.constant_states(made({a: sp.Integer(0), b: sp.Integer(0)})) == ()
    coupled = with_mass([[1, 0, 1], [0, 1, 0], [1, 0, 2]], (sp.Integer(0), k, k))
    assert reduce.constant_states(coupled) == ()
    apart = with_mass([[1, 0, 0], [0, 1, 1], [0, 1, 2]], (sp.Integer(0), k, k))
    assert [q.name for q in reduce.constant_states(apart)] == ["a"]


def test_freeze_moves_states_to_the_parameters():
    system = made({a: b * k, b: sp.Integer(0)})
    small = reduce.freeze(system, reduce.constant_states(system))
    assert small.state_names == ("a",)
    assert small.parameter_names == ("k", "b")
    assert small.rates == (b * k,)
    assert [q.name for q in small.parameters if q.held] == ["b"]
    assert [x.name for x in small.assumptions] == ["constant_b"]


def test_substitute_replaces_everywhere():
    system = System(
        name="all",
        states=(Quantity(a),),
        rates=(d * k,),
        parameters=(Quantity(k), Quantity(c)),
        definitions=(Definition(Quantity(d), k + c),),
        outputs=(Definition(Quantity(e), k * a),),
        singularities=(Singularity(a - k, a),),
    )
    small = reduce.substitute(system, {k: c})
    assert small.parameter_names == ("c",)
    assert small.rates == (d * c,)
    assert small.definitions[0].expression == 2 * c
    assert small.outputs[0].expression == c * a
    assert small.singularities[0].expression == a - c


def test_fold_inlines_trivial_definitions_alone():
    f, g = sp.symbols("f g", real=True)
    system = System(
        name="fold",
        states=(Quantity(a),),
        rates=(d + f * g,),
        parameters=(Quantity(k),),
        definitions=(
            Definition(Quantity(d), sp.Integer(0)),
            Definition(Quantity(f), -2 * a),
            Definition(Quantity(g), sp.sin(a) + d),
        ),
    )
    small = reduce.fold_definitions(system)
    assert [x.name for x in small.definitions] == ["g"]
    assert small.rates == (-2 * a * g,)
    assert small.expand(small.rates[0]) == system.expand(system.rates[0])
    assert reduce.cost(small) < reduce.cost(system)


def test_invariants_are_found_among_the_candidates():
    system = made({a: b, b: -k * a})
    names = {n: Quantity(sp.Symbol(n)) for n in ("energy", "wrong", "foreign", "number")}
    candidates = [
        Definition(names["energy"], b**2 + k * a**2),
        Definition(names["wrong"], b**2 - k * a**2),
        Definition(names["foreign"], b**2 + k * a**2 + c),
        Definition(names["number"], k),
    ]
    assert reduce.find_invariants(system, candidates).invariant_names == ("energy",)


def test_cost_counts_used_definitions_and_the_mass_matrix():
    system = System(
        name="cost",
        states=(Quantity(a),),
        rates=(d * k,),
        parameters=(Quantity(k),),
        definitions=(Definition(Quantity(d), k + a), Definition(Quantity(e), sp.sin(a) ** 9)),
        mass_matrix=sp.ImmutableMatrix([[k + 2]]),
    )
    assert reduce.cost(system) == 3


def test_explanation_prints_a_line_a_reduction_and_the_totals():
    text = str(Explanation((Reduction("phi", "not needed", 3),), 10, 7))
    assert text.splitlines()[0] == "- phi: not needed (3 operations saved)"
    assert "10 operations" in text.splitlines()[1]
    assert "7" in text.splitlines()[1]


@pytest.mark.parametrize("requested", [["a"], ["b"], ["a", "b"]])
def test_prune_twice_is_prune_once(requested):
    system = made({a: b, b: -k * a, c: a})
    once = reduce.prune(system, requested)
    assert reduce.prune(once, requested) == once
