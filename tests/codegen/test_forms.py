from fractions import Fraction
from math import prod

import mpmath
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from codegen.derivatives.forms import COEFFICIENT_BITS, ONE, Forms, Products, content
from codegen.ir.fold import bits
from codegen.ir.interpret import Point, interpret, interpret_exactly
from codegen.ir.polynomials import added
from codegen.ir.program import Builder

COEFFICIENTS = st.fractions(-4, 4, max_denominator=4).map(lambda f: f or Fraction(1))
SLOTS = 4
MONOMIALS = st.lists(st.integers(0, SLOTS - 1), max_size=4).map(lambda k: tuple(sorted(k)))
FORMS = st.dictionaries(MONOMIALS, COEFFICIENTS, min_size=1, max_size=5)
M = mpmath.mp.clone()
M.dps = 60
AT = (3.0, -5.0, 7.0, 0.5)


def forms_over_slots():
    """Two parameters, two states, in the numbers of the slots."""
    b = Builder()
    for slot in range(SLOTS):
        b.leaf("parameter" if slot < 2 else "state", slot % 2)
    return Forms(b)


def value(form):
    return sum(c * prod(Fraction(AT[k]) for k in m) for m, c in form.items())


def exact(fraction):
    return M.mpf(fraction.numerator) / fraction.denominator


def evaluated(forms, wanted):
    program = forms.b.program({"all": forms.numbers(wanted)})
    return interpret_exactly(program, Point(p=AT[:2], x=AT[2:]))["all"], program


@given(st.lists(FORMS, min_size=1, max_size=4))
def test_numbers_have_the_values_of_their_forms(wanted):
    got, _ = evaluated(forms_over_slots(), wanted)
    assert all(abs(g - value(f)) < 1e-40 for g, f in zip(got, wanted, strict=True))


@given(FORMS, FORMS, FORMS)
def test_products_of_sums_of_products(f, g, h):
    forms = forms_over_slots()
    both = added(dict(forms.product(f, g)), h)
    (got,), _ = evaluated(forms, [both])
    assert abs(got - (value(f) * value(g) + value(h))) < 1e-40


@given(FORMS)
def test_content_is_what_all_terms_share(form):
    scale, shared, rest = content(form)
    assert value({m: scale * c for m, c in rest.items()}) * prod(
        Fraction(AT[k]) for k in shared
    ) == value(form)
    assert abs(scale) == 1 or 1 in map(abs, rest.values())
    assert next(c for m, c in sorted(rest.items())) > 0
    assert not set.intersection(*(set(m) for m in rest))


LARGE = st.fractions(-(10**9), 10**9).map(lambda f: f or Fraction(1))


@given(st.lists(st.tuples(MONOMIALS, LARGE), min_size=2, max_size=12))
def test_coefficients_of_products_stay_small_and_nothing_is_rounded(factors):
    """Products of sums with coefficients of many digits, one after the other."""
    forms = forms_over_slots()
    total, expected = ONE, Fraction(1)
    for monomial, coefficient in factors:
        step = {(0, 3): coefficient} | {monomial: coefficient / 7}
        total, expected = forms.product(total, step), expected * value(step)
        assert all(bits(c) <= COEFFICIENT_BITS for c in total.values()) or len(total) > 1
    (got,), _ = evaluated(forms, [total])
    assert abs(got - exact(expected)) <= abs(exact(expected)) * M.mpf(10) ** -45


@given(FORMS, st.fractions(1, 9, max_denominator=3), MONOMIALS)
@example({(0, 1): Fraction(-1), (1,): Fraction(1)}, Fraction(1), ())
def test_content_of_a_multiple_differs_in_the_scale_and_the_factors_alone(form, factor, extra):
    scale, shared, rest = content(form)
    other = content({tuple(sorted((*m, *extra))): -factor * c for m, c in form.items()})
    carried = all(bits(c) <= COEFFICIENT_BITS for c in (other[0], *other[2].values()))
    shared = tuple(sorted((*shared, *extra)))
    assert other[1] == shared
    if carried and abs(scale) != 1:
        assert other == (-factor * scale, shared, rest)


@given(FORMS)
def test_what_is_added_and_taken_away_vanishes(form):
    assert added(dict(form), {m: -c for m, c in form.items()}) == {}


def test_gates_keep_what_is_not_finite_apart():
    """(x > 0) / x + (x <= 0) x, at x = 0."""
    b = Builder()
    x, zero = b.leaf("state", 0), b.const(0)
    positive = b.add("lt", zero, x)
    inverse = b.add("div", b.const(1), x)
    forms = Forms(b)
    gated = forms.product(forms.of(positive), forms.of(inverse))
    other = forms.product(forms.of(b.add("not", positive)), forms.of(x))
    program = b.program({"all": forms.numbers([added(dict(gated), other)])})
    assert interpret(program, Point(x=(0.0,)))["all"] == [0.0]
    assert interpret(program, Point(x=(4.0,)))["all"] == [0.25]
    assert interpret(program, Point(x=(-4.0,)))["all"] == [-4.0]
    assert program.counts()["select"] == 1


@pytest.mark.parametrize(
    ("wanted", "products"),
    [
        ([{(0, 2, 3): 1}, {(0, 2): 1}], 2),  # a x, then a x y
        ([{(0, 2): 1, (1, 2): 1}], 1),  # (a + b) x
        ([{(2, 3): 2}, {(2, 3): -2}], 2),  # 2 x y once
        ([{(2,): 1, (3,): -1}], 0),
    ],
)
def test_what_is_shared_is_multiplied_once(wanted, products):
    fractions = [{m: Fraction(c) for m, c in form.items()} for form in wanted]
    _, program = evaluated(forms_over_slots(), fractions)
    assert program.counts().get("mul", 0) == products


@given(st.lists(st.lists(st.integers(0, 5), min_size=1, max_size=5), min_size=1, max_size=8))
def test_extraction_keeps_every_product(factors):
    products = Products(lambda _x, _y: False)
    wanted = [tuple(sorted(f)) for f in factors]
    for f in wanted:
        products.use(f)
    products.share()

    def expanded(k):
        if k not in products.pairs:
            return [k]
        return [e for inner in products.pairs[k] for e in expanded(inner)]

    for f in wanted:
        assert sorted(e for k in products.left(f) for e in expanded(k)) == list(f)
    made = sum(len(f) - 1 for f in products.pairs.values())
    left = sum(len(products.left(f)) - 1 for f in set(wanted))
    assert made + left <= sum(len(f) - 1 for f in set(wanted))
