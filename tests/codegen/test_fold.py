"""Folding rules: each law by its text, and all of them against unfolded arithmetic."""

import inspect
import math
from fractions import Fraction

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen.ir.fold import LAWS, MAX_BITS, RuleSet
from codegen.ir.interpret import Point, interpret, interpret_exactly
from codegen.ir.ops import INTEGER_FIRST, OPS, SOLVE, WITH_DATA
from codegen.ir.passes import prune
from codegen.ir.program import Builder
from tests.clock import calls
from tests.draws import nonzero


def folded(make):
    """The last instructions of what ``make`` builds over x = 0, y = 1."""
    b = Builder()
    x, y = b.leaf("state", 0), b.leaf("state", 1)
    arguments = {"b": b, "x": x, "y": y}
    number = make(*(arguments[n] for n in inspect.signature(make).parameters if n in arguments))
    return b, number


def text(b, number):
    """The value as a nested text; x and y are the states."""
    op, args, value = b.instructions[number]
    if op == "state":
        return "xy"[value]
    if op == "const":
        return str(value)
    return f"{op}({', '.join(text(b, a) for a in args)})" if args else op


FORMS = [
    (lambda b, x: b.add("add", x, b.const(0)), "x"),
    (lambda b, x, y: b.add("add", x, b.add("neg", y)), "sub(x, y)"),
    (lambda b, x, y: b.add("add", b.add("neg", x), y), "sub(y, x)"),
    (lambda b, x: b.add("sub", x, x), "0"),
    (lambda b, x: b.add("sub", x, b.const(0)), "x"),
    (lambda b, x: b.add("sub", b.const(0), x), "neg(x)"),
    (lambda b, x, y: b.add("sub", x, b.add("neg", y)), "add(x, y)"),
    (lambda b, x, y: b.add("sub", b.add("neg", x), y), "neg(add(x, y))"),
    (lambda b, x, y: b.add("sub", b.add("neg", x), b.add("neg", y)), "sub(y, x)"),
    (lambda b, x, y: b.add("add", b.add("neg", x), b.add("neg", y)), "neg(add(x, y))"),
    (lambda b, x: b.add("sub", b.add("neg", x), b.const(0)), "neg(x)"),
    (lambda b, x, y: b.add("mul", b.add("div", x, y), y), "x"),
    (lambda b, x, y: b.add("mul", y, b.add("div", b.const(1), y)), "1"),
    (lambda b, x: b.add("mul", x, b.const(0)), "0"),
    (lambda b, x: b.add("mul", b.const(1), x), "x"),
    (lambda b, x: b.add("mul", b.const(-1), x), "neg(x)"),
    (lambda b, x: b.add("mul", x, b.const(-3)), "mul(x, -3)"),
    (lambda b, x: b.add("neg", b.add("mul", b.const(3), x)), "mul(x, -3)"),
    (lambda b, x, y: b.add("add", b.add("sub", x, y), b.add("sub", y, x)), "0"),
    (lambda b, x, y: b.add("mul", b.add("neg", x), y), "neg(mul(x, y))"),
    (lambda b, x, y: b.add("mul", b.add("neg", x), b.add("neg", y)), "mul(x, y)"),
    (lambda b, x: b.add("div", x, b.const(1)), "x"),
    (lambda b, x: b.add("div", b.const(0), x), "0"),
    (lambda b, x: b.add("div", x, b.const(8)), "mul(x, 1/8)"),
    (lambda b, x: b.add("div", x, b.const(Fraction(1, 4))), "mul(x, 4)"),
    (lambda b, x: b.add("div", x, b.const(-2)), "mul(x, -1/2)"),
    (lambda b, x: b.add("div", x, b.const(3)), "div(x, 3)"),
    (lambda b, x: b.add("div", x, b.const(0)), "div(x, 0)"),
    (lambda b: b.add("div", b.const(0), b.const(0)), "div(0, 0)"),
    (lambda b, x, y: b.add("div", b.add("neg", x), y), "neg(div(x, y))"),
    (lambda b, x, y: b.add("div", x, b.add("neg", y)), "neg(div(x, y))"),
    (lambda b, x: b.add("neg", b.add("neg", x)), "x"),
    *[(lambda b, x, f=f: b.add(f, b.add("neg", x)), f"neg({f}(x))")
      for f in ("sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh", "sign", "erf")],
    *[(lambda b, x, f=f: b.add(f, b.add("neg", x)), f"{f}(x)") for f in ("cos", "cosh", "abs")],
    *[(lambda b, x, f=f: b.add(f, b.add("neg", x)), f"{f}(neg(x))") for f in ("exp", "acos", "sqrt")],
    (lambda b, x, y: b.add("select", b.const(1), x, y), "x"),
    (lambda b, x, y: b.add("select", b.const(0), x, y), "y"),
    (lambda b, x, y: b.add("select", b.add("lt", x, y), y, y), "y"),
    *[(lambda b, x, f=f: b.add(f, x, x), "x") for f in ("min", "max", "and", "or")],
    *[(lambda b, f=f: b.add(f, b.const(0)), "0")
      for f in ("sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh", "sqrt", "abs", "sign",
                "erf", "expm1", "log1p", "floor")],
    *[(lambda b, f=f: b.add(f, b.const(0)), "1") for f in ("cos", "cosh", "exp", "not", "erfc")],
    (lambda b: b.add("floor", b.const(Fraction(-7, 2))), "-4"),
    (lambda b: b.add("mod", b.const(Fraction(-7, 2)), b.const(2)), "1/2"),
    (lambda b: b.add("mod", b.const(Fraction(7, 2)), b.const(-2)), "-1/2"),
    (lambda b: b.add("mod", b.const(1), b.const(0)), "mod(1, 0)"),
    (lambda b: b.add("hypot", b.const(3), b.const(-4)), "5"),
    (lambda b: b.add("hypot", b.const(1), b.const(1)), "hypot(1, 1)"),
    (lambda b, x: b.add("hypot", x, b.const(0)), "abs(x)"),
    (lambda b, x, y: b.add("hypot", b.add("neg", x), b.add("neg", y)), "hypot(x, y)"),
    (lambda b, x, y: b.add("not", b.add("not", b.add("lt", x, y))), "lt(x, y)"),
    (lambda b, x: b.add("not", b.add("not", x)), "not(not(x))"),
    (lambda b, x, y: b.add("eq", b.add("lt", x, y), b.const(0)), "not(lt(x, y))"),
    (lambda b, x: b.add("eq", x, b.const(0)), "eq(x, 0)"),
    (lambda b: b.add("besselj", b.const(0), b.const(0)), "1"),
    (lambda b: b.add("besselj", b.const(2), b.const(0)), "0"),
    (lambda b: b.add("bessely", b.const(2), b.const(0)), "bessely(2, 0)"),
    (lambda b: b.add("stumpff", b.const(3), b.const(0)), "1/6"),
    *[(lambda b, f=f: b.add(f, b.const(1)), "0") for f in ("log", "acos", "acosh", "not")],
    (lambda b: b.add("sqrt", b.const(Fraction(9, 4))), "3/2"),
    (lambda b: b.add("sqrt", b.const(2)), "sqrt(2)"),
    (lambda b: b.add("sqrt", b.const(-4)), "sqrt(-4)"),
    (lambda b: b.add("div", b.const(1), b.const(3)), "1/3"),
    (lambda b: b.add("lt", b.const(1), b.const(2)), "1"),
    (lambda b: b.add("le", b.const(2), b.const(2)), "1"),
    (lambda b: b.add("eq", b.const(1), b.const(2)), "0"),
    (lambda b: b.add("and", b.const(1), b.const(0)), "0"),
    (lambda b: b.add("or", b.const(1), b.const(0)), "1"),
    (lambda b: b.add("max", b.const(1), b.const(-2)), "1"),
    (lambda b: b.add("sign", b.const(-7)), "-1"),
    (lambda b: b.add("abs", b.const(-7)), "7"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "expected"), FORMS)
def test_each_form(make, expected):
    assert text(*folded(make)) == expected


# --- each law of the table by itself, at random ---------------------------------------------------

EXAMPLES = {
    "x + 0 = x": [("add", "x", 0)],
    "x + (-y) = x - y": [("add", "x", ("neg", "y"))],
    "x - x = 0": [("sub", "x", "x")],
    "x - 0 = x": [("sub", "x", 0)],
    "0 - x = -x": [("sub", 0, "x")],
    "x - (-y) = x + y": [("sub", "x", ("neg", "y"))],
    "-x - y = -(x + y)": [("sub", ("neg", "x"), "y")],
    "x - y = -(y - x) where y - x exists": [("add", ("sub", "y", "x"), ("sub", "x", "y"))],
    "0 x = 0": [("mul", 0, "x")],
    "1 x = x": [("mul", "x", 1)],
    "(-1) x = -x": [("mul", "x", -1)],
    "(-x) y = -(x y)": [("mul", ("neg", "x"), "y"), ("mul", ("neg", "x"), ("neg", "y"))],
    "x / y y = x": [("mul", ("div", "x", "y"), "y"), ("mul", "y", ("div", "x", "y"))],
    "x / 1 = x": [("div", "x", 1)],
    "0 / x = 0": [("div", 0, "x")],
    "x / (-c) = -(x / c)": [("div", "x", -3)],
    "x / 2^k = 2^-k x": [("div", "x", 8), ("div", "x", Fraction(1, 1024)),
                         ("div", "x", 2**1020), ("div", "x", Fraction(1, 2**1020))],
    "(-x) / y = -(x / y)": [("div", ("neg", "x"), "y"), ("div", "x", ("neg", "y"))],
    "-(c x) = (-c) x": [("neg", ("mul", 3, "x"))],
    "-(-x) = x": [("neg", ("neg", "x"))],
    "x^0 = 1": [("pow", "x", 0)],
    "x^1 = x": [("pow", "x", 1)],
    "x^n, x^(n/2): products, and a root": [
        ("pow", "x", 2), ("pow", "x", 7), ("pow", "x", -3),
        ("pow", ("abs", "x"), Fraction(1, 2)), ("pow", ("abs", "x"), Fraction(-5, 2))],
    "select(c, x, y) = x or y for a constant c": [("select", 1, "x", "y"), ("select", 0, "x", "y")],
    "select(c, x, x) = x": [("select", ("lt", "x", "y"), "y", "y")],
    "min(x, x) = max(x, x) = x": [("min", "x", "x"), ("max", "x", "x")],
    "and(x, x) = or(x, x) = x for truth values": [
        ("and", ("lt", "x", "y"), ("lt", "x", "y")), ("or", ("lt", "x", "y"), ("lt", "x", "y"))],
    **{f"{f}(-x) = -{f}(x)": [(f, ("neg", "x"))]
       for f in ("sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh", "erf", "sign")},
    **{f"{f}(-x) = {f}(x)": [(f, ("neg", "x"))] for f in ("cos", "cosh", "abs")},
    "hypot(-x, y) = hypot(x, y)": [("hypot", ("neg", "x"), "y"), ("hypot", "x", ("neg", "y"))],
    "hypot(0, x) = |x|": [("hypot", 0, "x"), ("hypot", "x", 0)],
    "not(not(x)) = x for truth values": [("not", ("not", ("lt", "x", "y")))],
    "(x = 0) = not(x) for truth values": [("eq", ("lt", "x", "y"), 0)],
}  # fmt: skip
"""Left sides, by the text of the law."""

NOTHING = RuleSet("nothing", {})


def alone(law):
    """A set of rules with one law in it."""
    return RuleSet(law.text, dict.fromkeys(law.ops, (law,)))


def written(rules, tree):
    """Build the form ``tree`` over x and y by ``rules``."""
    b = Builder(rules)

    def build(node):
        if isinstance(node, tuple):
            return b.add(node[0], *map(build, node[1:]))
        return b.leaf("state", "xy".index(node)) if isinstance(node, str) else b.const(node)

    return b.program({"f": [build(tree)]})


SPECIAL = st.sampled_from([0.0, -0.0, math.inf, -math.inf, math.nan, 5e-324, -1.7e308, 1.0, -1.0])
CASES = [(law, tree) for law in LAWS for tree in EXAMPLES[law.text]]


def test_every_law_has_an_example_and_every_example_is_a_law():
    assert [law.text for law in LAWS] == list(EXAMPLES)


@pytest.mark.parametrize(("law", "tree"), CASES, ids=lambda v: getattr(v, "text", ""))
def test_each_law_changes_its_left_side(law, tree):
    after, before = (prune(written(r, tree)) for r in (alone(law), NOTHING))
    assert str(after) != str(before)


@pytest.mark.parametrize(("law", "tree"), CASES, ids=lambda v: getattr(v, "text", ""))
@settings(max_examples=30)
@given(x=nonzero(1e-3, 0.95), y=nonzero(1e-3, 0.95))
def test_each_law_holds_at_50_digits(law, tree, x, y):
    after, before = (
        interpret_exactly(written(r, tree), Point(x=[x, y]))["f"][0] for r in (alone(law), NOTHING)
    )
    assert abs(after - before) <= mpmath.mpf(10) ** -45 * (1 + abs(before))


@pytest.mark.sparse(3)
@pytest.mark.parametrize(
    ("law", "tree"), [c for c in CASES if c[0].exact], ids=lambda v: getattr(v, "text", "")
)
@settings(max_examples=60)
@given(x=SPECIAL | st.floats(), y=SPECIAL | st.floats())
def test_each_exact_law_holds_bit_for_bit(law, tree, x, y):
    """NaN is NaN, of whatever sign and payload."""
    after, before = (
        interpret(written(r, tree), Point(x=[x, y]))["f"][0] for r in (alone(law), NOTHING)
    )
    assert repr(float(after)) == repr(float(before))


@pytest.mark.parametrize(
    ("text", "at"),
    [
        ("x + 0 = x", -0.0), ("x - x = 0", math.inf), ("0 - x = -x", 0.0), ("0 x = 0", math.nan),
        ("0 / x = 0", math.nan), ("x - y = -(y - x) where y - x exists", 1.0), ("sign(-x) = -sign(x)", 0.0),
    ],
)  # fmt: skip
def test_laws_that_are_not_exact_fail_somewhere(text, at):
    """So that the column of the table says something."""
    (law,) = (law for law in LAWS if law.text == text)
    tree = ("sub", "x", "y") if "exists" in text else EXAMPLES[text][0]
    if "exists" in text:  # the difference alone: -(1 - 1) is -0
        b = Builder(alone(law))
        x, y = b.leaf("state", 0), b.leaf("state", 1)
        b.add("sub", y, x)
        folded = b.program({"f": [b.add("sub", x, y)]})
    else:
        folded = written(alone(law), tree)
    at_point = Point(x=[at, at])
    after, before = (interpret(p, at_point)["f"][0] for p in (folded, written(NOTHING, tree)))
    assert not law.exact
    assert repr(float(after)) != repr(float(before))


def test_work_of_the_builder():
    """A few calls an instruction."""

    def build():
        b = Builder()
        numbers = [b.leaf("state", k) for k in range(50)]
        for k in range(20_000):
            op = ("mul", "add", "sub", "mul", "div")[k % 5]
            numbers.append(b.add(op, numbers[-1 - k % 49], numbers[-1 - (k * k + 3) % 47]))

    assert calls(build) < 30 * 20_000


def test_constants_that_grow_too_large_are_left_alone():
    b = Builder()
    large = b.const(Fraction(2) ** (MAX_BITS - 10))
    assert b.instructions[b.add("mul", large, b.const(3))].op == "const"
    product = b.add("mul", large, large)
    assert b.instructions[product].op == "mul"


OPERATIONS = sorted(set(OPS) - {"pow", "atan2", *INTEGER_FIRST, *WITH_DATA, *SOLVE})
SMALL = st.fractions(-3, 3, max_denominator=4)


@pytest.mark.slow
@settings(max_examples=300)
@given(st.data())
def test_folded_programs_have_the_value_of_unfolded_arithmetic(data):
    """Build at random, with many zeros, ones and negatives, and evaluate beside it."""
    m = mpmath.mp.clone()
    m.dps = 60
    b = Builder()
    state = st.sampled_from([-1.5, -0.5, 0.25, 0.75, 2.5])
    point = Point(x=[data.draw(state), data.draw(state)])
    values = {}
    for _ in range(data.draw(st.integers(1, 4))):
        c = data.draw(SMALL)
        values[b.const(c)] = m.mpf(c.numerator) / c.denominator
    numbers = [b.leaf("state", 0), b.leaf("state", 1), *values]
    exact = [m.mpf(point.x[0]), m.mpf(point.x[1]), *values.values()]
    for _ in range(data.draw(st.integers(1, 10))):
        op = data.draw(st.sampled_from(["neg", "mul", "add", "sub", "div", *OPERATIONS]))
        chosen = [data.draw(st.integers(0, len(numbers) - 1)) for _ in range(OPS[op].arity)]
        if op in {"and", "or", "not", "select"} and exact[chosen[0]] not in {0, 1}:
            continue
        if op in {"and", "or"} and exact[chosen[1]] not in {0, 1}:
            continue
        try:
            value = OPS[op].exact(m, *(exact[k] for k in chosen))
        except (ValueError, ZeroDivisionError):
            continue
        if isinstance(value, m.mpc) or not m.isfinite(value) or abs(value) > 1e20:
            continue
        numbers.append(b.add(op, *(numbers[k] for k in chosen)))
        exact.append(value)
    program = b.program({"f": numbers})
    for got, expected in zip(interpret_exactly(program, point, 60)["f"], exact, strict=True):
        assert abs(got - expected) <= m.mpf(10) ** -25 * (1 + abs(expected))
