"""Rules of precedence, what is ambiguous, errors with their places, and bounds."""

import pytest

from eom.checker.read.grammar import read_formula
from eom.checker.read.spans import ReadingError
from eom.checker.read.statements import split
from tests.clock import growth_in_calls
from tests.eom.checker.shape import shape
from tests.eom.rows import every


def notes(text):
    return [n.name for n in read_formula(text).notes]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (r"a \times b c", "[a x [b c]]"),
        (r"a b \times c", "[[a b] x c]"),
        (r"a \cdot b \times c", "[a . [b x c]]"),
        (r"\omega \times I \cdot \omega", "[[omega x I] . omega]"),
        (r"\sum_i m_i r_i \times p_i + h", "[sum{_i}([[m{_i} r{_i}] x p{_i}]) + h]"),
        (r"\int a + b\,dm + c", "[int([a + b]; m) + c]"),
        (r"\int_0^t \int_V f\,dV\,dt g", "[int{_0 ^t}(int{_V}(f; V); t) g]"),
        (r"\int \frac{dm}{r^2}", "int(frac(1, r{^2}); m)"),
        (r"\int \mu r \frac{\rho\,dV}{r^3}", "int([mu r frac(rho, r{^3})]; V)"),
        (r"\frac{d}{dt} m v + w", "[D([m v])/t + w]"),
        (r"\frac{d}{dt}(a) b", "[D((a))/t b]"),
        (r"- a b", "[-[a b]]"),
        (r"a \times - b", "[a x [-b]]"),
        (r"\sin \omega t \cos 2 \theta x", "[sin [omega t] cos [2 theta] x]"),
        (r"\sin^2 \theta + \cos^{-1} x", "[sin{^2} theta + cos{^[-1]} x]"),
        (r"x^23", "[x{^2} 3]"),
        (r"\frac12", "frac(1, 2)"),
        (r"m g d \theta", "[m g d theta]"),
        (r"1/2 m v", "[[1 / 2] m v]"),
        (r"a{\times}b{=}c", "[a x b] = c"),
        (r"T^a{}_b", "T{_b ^a}"),
        (r"R{}^{A}x", "[R x{<A}]"),
        (r"r''^2", "r{^!prime!prime}{^2}"),
        (r"\left. x^2 \right|_0^1", "at(x{^2}{_0 ^1})"),
        (r"\frac{dr}{dt}\bigg|_B", "D(r)/t@B"),
        (r"\frac{dr}{dt}\bigg|_{t=0}", "at(D(r)/t{_t = 0})"),
        (r"2|a||b|", "[2 |a| |b|]"),
        (r"\frac{\partial^2 f}{\partial x\,\partial y}", "P2(f)/x,y"),
        (r"a => b -> c", "a implies b to c"),
        (r"\mathbf{a\cdot b}", "⟦[*a . *b]⟧"),
        (r"a \boldsymbol{\times} b", "[a x b]"),
        (r"\omega_{\mathrm{rel}, i\neq j}", "omega{_rm:rel, i != j}"),
        (r"v_{\rm rel}", "v{_rm:rel}"),
        (r"\omega_{\pm}^2", "omega{_!pm ^2}"),
        (r"\frac{d\,(m v)}{d t}", "D(([m v]))/t"),
    ],
)
def test_precedence(text, expected):
    assert shape(read_formula(text).tree) == expected


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (r"a \times b \times c", "ambiguous cross"),
        (r"\frac{d}{dt} a \times b", "derivative reach"),
        (r"\int dm\, r", "empty integral"),
        (r"\int r", "no differential"),
        (r"a/2b", "slash"),
        (r"\sin\theta/2", "slash"),
        (r"\sin(x)^2", "power of a function"),
    ],
)
def test_what_could_be_meant_otherwise_is_noted(text, name):
    assert notes(text) == [name]


@pytest.mark.parametrize(
    "text", [r"a \times (b \times c)", r"2 \times 3 \times 4", r"\int r\,dm", r"\frac12 m"]
)
def test_what_is_clear_is_not_noted(text):
    assert notes(text) == []


@pytest.mark.parametrize(
    ("text", "offset", "what"),
    [
        (r"a + \foo b", 4, "unknown command"),
        (r"a + ) b", 4, "cannot be read"),
        (r"(a + b", 6, "is missing"),
        (r"\vec{a", 6, "is missing"),
        (r"a +", 3, "ends"),
        (r"\frac{a}{}", 8, "empty"),
        (r"a } b", 2, "cannot be read"),
        (r"\left( a", 8, "missing"),
        (r"\begin{bmatrix} a & b", 21, "missing"),
        (r"a ^", 3, "ends"),
        (r"{}^{A} = b", 7, "no base"),
        (r"a # b", 2, "cannot be read"),
        (r"a, , b", 3, "missing"),
        (r"\text{if", 0, "closing brace"),
        (r"\begin{foo} a \end{foo}", 0, "unknown environment"),
    ],
)
def test_errors_show_their_place(text, offset, what):
    with pytest.raises(ReadingError) as caught:
        read_formula(text)
    assert caught.value.span.start == offset
    assert what in str(caught.value)
    line = str(caught.value.got).split("\n")
    assert line[0] == text
    assert line[1].index("^") == offset + 12


def test_unknown_command_has_near_matches():
    with pytest.raises(ReadingError, match="omega"):
        read_formula(r"\omgea + 1")


@pytest.mark.parametrize(
    ("opening", "closing"),
    [
        ("(", ")"),
        ("{", "}"),
        (r"\dot{", "}"),
        ("x^{", "}"),
        (r"\left[", r"\right]"),
        ("- ", ""),
        (r"\sum_i ", ""),
        (r"\int ", ""),
        (r"\frac{", "}{2}"),
        (r"\sqrt{", "}"),
        ("|", "|"),
        (r"\frac{d}{dt}", ""),
        (r"\begin{bmatrix}", r"\end{bmatrix}"),
        (r"a \wedge b \times ", ""),
        (r"\sin ", ""),
        ("{}^{A}", ""),
        ("_", ""),
        (r"\boxed{", "}"),
        (r"\hat", ""),
    ],
)
def test_deep_nesting_is_a_clear_error(opening, closing):
    for count in (60, 2000):
        with pytest.raises(ReadingError):
            read_formula(opening * count + "x" + closing * count)


def test_twenty_levels_are_read():
    tree = read_formula("(" * 20 + "x" + ")" * 20).tree
    assert shape(tree) == "(" * 20 + "x" + ")" * 20


UNITS = [
    *["a + ", r"a_1 \vec b = ", r"a \Rightarrow ", r"a \\ ", r"\frac{a}{b} ", "a, "],
    *[
        r"a = b \quad ",
        r"\\ ",
        "{} ",
        r"= a \\ ",
        r"\overset{!}{=} a ",
        "'",
        r"- a \\ ",
        "a\n= b\n",
    ],
]


@pytest.mark.parametrize("unit", every(4, UNITS))
def test_time_grows_with_length(unit):
    assert growth_in_calls(9, lambda n: split(read_formula(f"a {unit * n} c").tree), 100, 800)


def test_megabytes_are_refused_at_once():
    with pytest.raises(ReadingError, match="too long"):
        read_formula("a + " * 300_000 + "a")


def test_powers_are_not_computed():
    assert shape(read_formula("x^{9^{9^9}}").tree) == "x{^9{^9{^9}}}"
