"""Tables: against SciPy's interpolants, SymPy's own calculus, and what is refused."""

import math
import pickle
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline, PchipInterpolator

import eom
from eom.errors import InputError
from eom.tables import TableFunction
from eom.typeset import printing

x, y = sp.symbols("x y", real=True)
KINDS = ("linear", "cubic", "pchip")


@st.composite
def data(draw, least=2):
    """Breakpoints that increase and values, with ties and plateaus among them."""
    steps = draw(
        st.lists(st.sampled_from([0.1, 0.5, 1.0, 3.0, 1e-3]), min_size=least - 1, max_size=9)
    )
    values = draw(st.lists(st.sampled_from([-2.0, -0.3, 0.0, 0.7, 1.5, 4.0]),
                           min_size=len(steps) + 1, max_size=len(steps) + 1))  # fmt: skip
    return [float(v) for v in np.cumsum([-1.0, *steps])], values


def oracle(kind, breakpoints, values):
    if kind == "linear":
        return lambda q, order: (
            np.interp(q, breakpoints, values)
            if order == 0
            else np.diff(values)[(k := np.searchsorted(breakpoints, q, "right") - 1)]
            / np.diff(breakpoints)[k]
        )
    return (CubicSpline if kind == "cubic" else PchipInterpolator)(breakpoints, values)


@pytest.mark.parametrize("kind", KINDS)
@given(data(), st.data())
def test_values_and_derivatives_are_those_of_scipy(kind, given_data, draw):
    breakpoints, values = given_data
    table, expected = eom.Table("curve", *given_data, kind), oracle(kind, breakpoints, values)
    share = draw.draw(st.floats(0, 0.999))
    k = draw.draw(st.integers(0, len(breakpoints) - 2))
    at = breakpoints[k] + share * (breakpoints[k + 1] - breakpoints[k])
    size = max(map(abs, values)) + 1
    narrow = min(np.diff(breakpoints))
    for order in range(2 if kind == "linear" else 3):
        got = float(table.at(Fraction(at)))
        assert got == pytest.approx(expected(at, order), abs=1e-9 * size / narrow**order)
        table = table.derivative


@given(data(), st.sampled_from(KINDS), st.sampled_from(["hold", "linear"]))
def test_curves_go_through_their_points_and_join_smoothly(given_data, kind, outside):
    table = eom.Table("curve", *given_data, kind, outside)
    for b, v in zip(*given_data, strict=True):
        assert table.at(Fraction(b)) == Fraction(v)
    for order in range(1 if kind == "linear" else 2):
        for k, b in enumerate(table.breakpoints[1:-1], 2):
            left, right = table.exact_rows[k - 1], table.exact_rows[k]
            h = Fraction(b) - Fraction(table.breakpoints[k - 2])
            assert sum(c * h**n for n, c in enumerate(left)) == right[0], order
        table = table.derivative


@given(data(3))
def test_pchip_does_not_overshoot(given_data):
    breakpoints, values = given_data
    table = eom.Table("curve", *given_data, "pchip")
    for k in range(len(breakpoints) - 1):
        low, high = sorted(values[k : k + 2])
        for at in np.linspace(breakpoints[k], breakpoints[k + 1], 9):
            assert low - 1e-13 <= float(table.at(Fraction(float(at)))) <= high + 1e-13


@pytest.mark.parametrize("kind", KINDS)
def test_what_holds_outside(kind):
    hold = eom.Table("curve", [0, 1, 3], [1, 2, -1], kind)
    line = eom.Table("curve", [0, 1, 3], [1, 2, -1], kind, "linear")
    for at, end in ((-5, 0), (9, 3)):
        assert hold.at(Fraction(at)) == hold.at(Fraction(end))
        assert hold.derivative.at(Fraction(at)) == 0
        slope = line.derivative.at(Fraction(at))
        assert slope != 0
        assert line.at(Fraction(at)) == line.at(Fraction(end)) + slope * (at - end)
    assert hold.flat_outside
    assert not line.flat_outside


def test_sympy_differentiates_substitutes_and_evaluates():
    table = eom.Table("lift", [0, 1, 2, 4], [0, 1, 0, 3], "cubic")
    e = y * table(x * y) ** 2
    assert e.free_symbols == {x, y}
    assert e.diff(x) == 2 * y**2 * table(x * y) * table.derivative(x * y)
    assert table(x).diff(x, 4) == 0
    assert table(x).diff(y) == 0
    at = e.diff(x).subs({x: sp.Rational(1, 3), y: sp.Rational(3, 2)})
    h = sp.Rational(1, 10**15)
    difference = (e.subs({x: sp.Rational(1, 3) + h, y: sp.Rational(3, 2)})
                  - e.subs({x: sp.Rational(1, 3) - h, y: sp.Rational(3, 2)})) / (2 * h)  # fmt: skip
    assert sp.N(at, 30) == pytest.approx(sp.N(difference, 60), rel=1e-25)
    assert sp.N(table(sp.Rational(1, 2)), 40).is_Float
    assert table(x).is_real
    assert table(x).subs(x, y) == table(y)


def test_tables_are_values():
    one, same = (eom.Table("a", list(b), (0, 1)) for b in ([0, 1], np.array([0.0, 1.0])))
    other = eom.Table("a", [0, 1], [0, 2])
    assert one == same
    assert hash(one) == hash(same)
    assert one(x) == same(x) != other(x)
    assert pickle.loads(pickle.dumps(one(x) * y)) == one(x) * y
    assert isinstance(one(x), TableFunction)
    assert str(one(x) * one.derivative(x) * other(x)) == str(other(x) * one.derivative(x) * one(x))


def test_a_system_with_a_table_is_printed():
    drag = eom.Table("drag_1", [0, 1], [0, 1])
    system = eom.System.from_rates("falls", {x: -(drag(x) ** 2) * y + drag(x).diff(x)})
    assert "x' = drag_1'(x) - y*drag_1(x)**2" in printing.text(system)
    assert r"\operatorname{drag\_1}{\left(x \right)} \right)^{2}" in printing.latex(system)
    assert r"\operatorname{drag\_1}'" in printing.latex(system)
    assert all("drag" in printing.show(system, style) for style in printing.FORMATS)


REFUSED = {
    "one point": (([0], [1]), {}, "two breakpoints"),
    "no point": (([], []), {}, "two breakpoints"),
    "lengths": (([0, 1, 2], [1, 2]), {}, "differ in number"),
    "order": (([0, 2, 1], [1, 2, 3]), {}, "do not increase"),
    "twice": (([0, 1, 1], [1, 2, 3]), {}, "do not increase"),
    "nan": (([0, math.nan], [1, 2]), {}, "not finite"),
    "infinite": (([0, 1], [1, math.inf]), {}, "not finite"),
    "text": (("ab", [1, 2]), {}, "not numbers"),
    "no list": ((3, [1, 2]), {}, "not numbers"),
    "symbols": (([0, x], [1, 2]), {}, "not numbers"),
    "kind": (([0, 1], [1, 2]), {"kind": "quintic"}, "unknown kind of table"),
    "outside": (([0, 1], [1, 2]), {"outside": "refuse"}, "unknown outside of table"),
    "slope": (([0, 1e-300], [0, 1e300]), {}, "beyond double precision"),
    "spline": (([0, 1e-300, 1], [0, 1e300, 2]), {"kind": "cubic"}, "beyond double precision"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_wrong_data_are_refused(name):
    arguments, words, message = REFUSED[name]
    with pytest.raises(InputError, match=message) as error:
        eom.Table("curve", *arguments, **words)
    assert "curve" in error.value.where


def test_names_and_arguments_are_checked():
    with pytest.raises(InputError, match="needs a name"):
        eom.Table(" ", [0, 1], [0, 1])
    with pytest.raises(InputError, match="not a number or a SymPy expression"):
        eom.Table("a", [0, 1], [0, 1])("x**2")
