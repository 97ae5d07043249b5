"""Units as texts: what they amount to in SI, exactly, and their dimensions; values with units.

A unit is a product of powers of the names of `ROWS`, most of them with the prefixes of SI: ``kg m^2/s``,
``N m``, ``1/(m s)``, ``mm``, ``lbf ft``, ``µm``, ``°``. A stroke stands before one factor, or one bracket.

Sources: The International System of Units, 9th ed. (BIPM 2019), tables 2 to 8 and 7 (prefixes); Thompson
and Taylor, Guide for the Use of the International System of Units, NIST SP 811 (2008), appendix B.8.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

import sympy as sp

from eom.errors import InputError, is_text, near_matches, shown

Expr = Any

MAX_EXPONENT = 64
MAX_LENGTH = 100
"""Characters of a unit."""
BASE = ("kg", "m", "s", "A", "K", "mol", "cd")
"""The base units of SI, in the order of the exponents of a `Dimension`."""


class Dimension(NamedTuple):
    """Exponents of mass, length, time, current, temperature, amount of substance, luminous intensity."""

    mass: Fraction = Fraction(0)
    length: Fraction = Fraction(0)
    time: Fraction = Fraction(0)
    current: Fraction = Fraction(0)
    temperature: Fraction = Fraction(0)
    amount: Fraction = Fraction(0)
    intensity: Fraction = Fraction(0)

    def times(self, other: Dimension) -> Dimension:
        """Return the dimension of a product.

        Parameters
        ----------
        other : Dimension
            Of the other factor.

        Returns
        -------
        Dimension
            Exponents added.
        """
        return Dimension(*(a + b if a and b else a or b for a, b in zip(self, other, strict=True)))

    def power(self, exponent: Fraction | int) -> Dimension:
        """Return the dimension of a power.

        Parameters
        ----------
        exponent : Fraction or int
            A whole number or a fraction.

        Returns
        -------
        Dimension
            Exponents multiplied.
        """
        return Dimension(*(a * exponent if a else a for a in self))

    @property
    def words(self) -> str:
        """The unit in SI.

        >>> dimension("N m s").words, dimension("").words
        ('kg m^2/s', '1')
        """
        return _written(zip(BASE, self, strict=True))


def _written(powers: Iterable[tuple[str, Fraction]]) -> str:
    """Return a product of powers with one stroke at most."""
    named = list(powers)
    above = " ".join(_spelt(n, e) for n, e in named if e > 0)
    below = " ".join(_spelt(n, -e) for n, e in named if e < 0)
    below = f"({below})" if " " in below else below
    return (above or "1") + (f"/{below}" if below else "")


def _spelt(name: str, exponent: Fraction) -> str:
    if exponent == 1:
        return name
    return f"{name}^{exponent}" if exponent.denominator == 1 else f"{name}^({exponent})"


NONE = Dimension()


class Unit(NamedTuple):
    """What a unit amounts to: ``ratio`` times pi to the ``turns`` of the unit ``si`` of SI.

    ``si``: names of SI with their powers, which spell the coherent unit of the same ``dimension``.
    """

    ratio: Fraction = Fraction(1)
    turns: int = 0
    dimension: Dimension = NONE
    si: tuple[tuple[str, Fraction], ...] = ()

    @property
    def is_coherent(self) -> bool:
        """Whether it is a unit of SI without a factor."""
        return self.ratio == 1 and self.turns == 0

    @property
    def factor(self) -> Expr:
        """How many of ``text`` it is, exactly.

        >>> read("rpm").factor, read("in").factor
        (pi/30, 127/5000)
        """
        return sp.Rational(self.ratio.numerator, self.ratio.denominator) * sp.pi**self.turns

    @property
    def text(self) -> str:
        """The coherent unit of SI.

        >>> read("lbf ft").text, read("km/h").text, read("deg").text
        ('N m', 'm/s', 'rad')
        """
        return _written(self.si)

    def times(self, other: Unit) -> Unit:
        """Return the product."""
        powers = dict(self.si)
        for name, power in other.si:
            powers[name] = powers.get(name, Fraction(0)) + power
        return Unit(
            self.ratio * other.ratio,
            self.turns + other.turns,
            self.dimension.times(other.dimension),
            tuple((n, p) for n, p in powers.items() if p),
        )

    def power(self, exponent: Fraction) -> Unit:
        """Return a power. Raises `ValueError` for a root of a unit with a factor, which is not exact."""
        if exponent.denominator != 1 and not self.is_coherent:
            raise ValueError("a root of a unit of SI alone is exact")
        whole = int(exponent) if exponent.denominator == 1 else 0
        return Unit(
            self.ratio**whole,
            self.turns * whole,
            self.dimension.power(exponent),
            tuple((n, p * exponent) for n, p in self.si),
        )


# -- names ---------------------------------------------------------------------------------------------

_BASE: Mapping[str, str] = {
    "1": "",
    "rad": "",
    "sr": "",
    **{name: name for name in BASE},
    "Hz": "s^-1",
    "N": "kg m s^-2",
    "Pa": "kg m^-1 s^-2",
    "J": "kg m^2 s^-2",
    "W": "kg m^2 s^-3",
    "C": "A s",
    "V": "kg m^2 s^-3 A^-1",
    "F": "kg^-1 m^-2 s^4 A^2",
    "ohm": "kg m^2 s^-3 A^-2",
    "S": "kg^-1 m^-2 s^3 A^2",
    "Wb": "kg m^2 s^-2 A^-1",
    "T": "kg s^-2 A^-1",
    "H": "kg m^2 s^-2 A^-2",
}
"""Units of SI by base units: BIPM (2019), tables 2 and 4."""

_OTHERS: Mapping[str, tuple[str, int, str]] = {
    "g": ("1/1000", 0, "kg"),
    "t": ("1000", 0, "kg"),
    "min": ("60", 0, "s"),
    "h": ("3600", 0, "s"),
    "d": ("86400", 0, "s"),
    "day": ("86400", 0, "s"),
    "days": ("86400", 0, "s"),
    "week": ("604800", 0, "s"),
    "deg": ("1/180", 1, "rad"),
    "arcmin": ("1/10800", 1, "rad"),
    "arcsec": ("1/648000", 1, "rad"),
    "gon": ("1/200", 1, "rad"),
    "rev": ("2", 1, "rad"),
    "rpm": ("1/30", 1, "rad s^-1"),
    "L": ("1/1000", 0, "m^3"),
    "l": ("1/1000", 0, "m^3"),
    "bar": ("100000", 0, "Pa"),
    "atm": ("101325", 0, "Pa"),
    "au": ("149597870700", 0, "m"),
    "Wh": ("3600", 0, "J"),
    "in": ("0.0254", 0, "m"),
    "ft": ("0.3048", 0, "m"),
    "yd": ("0.9144", 0, "m"),
    "mi": ("1609.344", 0, "m"),
    "nmi": ("1852", 0, "m"),
    "kn": ("463/900", 0, "m s^-1"),
    "mph": ("0.44704", 0, "m s^-1"),
    "lb": ("0.45359237", 0, "kg"),
    "oz": ("0.028349523125", 0, "kg"),
    "lbf": ("4.4482216152605", 0, "N"),
    "ozf": ("0.27801385095378125", 0, "N"),
    "slug": ("8896443230521/609600000000", 0, "kg"),
    "psi": ("8896443230521/1290320000", 0, "Pa"),
    "kgf": ("9.80665", 0, "N"),
    "dyn": ("1/100000", 0, "N"),
    "erg": ("1/10000000", 0, "J"),
    "hp": ("37284993579113511/50000000000000", 0, "W"),
    "%": ("1/100", 0, ""),
}
"""Other units: how many of which, ratio and power of pi. All are exact: BIPM, table 8; NIST SP 811, B.8."""

PREFIXES: Mapping[str, int] = {
    "Q": 30, "R": 27, "Y": 24, "Z": 21, "E": 18, "P": 15, "T": 12, "G": 9, "M": 6, "k": 3, "h": 2, "da": 1,
    "d": -1, "c": -2, "m": -3, "µ": -6, "n": -9, "p": -12, "f": -15, "a": -18, "z": -21, "y": -24,
    "r": -27, "q": -30,
}  # fmt: skip
"""Powers of ten by the prefixes of SI: BIPM (2019), table 7."""
_PREFIXED = ({*_BASE} - {"1", "kg"}) | {"g", "t", "L", "l", "bar", "Wh"}

_LETTERS = str.maketrans({"μ": "µ", "\u2126": "Ω", "·": "*", "⋅": "*", "−": "-"})
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_POWERS = re.compile("[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+")


def _of_base(text: str) -> tuple[tuple[str, Fraction], ...]:
    pairs = (word.partition("^") for word in text.split())
    return tuple((name, Fraction(power or "1")) for name, _, power in pairs)


def _dimension_of(text: str) -> Dimension:
    powers = dict(_of_base(text))
    return Dimension(*(powers.get(n, Fraction(0)) for n in BASE))


def _table() -> dict[str, Unit]:
    """Return all units without prefixes by name."""
    one, found = Fraction(1), {}
    for name, base in _BASE.items():
        si: tuple[tuple[str, Fraction], ...] = () if name == "1" else ((name, one),)
        found[name] = Unit(one, 0, _dimension_of(base), si)
    for name, (ratio, turns, text) in _OTHERS.items():
        si, made = _of_base(text), Unit()
        for base, power in si:
            made = made.times(found[base].power(power))
        found[name] = made._replace(ratio=Fraction(ratio), turns=turns)
    return found


ROWS: Mapping[str, Unit] = _table()
"""All units by name, without prefixes."""
SPELLINGS: Mapping[str, str] = {"°": "deg", "Ω": "ohm", "′": "arcmin", "″": "arcsec"}
"""Other spellings of units, by letters of their own."""


def named(name: str) -> Unit | None:
    """Return the unit of a name, with its prefix if it has one; None for what is none.

    >>> named("mN").ratio, named("furlong")
    (Fraction(1, 1000), None)
    """
    name = SPELLINGS.get(name, name)
    if name in ROWS:
        return ROWS[name]
    for length in (1, 2):
        prefix, rest = name[:length], SPELLINGS.get(name[length:], name[length:])
        if prefix in PREFIXES and rest in _PREFIXED:
            row = ROWS[rest]
            return row._replace(ratio=row.ratio * Fraction(10) ** PREFIXES[prefix])
        if prefix == "u" and rest in _PREFIXED:  # where a keyboard has no µ
            return ROWS[rest]._replace(ratio=ROWS[rest].ratio / 10**6)
    return None


# -- texts ---------------------------------------------------------------------------------------------

_NUMBER = r"-?[0-9]{1,3}"
_TOKEN = re.compile(
    rf"\s*(?:(?P<name>[^\W\d_]+|[°′″%]|1(?![0-9]))|(?P<power>(?:\^|\*\*)\s*(?:{_NUMBER}|\(\s*{_NUMBER}"
    rf"(?:\s*/\s*[0-9]{{1,3}})?\s*\)))|(?P<mark>[*/()]))"
)


@dataclass(frozen=True)
class _Token:
    kind: str
    text: str


def read(text: str, where: str = "") -> Unit:
    """Return what a unit amounts to; nothing, or ``1``, is no unit.

    Raises `InputError` for unknown names, with a near spelling, and for what is no product of powers.

    >>> read("km/h").factor, read("km/h").dimension == dimension("m/s")
    (5/18, True)
    """
    if not is_text(text) or len(text) > MAX_LENGTH:
        got = f"{len(text)} characters" if is_text(text) else shown(text)
        raise _none(got, where, f"at most {MAX_LENGTH} characters")
    try:
        return _read(text)
    except InputError as error:
        raise error.at(where or error.where) from None


@lru_cache(maxsize=4096)
def _read(text: str, where: str = "") -> Unit:
    plain = _POWERS.sub(lambda m: "^" + m[0].translate(_RAISED), text.translate(_LETTERS))
    if not plain.strip():
        return Unit()
    reader = _Reader(text, list(_tokens(plain, text, where)), where)
    found = reader.product()
    if reader.tokens:
        raise _none(text, where)
    if any(abs(p) > MAX_EXPONENT for p in found.dimension):
        raise _none(text, where, f"powers to {MAX_EXPONENT} at most")
    return found


def _none(
    got: object, where: str, expected: str = "such as kg m^2/s", hint: str = ""
) -> InputError:
    return InputError("not a unit", where=where, got=got, expected=expected, hint=hint)


def _tokens(plain: str, text: str, where: str) -> Iterator[_Token]:
    place, end, kind = 0, len(plain.rstrip()), ""
    while place < end:
        match = _TOKEN.match(plain, place)
        before, kind = kind, str(match.lastgroup) if match else ""
        if match is None or (before == kind == "name" and match.start(kind) == place):
            raise _none(text, where)  # two names without room between them, as those of °C
        yield _Token(kind, match[kind])
        place = match.end()


class _Reader:
    """Goes through the tokens of a unit, from the first on."""

    def __init__(self, text: str, tokens: list[_Token], where: str) -> None:
        self.text, self.tokens, self.where = text, tokens[::-1], where

    @property
    def mark(self) -> str:
        """The mark that comes next; nothing where a name does."""
        return self.tokens[-1].text if self.tokens and self.tokens[-1].kind == "mark" else ""

    def product(self) -> Unit:
        """Return the unit up to the end, or to a closing bracket; of three strokes each is below."""
        found, below = self.factor(), False
        while self.tokens and self.mark != ")":
            if self.mark == "/":
                self.tokens.pop()
                found, below = found.times(self.raised(self.factor(), Fraction(-1))), True
                continue
            if below:
                hint = "put what is below the stroke in brackets, as W/(m K), or the stroke last"
                raise _none(self.text, self.where, "one factor behind a stroke", hint)
            if self.mark == "*":
                self.tokens.pop()
            found = found.times(self.factor())
        return found

    def factor(self) -> Unit:
        """Return a name or bracket with its power."""
        token = self.tokens.pop() if self.tokens else _Token("mark", "")
        if token.text == "(":
            found = self.product()
            if self.mark != ")":
                raise _none(self.text, self.where)
            self.tokens.pop()
        elif token.kind == "name":
            found = self.named(token.text)
        else:
            raise _none(self.text, self.where)
        if self.tokens and self.tokens[-1].kind == "power":
            return self.raised(found, self.exponent(self.tokens.pop().text))
        return found

    def exponent(self, text: str) -> Fraction:
        """Return the number of a power."""
        try:
            found = Fraction(re.sub(r"[\s^*()]", "", text))
        except ZeroDivisionError:
            raise _none(self.text, self.where) from None
        if abs(found) > MAX_EXPONENT:
            raise _none(self.text, self.where, f"powers to {MAX_EXPONENT} at most")
        return found

    def raised(self, unit: Unit, exponent: Fraction) -> Unit:
        """Return a power. Raises `InputError` for roots that are not exact."""
        try:
            return unit.power(exponent)
        except ValueError as error:
            raise _none(self.text, self.where, str(error)) from None

    def named(self, name: str) -> Unit:
        """Return the unit of a name. Raises `InputError` for an unknown one, with near spellings."""
        found = named(name)
        if found is None:
            raise InputError(
                f"unknown unit {name!r}", where=self.where, got=self.text,
                expected="such as kg m^2/s; the table of units is in the reference of scene files",
                hint=near_spelling(name),
            )  # fmt: skip
        return found


def near_spelling(name: str) -> str:
    """Return a hint: the unit in two words, or names that are close.

    >>> near_spelling("Nms"), near_spelling("newton"), near_spelling("meter")
    ('did you mean N m s?', 'did you mean N?', 'did you mean m?')
    """
    if name.casefold() in _WORDS:
        return f"did you mean {_WORDS[name.casefold()]}?"
    apart = _apart(name)
    if apart:
        return f"did you mean {' '.join(apart)}?"
    hint = near_matches(name, ROWS)
    return hint if hint.startswith("did") else ""


def _apart(name: str) -> tuple[str, ...]:
    """Return the names of SI that a word is made of without spaces, the longest first; or nothing."""
    for length in range(len(name), 0, -1):
        first, rest = name[:length], name[length:]
        if first in _BASE:
            after = _apart(rest) if rest else ()
            if after or not rest:
                return (first, *after)
    return ()


_WORDS: Mapping[str, str] = {
    word: unit
    for unit, words in {
        "m": "meter metre meters metres", "s": "sec second seconds", "min": "minute minutes mins",
        "h": "hr hrs hour hours", "kg": "kilogram kilograms kilo kgs", "g": "gram grams gr",
        "N": "newton newtons", "J": "joule joules", "W": "watt watts", "Pa": "pascal pascals",
        "Hz": "hertz", "rad": "radian radians rads", "deg": "degree degrees degs", "rev": "turn turns revs",
        "in": "inch inches", "ft": "foot feet", "lb": "pound pounds lbs lbm", "mi": "mile miles",
        "km/h": "kmh kph", "K": "kelvin", "V": "volt volts", "A": "ampere amperes amp amps",
        "kn": "knot knots kt kts", "t": "ton tonne tonnes", "ohm": "ohms", "deg/s": "dps",
    }.items()
    for word in words.split()
}  # fmt: skip
"""What words are as units."""


def dimension(unit: str, where: str = "") -> Dimension:
    """Return the dimension of a unit of SI without a factor; ``deg`` counts as one.

    Raises `InputError` for unknown units, for what is no product of powers, and for units with a factor.

    >>> dimension("kg m^2/s^2") == dimension("N m")
    True
    """
    return coherent(unit, where).dimension if unit != "deg" else NONE


def coherent(unit: str, where: str = "") -> Unit:
    """Return a unit of SI without a factor. Raises `InputError` for others, with the one to write."""
    found = read(unit, where)
    if not found.is_coherent:
        raise InputError(
            "not a unit of SI without a factor", where=where, got=unit, expected=found.text,
            hint=f'write the unit {found.text}; values may be in others, as "2 {unit}"',
        )  # fmt: skip
    return found


# -- values --------------------------------------------------------------------------------------------

_MEASURED = re.compile(
    r"\s*(?P<number>[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)"
    r"(?:\s*(?P<unit>(?![eE][-+]?[0-9])(?:[^\W\d_]|[°′″%]).*)|\s+(?P<below>1\s*/.*))",
    re.DOTALL,
)
"""A number and a unit: no formula, in which nothing stands beside a number without a sign between them."""


class Measure(NamedTuple):
    """A value with its unit: ``value`` in the unit ``unit.text`` of SI, exactly."""

    value: Expr
    unit: Unit


def measure(text: str, where: str = "") -> Measure | None:
    """Return a number with a unit, exactly, in SI; None for what is not of that form.

    Raises `InputError` for unknown units.

    >>> measure("30 deg").value, measure("100 rpm").value, measure("2 in").value, measure("2*m")
    (pi/6, 10*pi/3, 127/2500, None)
    """
    found = _MEASURED.fullmatch(text) if len(text) <= 2 * MAX_LENGTH else None
    if found is None:
        return None
    unit = read((found["unit"] or found["below"]).rstrip(), where)
    number = Fraction(found["number"])
    return Measure(sp.Rational(number.numerator, number.denominator) * unit.factor, unit)


def has_unit(given: Any) -> bool:
    """Return whether a value is a text that is a number with a unit."""
    return is_text(given) and measure(given) is not None


def in_unit(text: str, unit: str, where: str = "") -> Expr | None:
    """Return a number with a unit in SI, exactly, where it is to have the dimension of ``unit``.

    ``unit``: of SI; nothing where that is not known. None for what is no number with a unit. Raises
    `InputError` for unknown units, and other dimensions.

    >>> in_unit("5 km/h", "m/s"), in_unit("5*v", "m/s")
    (25/18, None)
    """
    found = measure(text, where)
    if found is None:
        return None
    if unit and found.unit.dimension != read(unit).dimension:
        raise InputError(
            "a value has another dimension", where=where, got=f"{text.strip()}, in {found.unit.text}",
            expected=f"a value in {unit if unit != '1' else 'no unit, or an angle'}",
        )  # fmt: skip
    return found.value


def nearest(value: Expr) -> float:
    """Return the double that is nearest to an exact value."""
    return float(value if value.is_Rational else sp.N(value, 40))


def number_in(given: Any, unit: str, where: str = "") -> Any:
    """Return a text that is a number, with a unit or without, as a number in SI; else what is given.

    ``unit``: of SI, in which it is to be. Raises `InputError` as `in_unit`, for texts that are no numbers.

    >>> number_in("30 deg", "rad"), number_in(2, "m"), number_in("1e3", "m")
    (0.5235987755982989, 2, 1000.0)
    """
    if not isinstance(given, str):
        return given
    found = in_unit(given, unit, where) if is_text(given) else None
    if found is not None:
        return nearest(found)
    try:
        return float(Fraction(given.strip())) if len(given) <= MAX_LENGTH else None
    except (ValueError, ZeroDivisionError, OverflowError):
        hint = f"in {unit}" if unit else "of a unit of SI or others"
        raise InputError(
            "not a number", where=where, got=shown(given),
            expected='a number, or a number with a unit in quotes, as "30 deg"', hint=hint,
        ) from None  # fmt: skip
