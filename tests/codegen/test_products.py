"""Sums of products in programs: what they are made of, what must wait for what, what shares a vector."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from codegen.derivatives.taylor import prepare
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.program import RATES, Builder
from codegen.loops.products import (
    WIDTH,
    Coefficient,
    Group,
    Sum,
    Term,
    forms,
    inner,
    levels,
    linear_in_time,
    part_groups,
    steps,
    tree,
    whole_group,
    wide,
)
from tests.draws import nonzero

STATES, PARAMETERS = 3, 2
HERE = Point(0.5, [1.25, -0.75, 2.5], [3.0, -0.5])
THERE = Point(1.5, [0.25, 1.75, -1.5], [3.0, -0.5])


@st.composite
def programs(draw):
    """Programs of sums, products and now and then a sine, over states, parameters, time, numbers."""
    b = Builder()
    values = [b.leaf("state", i) for i in range(STATES)] + [b.leaf("time")]
    values += [b.leaf("parameter", i) for i in range(PARAMETERS)] + [b.const(draw(nonzero(-3, 3)))]
    still = values[-PARAMETERS - 1 :]
    for _ in range(draw(st.integers(1, 14))):
        op = draw(st.sampled_from(["add", "sub", "neg", "mul", "mul", "div", "sin"]))
        first = draw(st.sampled_from(values))
        second = draw(st.sampled_from(still if op == "div" else values))
        values.append(b.add(op, *(first, second)[: 1 if op in {"neg", "sin"} else 2]))
    rates = [draw(st.sampled_from(values[STATES:])) for _ in range(STATES)]
    return prepare(b.program({RATES: rates}), RATES)


def values_at(prepared, point):
    b = Builder(prepared.program.rules)
    new = []
    for instruction in prepared.program.instructions:
        new.append(b.again(instruction, new))
    return interpret_exactly(b.program({RATES: new}), point)[RATES]


def of(term, values):
    value = values[term.left] * (1 if term.right is None else values[term.right])
    for still, inverted in term.coefficient.factors:
        value = value / values[still] if inverted else value * values[still]
    return value * term.coefficient.number.numerator / term.coefficient.number.denominator


@given(programs())
def test_a_form_is_the_sum_of_its_terms_up_to_what_stands_still(prepared):
    here, there = values_at(prepared, HERE), values_at(prepared, THERE)
    for n, form in forms(prepared).items():
        change = sum(of(t, there) - of(t, here) for t in form)
        scale = 1 + sum(abs(of(t, p)) for t in form for p in (here, there))
        assert abs(there[n] - here[n] - change) <= 1e-40 * scale


@given(programs())
def test_every_value_comes_after_what_its_coefficient_reads(prepared):
    """Of a sum of products that are the values in its terms, of other operations their arguments."""
    found = forms(prepared)
    whole = [whole_group(some, [found[n] for n in some]) for some in wide(prepared, WIDTH, 2)]
    order = steps(prepared, whole)
    done = set()
    for step in order:
        if isinstance(step, Group):
            packs = [*(p for pair in step.products for p in pair), *step.added]
            assert {n for p in packs for n in p.places if n is not None} <= done
            done.update(step.values)
        else:
            args = prepared.program.instructions[step].args
            assert {a for a in args if prepared.varies[a]} <= done
            done.add(step)
    inside = {
        m for group in whole for n in group.values for m in tree(prepared, inner(prepared), n)
    }
    assert done | inside == {n for n, varies in enumerate(prepared.varies) if varies}


@given(programs())
def test_vectors_hold_values_of_one_level_and_each_once(prepared):
    height, found = levels(prepared), forms(prepared)
    groups = wide(prepared, WIDTH, 2)
    assert all(2 <= len(some) <= WIDTH for some in groups)
    assert all(len({height[n] for n in some}) == 1 for some in groups)
    members = [n for some in groups for n in some]
    assert len(members) == len(set(members))
    assert set(members) <= set(found)


@given(programs())
def test_what_is_part_of_a_sum_is_part_of_no_other(prepared):
    absorbed = inner(prepared)
    trees = [tree(prepared, absorbed, n) for n in forms(prepared)]
    members = [n for some in trees for n in some]
    assert len(members) == len(set(members))


@given(programs())
def test_values_linear_in_time_have_equal_differences(prepared):
    at = [values_at(prepared, Point(t, HERE.x, HERE.p)) for t in (0.0, 1.0, 2.0)]
    for n in linear_in_time(prepared):
        first, second, third = (values[n] for values in at)
        assert abs(third - 2 * second + first) <= 1e-40 * (1 + abs(second))


def test_a_constant_factor_of_a_factor_belongs_to_the_term():
    """w2 (w3 k): read twice, so a value of its own, and yet no step of its own."""
    b = Builder()
    x, y, k = b.leaf("state", 0), b.leaf("state", 1), b.leaf("parameter", 0)
    scaled = b.add("mul", k, y)
    prepared = prepare(
        b.program({RATES: [b.add("mul", x, scaled), b.add("mul", y, scaled)]}), RATES
    )
    first, second = (form for form in forms(prepared).values() if form[0].right is not None)
    assert [t.coefficient.factors for t in (*first, *second)] == [((k, False),)] * 2
    assert wide(prepared, WIDTH, 2) == [tuple(prepared.program.results[RATES])]


def test_sums_share_vectors_in_their_order():
    sums = [Sum(n, n + 1, weighted=bool(n % 2)) for n in range(6)]
    first, second = part_groups(sums)
    assert first.products[0][0].places == (0, 1, 2, 3)
    assert first.products[0][0].weighted == (False, True, False, True)
    assert second.products[0][1].places == (5, 6, None, None)


@pytest.mark.parametrize("number", [Fraction(1), Fraction(-1, 3)])
def test_blank_places_have_the_coefficient_zero(number):
    long = (Term(Coefficient(number), 1, 2), Term(Coefficient(), 3, 4))
    group = whole_group((7, 8), [long, long[1:]])
    assert group.products[1][0].places == (3, None, None, None)
    assert [f and f.number for f in group.products[1][0].factors[:2]] == [1, 0]
