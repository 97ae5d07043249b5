"""The restricted parser: what it reads, what it refuses, and that it never takes long."""

from __future__ import annotations

import subprocess
import sys

import pytest
import sympy as sp
from hypothesis import example, given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.exact.identity import equal
from eom.expressions import saturate
from eom.scenes import parse as parser
from eom.scenes.parse import FUNCTIONS, parse
from tests.clock import calls
from tests.draws import examples
from tests.eom.rows import but

x, y, z = sp.symbols("x y z", real=True)
NAMES = {"x": x, "y": y, "z": z}
R = sp.Rational


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("-2^2", -4),
        ("(-2)^2", 4),
        ("2^3^2", 512),
        ("2**3**2", 512),
        ("(2^3)^2", 64),
        ("2^-1", R(1, 2)),
        ("2^-x", 2**-x),
        ("2^-1*3", R(3, 2)),
        ("-x^2", -(x**2)),
        ("--x", x),
        ("-+x", -x),
        ("x/y/z", x / (y * z)),
        ("x-y-z", x - y - z),
        ("x-y+z", x - y + z),
        ("x/y*z", x * z / y),
        ("x*-y", -x * y),
        ("x+y*z^2", x + y * z**2),
        ("-x/y", -x / y),
        ("2*-3", -6),
        ("0.1+0.2", R(3, 10)),
        (".5", R(1, 2)),
        ("1.", 1),
        ("1.5e-3", R(3, 2000)),
        ("2E2", 200),
        ("1e+2", 100),
        ("pi/2", sp.pi / 2),
        ("  x \t+\n y ", x + y),
        ("sin(pi/6)", R(1, 2)),
        ("atan2(y, x)", sp.atan2(y, x)),
        ("max(x, min(y, 2))", sp.Max(x, sp.Min(y, 2))),
        ("abs(-3)", 3),
        ("sqrt(4)", 2),
        ("sign(-2)*x", -x),
        ("x^(1/3)", x ** R(1, 3)),
        ("((((x))))", x),
    ],
)
def test_reading(text, expected):
    assert sp.simplify(parse(text, NAMES) - expected) == 0


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_function_is_sympy_s_of_the_same_name(name):
    special = {"abs": sp.Abs, "min": sp.Min, "max": sp.Max, "saturate": saturate}
    count = {"atan2": 2, "min": 2, "max": 2, "saturate": 3}.get(name, 1)
    expected = special.get(name) or getattr(sp, name)
    arguments = [x, y, z][:count]
    assert parse(f"{name}({', '.join(map(str, arguments))})", NAMES) == expected(*arguments)
    with pytest.raises(InputError, match=f"{name} takes {count} argument"):
        parse(f"{name}({', '.join('x' for _ in range(count + 1))})", NAMES)


def test_given_names_come_before_constants():
    own = sp.Symbol("own")
    assert parse("pi", {"pi": own}) == own
    assert parse("pi", {}) == sp.pi


leaves = st.one_of(
    st.sampled_from([x, y, z, sp.pi]),
    st.fractions(-50, 50, max_denominator=20).map(lambda f: R(f.numerator, f.denominator)),
)


def grow(children):
    pair = st.tuples(children, children)
    return st.one_of(
        pair.map(lambda p: p[0] + p[1]),
        pair.map(lambda p: p[0] - p[1]),
        pair.map(lambda p: p[0] * p[1]),
        st.tuples(children, st.integers(0, 3)).map(lambda p: p[0] ** p[1]),
        st.tuples(children, st.sampled_from([x, y])).map(lambda p: p[0] / (p[1] ** 2 + 1)),
        st.tuples(st.sampled_from([sp.sin, sp.cos, sp.tanh, sp.atan]), children).map(
            lambda p: p[0](p[1] * x)
        ),
    )


expressions = st.recursive(leaves, grow, max_leaves=8)


def real_enough(expression):
    text = str(expression)
    numbers = expression.atoms(sp.Rational)
    return len(text) < 2000 and all(abs(n.p) < 2**200 and n.q < 2**200 for n in numbers)


@examples(80)
@given(expression=expressions.filter(real_enough))
def test_printed_expressions_read_back_as_themselves(expression):
    back = parse(str(expression), NAMES)
    if back == expression:
        return
    point = {x: R(3, 7), y: R(-5, 11), z: R(13, 17)}
    difference = (back - expression).subs(point).evalf(40)
    scale = 1 + abs(expression.subs(point).evalf(40))
    assert abs(difference) < R(1, 10**30) * scale


tokens = st.lists(
    st.sampled_from(
        [
            *"+-*/^(),.",
            "**",
            "x",
            "y",
            "0",
            "1",
            "2",
            "9",
            "64",
            "0.5",
            "1e150",
            "1e-99",
            "1/3",
            " ",
            "pi",
            *(f"{name}(" for name in FUNCTIONS),
            ")",
            ")",
            ")",
        ]
    ),
    max_size=25,
).map("".join)


MOST_CALLS = 2_000_000
"""About half a second."""


def outcome(text):
    """Either an expression over the names or one `InputError` with a message; never slow."""
    found = []

    def work():
        try:
            found.append(parse(text, NAMES, "here"))
        except InputError as error:
            found.append(error)

    assert calls(work) < MOST_CALLS
    (value,) = found
    if isinstance(value, InputError):
        assert value.where == "here"
        assert value.what
        assert value.got
        assert len(str(value)) < 3000
    else:
        assert isinstance(value, sp.Expr)
        assert value.free_symbols <= {x, y, z}
        assert not value.has(sp.nan, sp.zoo, sp.oo, sp.I)
    return value


@examples(300)
@given(text=tokens)
def test_any_heap_of_tokens_is_read_or_refused(text):
    outcome(text)


@examples(200)
@given(text=st.text(max_size=60))
@example("\0")
@example("x\0")
@example("٣")
@example("²")
@example("x'")
@example("\ud800")
@example("x\u00a0+1")
def test_any_text_is_read_or_refused(text):
    value = outcome(text)
    if isinstance(value, sp.Expr):
        assert (
            set(text.strip())
            <= set("xyz0123456789.eE+-*/^(), \t\r\n\x0b\x0c") | {c for c in text if c.isspace()}
            or "pi" in text
        )


BOMBS = [
    "9**9**9**9",
    "9^9^9",
    "2^65",
    "2^(1/0.001)",
    "(9*x)^64^2",
    "((9*x)^64)^64",
    "(((((9*x)^64)^64)^64)^64)^64",
    "(1e150*x)^64",
    "1e150*1e150",
    "1e300",
    "1e999",
    "1e-999",
    "1" * 3999,
    "0." + "0" * 3000 + "1",
    "exp(exp(exp(1e300)))",
    "exp(1e5)",
    "sign(exp(exp(exp(100))) - 1)",
    "max(exp(exp(exp(100))), 1)",
    "abs(exp(exp(exp(100))) - 2)",
    "sin(exp(exp(exp(100))))",
    "sqrt(cosh(exp(exp(100))) - 1)",
    "2^sqrt(2)^64",
    "2^(1/1e9)",
    "acos(sin(exp(700)))",
    "asin(sin(sinh(600)))",
    "(" * 70 + "x" + ")" * 70,
    "-" * 1000 + "x",
    "sin(" * 500 + "x" + ")" * 500,
    "^".join(["x"] * 200),
    "x" * 4001,
    "(" * 10**6,
]


@pytest.mark.parametrize("text", BOMBS, ids=lambda t: t[:30])
def test_bombs_are_refused(text):
    assert isinstance(outcome(text), InputError)


HARMLESS = {
    "60 deep": ("(" * 59 + "x" + ")" * 59, x),
    "long sum": ("+".join(["x"] * 1900), 1900 * x),
    "long product": ("*".join(["(x+1)"] * 600), (x + 1) ** 600),
    "largest exponent": ("2^64", 2**64),
    "roots": ("sign(sqrt(2)+sqrt(3)-sqrt(5+2*sqrt(6)))", 0),
    "nested maximum": ("max(" * 50 + "x" + ",1)" * 50, sp.Max(1, x)),
}


@pytest.mark.parametrize("name", but(HARMLESS, "long sum"))
def test_large_formulas_within_the_limits_are_read(name):
    text, expected = HARMLESS[name]
    assert outcome(text) == expected


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os')",
        "x.__class__",
        "x.real",
        "x[0]",
        "x;y",
        "lambda: 0",
        "x if y else z",
        "x = 1",
        "x == y",
        "x < y",
        "{x}",
        "'x'",
        '"x"',
        "x!",
        "x%y",
        "x//y",
        "~x",
        "x@y",
        "#x",
        "1_000",
        "0x10",
        "1j",
        "θ",
        "x'",
        "x²",
        "∞",
        "２",
        "٣",
        "𝐱",
        "eval(x)",
        "open(x)",
        "Symbol(x)",
        "factorial(9)",
        "x(y)",
        "sin",
        "sin x",
        "2x",
        "x y",
        "",
        " ",
        "()",
        "x+",
        "*x",
        "x,y",
        "(x",
        "x)",
        "1..2",
        "1e",
        "E",
        "I",
        "oo",
        "nan",
        "zoo",
        "asin(2)",
        "log(-1)",
        "sqrt(-1)",
        "(-8)^(1/3)",
        "1/0",
        "0/0",
        "0^-1",
        "x/(y-y)",
        "log(0)",
        "tan(pi/2)",
        "atanh(1)",
    ],
)
def test_anything_else_is_refused(text):
    assert isinstance(outcome(text), InputError)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("x + qq", 5),
        ("x + 1/0", 6),
        ("x $ y", 3),
        ("sin(x", 6),
        ("(x + y))", 8),
        ("x + * y", 5),
        ("x + sin(1, 2)", 5),
        ("x + 1e999", 5),
        ("x   ؟", 5),
        ("", 1),
    ],
)
def test_errors_show_the_place(text, place):
    error = outcome(text)
    assert isinstance(error, InputError)
    assert f"character {place}" in error.got
    assert text[max(0, place - 3) : place] in error.got.replace("\\", "")


def test_place_in_a_long_formula_shows_its_surroundings():
    text = "+".join(["x"] * 200) + "+qq+" + "+".join(["y"] * 200)
    error = outcome(text)
    assert "qq" in error.got
    assert f"character {text.index('qq') + 1}" in error.got
    assert len(error.got) < 120


def test_unknown_names_come_with_near_matches():
    names = {"theta_dot": x, "psi": y}
    with pytest.raises(InputError) as caught:
        parse("theta_dt + psi", names)
    assert caught.value.hint == "did you mean theta_dot?"
    assert "unknown name 'theta_dt'" in caught.value.what


def test_nothing_is_evaluated(tmp_path):
    """A file that any evaluated text would have made does not appear."""
    target = tmp_path / "made"
    attack = f"__import__('pathlib').Path({str(target)!r}).touch()"
    code = (
        "from eom.scenes.parse import parse\ntry:\n"
        f"    parse({attack!r}, {{}})\nexcept ValueError:\n    print('refused')"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "refused"
    assert not target.exists()


@examples(60)
@given(
    operators=st.lists(st.sampled_from("+-*/"), min_size=1, max_size=12),
    values=st.lists(st.integers(1, 99), min_size=13, max_size=13),
)
def test_arithmetic_agrees_with_python_s_fractions(operators, values):
    from fractions import Fraction

    text = str(values[0]) + "".join(f"{o}{v}" for o, v in zip(operators, values[1:], strict=False))
    names = {f"v{k}": Fraction(v) for k, v in enumerate(values)}
    python = "v0" + "".join(f"{o}v{k}" for k, o in enumerate(operators, 1))
    expected = eval(python, {"__builtins__": {}}, names)  # the oracle is Python's own grammar
    assert parse(text, {}) == R(expected.numerator, expected.denominator)


@examples(40)
@given(signs=st.lists(st.sampled_from(["", "-", "--", "+"]), min_size=3, max_size=3))
def test_signs_bind_as_in_python(signs):
    a, b, c = signs
    text = f"{a}x**{b}2*{c}y"
    expected = eval(text, {"__builtins__": {}}, {"x": x, "y": y})
    assert equal(parse(text, NAMES), sp.sympify(expected))


def test_limits_are_what_the_tests_assume():
    assert (parser.MAX_LENGTH, parser.MAX_DEPTH, parser.MAX_EXPONENT) == (4000, 60, 64)
