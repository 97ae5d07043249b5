"""Units as texts: what they amount to, round trips, what nobody should write, values with units."""

import math
from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.quantities import Quantity
from eom.units import (
    BASE,
    MAX_EXPONENT,
    PREFIXES,
    ROWS,
    Dimension,
    dimension,
    in_unit,
    measure,
    named,
    number_in,
    read,
)

FACTORS = {
    # NIST SP 811 (2008), appendix B.8: those in bold, which are exact, and what they are in
    "ft": ("3.048e-1", "m"),
    "in": ("2.54e-2", "m"),
    "yd": ("9.144e-1", "m"),
    "mi": ("1.609344e3", "m"),
    "nmi": ("1.852e3", "m"),
    "lb": ("4.5359237e-1", "kg"),
    "oz": ("2.8349523125e-2", "kg"),
    "lbf": ("4.4482216152605", "N"),
    "kgf": ("9.80665", "N"),
    "dyn": ("1.0e-5", "N"),
    "erg": ("1.0e-7", "J"),
    "mph": ("4.4704e-1", "m/s"),
    "ft/s^2": ("3.048e-1", "m/s^2"),
    "atm": ("1.01325e5", "Pa"),
    "h": ("3.6e3", "s"),
    "d": ("8.64e4", "s"),
    "L": ("1.0e-3", "m^3"),
    "kW h": ("3.6e6", "J"),
    # BIPM (2019), table 8
    "min": ("60", "s"),
    "au": ("149597870700", "m"),
    "t": ("1000", "kg"),
}
ROUNDED = {
    # NIST SP 811 (2008), appendix B.8, to the digits printed there
    "slug": (1.459390e1, "kg"),
    "psi": (6.894757e3, "Pa"),
    "hp": (7.456999e2, "W"),
    "lbf ft": (1.355818, "N m"),
    "lbf in": (1.129848e-1, "N m"),
    "lbf/in": (1.751268e2, "N/m"),
    "slug ft^2": (1.355818, "kg m^2"),
    "deg": (1.745329e-2, "rad"),
    "arcmin": (2.908882e-4, "rad"),
    "arcsec": (4.848137e-6, "rad"),
    "rpm": (1.047198e-1, "rad/s"),
    "rev": (6.283185, "rad"),
    "kn": (5.144444e-1, "m/s"),
    "km/h": (2.777778e-1, "m/s"),
}
exponents = st.fractions(min_value=-6, max_value=6, max_denominator=4)
names = st.sampled_from(sorted(ROWS))
prefixed = st.sampled_from(
    ["mm", "µm", "um", "kN", "MPa", "ms", "daN", "hPa", "GHz", "mg", "kW", "mrad"]
)
powers = st.integers(-3, 3).filter(bool)


@pytest.mark.parametrize("unit", FACTORS)
def test_exact_factors_are_those_of_the_tables(unit):
    factor, si = FACTORS[unit]
    assert read(unit).factor == sp.Rational(factor)
    assert read(unit).dimension == dimension(si)


@pytest.mark.parametrize("unit", ROUNDED)
def test_other_factors_are_those_of_the_tables_to_their_digits(unit):
    factor, si = ROUNDED[unit]
    assert float(read(unit).factor) == pytest.approx(factor, rel=5e-7)
    assert read(unit).dimension == dimension(si)


def test_units_of_si_are_defined_by_one_another():
    equal = {
        "N": "kg m/s^2",
        "J": "N m",
        "W": "J/s",
        "Pa": "N/m^2",
        "V": "W/A",
        "C": "A s",
        "F": "C/V",
        "ohm": "V/A",
        "S": "1/ohm",
        "Wb": "V s",
        "T": "Wb/m^2",
        "H": "Wb/A",
        "Hz": "1/s",
    }
    for name, other in equal.items():
        assert dimension(name) == dimension(other), name


@given(st.tuples(*[exponents] * len(BASE)))
def test_what_is_printed_of_a_dimension_is_read_as_it(numbers):
    made = Dimension(*numbers)
    assert read(made.words).dimension == made


@given(st.lists(st.tuples(names | prefixed, powers), min_size=1, max_size=4))
def test_what_is_printed_of_a_unit_is_the_same_in_si(factors):
    text = " ".join(f"{name}^{power}" for name, power in factors)
    unit = read(text)
    written = read(unit.text)
    assert written.dimension == unit.dimension
    assert written.is_coherent
    assert read(written.text) == written


@given(names | prefixed, names | prefixed, powers, powers)
def test_products_and_strokes_are_products_of_factors(first, second, a, b):
    product = read(f"{first}^{a}").times(read(f"{second}^{b}"))
    for text in (
        f"{first}^{a} {second}^{b}",
        f"({first}^{a})*{second}^({b})",
        f"{first}^{a}/{second}^{-b}",
    ):
        found = read(text)
        assert (found.ratio, found.turns, found.dimension) == product[:3]


@pytest.mark.parametrize("prefix", PREFIXES)
def test_prefixes_are_powers_of_ten(prefix):
    assert named(f"{prefix}g").ratio == Fraction(10) ** PREFIXES[prefix] / 1000


def test_spellings():
    same = [
        ("°", "deg"),
        ("µm", "um"),
        ("μm", "µm"),
        ("kg·m²/s²", "J"),
        ("kg⋅m^2*s^-2", "J"),
        ("s⁻¹", "Hz"),
        ("m**2", "m^2"),
        ("m/s/s", "m/s^2"),
        ("(m/s)^2", "m^2/s^2"),
        ("1/(m s)", "m^-1 s^-1"),
        ("Ω", "ohm"),
        ("kΩ", "kohm"),
        (" kg  m ^ 2 / s ", "kg m^2/s"),
        ("m^(-1/2)", "(m^(1/2))^-1"),
        ("", "1"),
        ("  ", "1"),
    ]
    for one, other in same:
        assert read(one)[:3] == read(other)[:3], one


def test_names_that_begin_like_a_prefix_are_what_they_are():
    assert read("min").factor == 60
    assert read("ft").text == "m"
    assert read("Pa").is_coherent
    assert read("cd").dimension.intensity == 1
    assert read("dam").factor == 10
    assert named("mkg") is named("kmin") is named("kdeg") is None


HOSTILE = [
    "m^",
    "m/s/",
    "kg*m^1e9",
    "^2",
    "/",
    "1/",
    "m//s",
    "m**",
    "m^^2",
    "m^2.5",
    "m^x",
    "m^(1/0)",
    "m^(1/2",
    "(m",
    "m)",
    "()",
    "2 m",
    "m 2",
    "10^3 m",
    f"m^{MAX_EXPONENT + 1}",
    "m^999999999999",
    "(m^64)^64",
    "m,s",
    "m;s",
    "m\u0301",
    "\u202em",
    "㎏",
    "ｍ",
    "m\x00",
    "m\n\ns\t%%%",
    "🦀",
    "W/m K",
    "N m/rad*s",
    "kg" * 60,
    "m" * 10**6,
    "((((((((((" * 9,
    "km^(1/2)",
    "__import__",
    "m'",
    '"',
    "\ud800",
    "-m",
    "+m",
    "m-s",
    "1e3 m",
    "°C",
    "nan",
    "inf",
]


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_what_is_no_unit_is_refused_with_one_error(text):
    with pytest.raises(InputError) as caught:
        read(text, "here")
    assert caught.value.where == "here"
    assert len(str(caught.value)) < 1000


@given(st.text(max_size=20))
def test_any_text_is_a_unit_or_refused(text):
    try:
        found = read(text)
    except InputError:
        return
    assert read(found.text).dimension == found.dimension


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("Nm", "N m"),
        ("kgm", "kg m"),
        ("Nms", "N m s"),
        ("meter", "m"),
        ("Newton", "N"),
        ("inch", "in"),
        ("sec", "s"),
        ("radian", "rad"),
        ("degrees", "deg"),
        ("lbs", "lb"),
        ("arcmni", "arcmin"),
        ("kmh", "km/h"),
    ],
)
def test_a_near_spelling_is_offered(name, hint):
    with pytest.raises(InputError, match=f"unknown unit '{name}'") as caught:
        read(name)
    assert caught.value.hint.startswith(f"did you mean {hint}")


# -- values --

VALUES = {
    "30 deg": (sp.pi / 6, "rad"),
    "30°": (sp.pi / 6, "rad"),
    "9.81 m/s^2": (sp.Rational(981, 100), "m/s^2"),
    "100 rpm": (sp.pi * sp.Rational(10, 3), "rad/s"),
    "2 in": (sp.Rational(508, 10000), "m"),
    "5 km/h": (sp.Rational(25, 18), "m/s"),
    "3 N m": (sp.Integer(3), "N m"),
    "-2.5e-3 kN": (sp.Rational(-5, 2), "N"),
    "2 1/s": (sp.Integer(2), "1/s"),
    "5 %": (sp.Rational(1, 20), "1"),
    ".5 µm": (sp.Rational(1, 2000000), "m"),
}


@pytest.mark.parametrize("text", VALUES)
def test_values_are_converted_exactly(text):
    value, unit = VALUES[text]
    found = measure(text)
    assert found.value == value
    assert found.unit.text == unit
    assert in_unit(text, unit) == value
    assert number_in(text, unit) == float(sp.N(value, 40))


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(["m", "N m", "kg m^2/s"]))
def test_a_value_in_si_is_the_number_that_is_written(number, unit):
    assert number_in(f"{number!r} {unit}", unit) == number


@given(st.integers(-(10**9), 10**9))
def test_degrees_are_the_nearest_doubles(number):
    exact = sp.N(sp.pi * number / 180, 60)
    found = number_in(f"{number} deg", "rad")
    assert abs(sp.Float(found, 60) - exact) <= math.ulp(found) / 2 * (1 + 1e-9)


@pytest.mark.parametrize(
    "text", ["2*m", "m", "2", "1e5", "-3", "2/s", "2 + m", "sin(2)", "", "2 - 3 m"]
)
def test_formulas_are_no_values(text):
    assert measure(text) is None


@pytest.mark.parametrize(
    ("text", "unit", "word"),
    [
        ("30 deg", "m", "another dimension"),
        ("3 N m", "N", "another dimension"),
        ("3 furlong", "m", "unknown unit"),
        ("two", "m", "not a number"),
        ("3 m,", "m", "not a unit"),
        ("1e999 m", "", ""),
    ],
)
def test_values_that_do_not_fit_are_refused(text, unit, word):
    if not word:
        assert number_in(text, unit) == math.inf
        return
    with pytest.raises(InputError, match=word):
        number_in(text, unit, "here")


def test_quantities_have_known_units():
    assert Quantity(sp.Symbol("M"), "N m").dimension == dimension("J")
    assert Quantity(sp.Symbol("M")).dimension is None
    assert Quantity(sp.Symbol("M"), "1").dimension == Dimension()
    with pytest.raises(InputError, match="unknown unit 'furlong'") as caught:
        Quantity(sp.Symbol("M"), "furlong")
    assert caught.value.where == "unit of M"
