"""Values of expressions in rings: against SymPy with exact numbers, and the same in all rings."""

from __future__ import annotations

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from eom.checker.code.comparison import MP, Numbers
from eom.errors import InputError
from eom.exact.rings import ARITHMETIC, FLOATS, TRIGONOMETRY, Evaluation, summands
from eom.fields import PRIME, RATIONALS, RESIDUES, Field, Singular, sum_of_angles

x, y, z = sp.symbols("x y z", real=True)
TANGENT = {x: Fraction(2, 7), y: Fraction(-5, 3), z: Fraction(9, 4)}
"""Of half of each symbol, where it is an angle; its value, where it is none."""


class Point(Evaluation):
    """The symbols at one point, in any field."""

    rows = ARITHMETIC | FLOATS | TRIGONOMETRY

    def __init__(self, field):
        self.ring, self.memo = field, {}

    def symbol(self, symbol):
        return self.ring.of(TANGENT[symbol])

    def turns(self, angle):
        for base, count in summands(angle):
            yield *self.ring.circle(self.symbol(base)), int(count)

    def other(self, node):
        raise InputError("no value", got=node)


counts = st.integers(-4, 4).filter(bool)
angles = st.tuples(counts, counts).map(lambda n: n[0] * x + n[1] * y)
waves = st.tuples(st.sampled_from([sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc]), angles).map(
    lambda f: f[0](f[1])
)
leaves = st.one_of(
    waves, st.sampled_from([x, y, z, sp.Float(0.375)]), st.fractions(-5, 5, max_denominator=9)
).map(sp.sympify)
expressions = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(lambda p: p[0] + p[1]),
        st.tuples(inner, inner).map(lambda p: p[0] * p[1]),
        st.tuples(inner, st.sampled_from([-2, -1, 2, 3])).map(lambda p: p[0] ** p[1]),
    ),
    max_leaves=6,
)


def by_sympy(expression):
    """The value to many digits: angles below functions are 2 atan(t), symbols elsewhere are t."""
    below = {s: 2 * sp.atan(sp.Rational(t)) for s, t in TANGENT.items()}
    functions = {f: f.xreplace(below) for f in expression.atoms(sp.Function)}
    plain = {s: sp.Rational(t) for s, t in TANGENT.items()}
    return expression.xreplace(functions).xreplace(plain).evalf(60)


@settings(deadline=None, max_examples=60)
@given(expressions)
def test_values_are_those_of_sympy_in_all_rings(expression):
    assume(not expression.has(sp.zoo, sp.nan))
    try:
        exact = Point(RATIONALS).value(expression)
    except Singular:
        assert abs(by_sympy(expression)) > 1e40 or by_sympy(expression) is sp.nan
        return
    wanted = by_sympy(expression)
    assert abs(wanted - sp.Rational(exact)) <= abs(wanted) * sp.Rational(1, 10**40) + 1e-40
    assert Point(RESIDUES).value(expression) == RESIDUES.of(exact)


@given(st.lists(st.tuples(st.fractions(-3, 3, max_denominator=9), st.integers(-5, 5)), max_size=3))
def test_cosine_and_sine_of_a_sum_are_parts_of_a_product_of_complex_numbers(parts):
    cosine, sine = sum_of_angles([(*RATIONALS.circle(t), n) for t, n in parts])
    wanted = sp.expand(sp.prod((1 + sp.I * sp.Rational(t)) ** (2 * n) for t, n in parts))
    wanted /= sp.prod((1 + sp.Rational(t) ** 2) ** n for t, n in parts)
    assert sp.simplify(wanted - sp.Rational(cosine) - sp.I * sp.Rational(sine)) == 0


def test_expressions_may_be_deeper_than_python_nests_calls():
    deep = x
    for _ in range(5000):
        deep = sp.Add(y, sp.Pow(deep, -1, evaluate=False), evaluate=False)
    a, b = (RESIDUES.of(TANGENT[s]) for s in (x, y))
    for _ in range(5000):
        a = (b + RESIDUES.inverse(a)) % PRIME
    assert Point(RESIDUES).value(deep) == a


def test_what_has_no_row_is_refused_and_zero_has_no_reciprocal():
    for strange in (sp.exp(x), sp.sqrt(y), sp.pi):
        with pytest.raises(InputError):
            Point(RATIONALS).value(1 + strange)
    with pytest.raises(Singular):
        Point(Field(7)).value(1 / (x - sp.Rational(2, 7) - 7 + 7 * y))


@pytest.mark.parametrize("text", ["pi", "exp", "root", "float"])
def test_many_digits(text):
    expression = {"pi": sp.pi**2 / 3, "exp": sp.exp(x) + sp.atan2(x, y), "root": sp.sqrt(x) ** 3,
                  "float": x / 3 - sp.Float(0.1)}[text]  # fmt: skip
    at = {x: MP.mpf(2), y: MP.mpf(3)}
    exact = {f: sp.Rational(f) for f in expression.atoms(sp.Float)}
    wanted = expression.xreplace(exact).subs({x: 2, y: 3}).evalf(30)
    assert abs(Numbers(at).value(expression) - MP.mpf(str(wanted))) < MP.mpf(10) ** -28
