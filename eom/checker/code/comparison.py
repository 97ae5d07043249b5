"""What is wrong with code for the rates of a system, found from its values at random points alone.

The code is a black box: points go in, rates come out. Where these differ from the system's, the difference
is compared with named terms: of the rate itself, of the other rates, and of either with one slip. A
multiple of a term at all points is that term with a wrong sign or factor, or one that is missing. Before
that, slips that touch everything are tried: outputs or arguments exchanged, degrees for radians.

Terms that the difference of two rates may be made of, the likely ones first.

First the terms of the rate itself: as they are printed, then multiplied out; then those with one slip in
the place of the right ones; then terms of other rates, which are too much.

Fits of numbers at several points: one or two terms with factors that can be found.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from itertools import combinations
from typing import Any

import sympy as sp
from mpmath import MPContext

from eom.checker.mean.model import Model
from eom.errors import InputError
from eom.exact.rings import ARITHMETIC, Evaluation, Row, arguments, none
from eom.system import Expr, System

DIGITS = 30
MP = MPContext()
MP.dps = DIGITS

Number = Any
"""A number of mpmath."""

FUNCTIONS: dict[Any, Callable[..., Number]] = {
    sp.sin: MP.sin,
    sp.cos: MP.cos,
    sp.tan: MP.tan,
    sp.cot: MP.cot,
    sp.sec: MP.sec,
    sp.csc: MP.csc,
    sp.asin: MP.asin,
    sp.acos: MP.acos,
    sp.atan: MP.atan,
    sp.atan2: MP.atan2,
    sp.exp: MP.exp,
    sp.log: MP.log,
    sp.sinh: MP.sinh,
    sp.cosh: MP.cosh,
    sp.tanh: MP.tanh,
    sp.Abs: MP.fabs,
    sp.sign: MP.sign,
}
"""Functions that have values."""


class _Digits:
    """Numbers of mpmath as a ring."""

    total, product, power = staticmethod(MP.fsum), staticmethod(MP.fprod), staticmethod(MP.power)

    def of(self, numerator: int, denominator: int = 1) -> Number:
        """Return a fraction."""
        return MP.mpf(numerator) / denominator

    def reduce(self, value: Number) -> Number:
        """Return the number itself."""
        return value

    def inverse(self, value: Number) -> Number:
        """Return the reciprocal."""
        return 1 / value


def _power(_: Numbers, node: Expr, values: list[Number]) -> Number:
    return MP.power(values[0], int(node.exp) if node.exp.is_Integer else values[1])


_CONSTANT = Row(none, lambda _, n, __: MP.mpf(str(n.evalf(DIGITS))))
_FUNCTION = Row(arguments, lambda _, n, v: FUNCTIONS[type(n)](*v))


@dataclass
class Numbers(Evaluation):
    """Values at a point, ``given`` by symbol; every subexpression is computed once."""

    given: Mapping[Expr, Number]
    memo: dict[Expr, Number] = field(default_factory=dict)

    ring = _Digits()

    def symbol(self, symbol: Expr) -> Number:
        """Return the given value of a symbol."""
        if symbol not in self.given:
            raise InputError("a symbol without a value", got=symbol)
        return self.given[symbol]

    def other(self, node: Expr) -> Number:
        """Refuse what has no value."""
        raise InputError("a function without a value", got=type(node).__name__)

    def size(self, expression: Expr) -> Number:
        """Return the sum of the magnitudes of terms: what rounding errors are measured by."""
        terms = sp.Add.make_args(sp.expand_mul(expression))
        return MP.fsum(abs(self.value(t)) for t in terms)


Numbers.rows = (
    ARITHMETIC
    | {sp.Pow: Row(arguments, _power), sp.Float: _CONSTANT, sp.NumberSymbol: _CONSTANT}
    | dict.fromkeys(FUNCTIONS, _FUNCTION)
)


POINTS = 24
ROUGH = 4
"""Digits of agreement below which a rate is wrong; above, up to `RIGHT`, it is right but rough."""
TRIES = 200
ARGUMENTS = "arguments exchanged"


@dataclass(frozen=True)
class Point:
    """Time, states, and parameters followed by inputs, as doubles."""

    time: float
    states: tuple[float, ...]
    parameters: tuple[float, ...]


@dataclass(frozen=True)
class Mistake:
    """What is wrong with one output, from 0; -1 for all: the slip (a row of a table) in words, the term."""

    output: int
    kind: str
    text: str
    term: str = ""


@dataclass(frozen=True)
class CodeReport:
    """What was found: the mistakes, none if all rates are right; to how many digits they agree."""

    name: str
    states: tuple[str, ...]
    parameters: tuple[str, ...]
    mistakes: tuple[Mistake, ...]
    digits: float

    @property
    def is_right(self) -> bool:
        """Whether nothing is wrong."""
        return not self.mistakes


# -- points ------------------------------------------------------------------------------------------


def argument_names(system: System) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of ``y``, and those of ``p``: parameters, then inputs."""
    return system.state_names, (*system.parameter_names, *system.input_names)


def points(
    model: Model, count: int = POINTS, seed: int = 0, fixed: dict[str, float] | None = None
) -> tuple[Point, ...]:
    """Return random points: what is given of the parameters holds, quaternions have unit norm.

    ``fixed``: values of parameters that the code has built in. Points near singularities are left out.
    """
    generator = random.Random(seed)  # noqa: S311 - reproducible points, no secrets
    found: list[Point] = []
    for _ in range(TRIES):
        point = _drawn(model, generator, fixed or {})
        if not _singular(model.system, point):
            found.append(point)
        if len(found) == count:
            return tuple(found)
    raise InputError("all points that were drawn are near a singularity", where=model.name)


def _drawn(model: Model, generator: random.Random, fixed: dict[str, float]) -> Point:
    s = model.system
    own = {q.symbol: generator.uniform(0.4, 3.0) for q in (*s.parameters, *s.inputs)}
    for r in model.given:
        own |= {b: own[a] for a, b in r.equal} | {z: 0.0 for z in r.zero if z in own}
    own |= {q.symbol: fixed[q.name] for q in (*s.parameters, *s.inputs) if q.name in fixed}
    start = {q.symbol: generator.uniform(0.2, 1.4) * generator.choice((-1, 1)) for q in s.states}
    for assumption in s.assumptions:
        used = set().union(*(e.free_symbols for e in assumption.vanish))
        if used and used <= start.keys():
            start |= _attitude([q.symbol for q in s.states if q.symbol in used], start)
    return Point(generator.uniform(0.1, 2.0), tuple(start.values()), tuple(own.values()))


def _attitude(symbols: list[Expr], start: dict[Expr, float]) -> dict[Expr, float]:
    """Return a unit quaternion, or the direction cosines of one."""
    q = [start[s] for s in symbols[:4]]
    norm = sum(v * v for v in q) ** 0.5
    a, b, c, d = (v / norm for v in q)
    if len(symbols) == 4:
        return dict(zip(symbols, (a, b, c, d), strict=True))
    rows = (
        (1 - 2 * (c * c + d * d), 2 * (b * c + a * d), 2 * (b * d - a * c)),
        (2 * (b * c - a * d), 1 - 2 * (b * b + d * d), 2 * (c * d + a * b)),
        (2 * (b * d + a * c), 2 * (c * d - a * b), 1 - 2 * (b * b + c * c)),
    )
    return dict(zip(symbols, (v for row in rows for v in row), strict=True))


def _singular(system: System, point: Point) -> bool:
    numbers = numbers_at(system, point)
    return any(abs(numbers.value(system.expand(s.expression))) < 0.2 for s in system.singularities)


def numbers_at(system: System, point: Point) -> Numbers:
    """Return the values of a system's quantities at a point."""
    symbols = [q.symbol for q in (*system.states, *system.parameters, *system.inputs)]
    values = (*point.states, *point.parameters)
    given = {s: MP.mpf(v) for s, v in zip(symbols, values, strict=True)}
    given[system.time] = MP.mpf(point.time)
    numbers = Numbers(given)
    for d in system.definitions:
        given[d.symbol] = numbers.value(d.expression)
    return numbers


# -- the comparison ----------------------------------------------------------------------------------


def compare(model: Model, at: Sequence[Point], outputs: Sequence[Sequence[float]]) -> CodeReport:
    """Return what is wrong with ``outputs``, the rates that the code gave at the points ``at``."""
    system = model.system
    case = _Case(system, [numbers_at(system, p) for p in at], outputs)
    names = argument_names(system)
    bad = [i for i in range(len(system.states)) if case.digits(i) < RIGHT]
    least = min((case.digits(i) for i in range(len(system.states))), default=RIGHT)
    if not bad or least >= ROUGH:
        return CodeReport(model.name, *names, (), least)
    mistakes = _everywhere(case, bad) or tuple(_of_output(case, i) for i in bad)
    return CodeReport(model.name, *names, mistakes, least)


class _Case:
    """The true rates at the points, how large their terms are, and what the code gave."""

    def __init__(
        self, system: System, numbers: list[Numbers], outputs: Sequence[Sequence[float]]
    ) -> None:
        self.system, self.numbers = system, numbers
        n = len(system.states)
        if any(len(row) != n for row in outputs):
            got = sorted({len(row) for row in outputs})
            raise InputError("the code gives another number of rates", got=got, expected=n)
        self.given = [[MP.mpf(row[i]) for row in outputs] for i in range(n)]
        columns = [rates_at(system, p) for p in numbers]
        self.true = [[c[i] for c in columns] for i in range(n)]
        self.size = [[_size(system, p, i) for p in numbers] for i in range(n)]

    def digits(self, i: int) -> float:
        """To how many digits output i is right, measured by its largest terms."""
        return digits(self.given[i], self.true[i], self.size[i])

    def agrees(self, i: int, values: Sequence[Number]) -> bool:
        """Whether the code gave these values."""
        return digits(self.given[i], values, self.size[i]) >= RIGHT

    def values(self, expression: Expr, count: int | None = None) -> list[Number]:
        """Return the values of an expression at all points, or the first of them."""
        return [p.value(expression) for p in self.numbers[:count]]

    def explained(self, change: Change) -> bool:
        """Whether the code gave, point by point, the true rates for other arguments."""
        return all(self._is_given(j, change) for j in range(len(self.numbers)))

    def _is_given(self, j: int, change: Change) -> bool:
        defined = {d.symbol for d in self.system.definitions}
        own = change({s: v for s, v in self.numbers[j].given.items() if s not in defined})
        numbers = Numbers(own)
        for d in self.system.definitions:
            own[d.symbol] = numbers.value(d.expression)
        rates = rates_at(self.system, numbers)
        columns = zip(self.given, rates, self.size, strict=True)
        return all(digits([g[j]], [r], [s[j]]) >= RIGHT for g, r, s in columns)


def rates_at(system: System, numbers: Numbers) -> list[Number]:
    """Return the rates at a point; a mass matrix is solved for them."""
    right = [numbers.value(r) for r in system.rates]
    if system.mass_matrix is None:
        return right
    rows = [[numbers.value(e) for e in row] for row in system.mass_matrix.tolist()]
    return list(MP.lu_solve(MP.matrix(rows), MP.matrix(right)))


def _size(system: System, numbers: Numbers, i: int) -> Number:
    if system.mass_matrix is None:
        return numbers.size(system.rates[i])
    return MP.fsum(numbers.size(r) for r in system.rates)


# -- slips that touch everything ---------------------------------------------------------------------


def _everywhere(case: _Case, bad: list[int]) -> tuple[Mistake, ...]:
    """Return the one slip that explains all outputs, if there is one."""
    exchanged = [_source(case, i) for i in bad]
    if all(k is not None for k in exchanged) and len(bad) > 1:
        names = case.system.state_names
        pairs = zip(bad, exchanged, strict=True)
        held = ", ".join(f"output {i} holds the rate of {names[k or 0]}" for i, k in pairs)
        return (Mistake(-1, "outputs exchanged", f"outputs exchanged: {held}"),)
    for kind, text, change in _changes(case.system):
        if (len(bad) > 1 or kind != ARGUMENTS) and case.explained(change):
            return (Mistake(-1, kind, text),)
    return ()


def _source(case: _Case, i: int) -> int | None:
    others = (k for k in range(len(case.true)) if k != i and case.agrees(i, case.true[k]))
    return next(others, None)


Change = Callable[[dict[Expr, Number]], dict[Expr, Number]]


def _changes(system: System) -> Iterator[tuple[str, str, Change]]:
    """Yield slips in reading the arguments: the kind, words, and what is read."""
    groups = (system.states, (*system.parameters, *system.inputs))
    for a, b in (pair for group in groups for pair in combinations(group, 2)):
        text = f"arguments exchanged: {a.name} and {b.name}"
        yield ARGUMENTS, text, partial(_exchanged, a.symbol, b.symbol)
    angles = [q.symbol for q in system.states if q.unit == "rad"]
    if angles:
        for factor, read, meant in _ANGLES:
            text = f"angles in {meant} are taken for {read}"
            yield "units of angles", text, partial(_scaled_angles, angles, factor)


_ANGLES = ((MP.pi / 180, "degrees", "radians"), (180 / MP.pi, "numbers of degrees", "radians"))
"""The factor on angles, what they are read as, and what they are."""

Values = dict[Expr, Number]


def _exchanged(a: Expr, b: Expr, values: Values) -> Values:
    return {**values, a: values[b], b: values[a]}


def _scaled_angles(angles: list[Expr], factor: Number, values: Values) -> Values:
    return {**values, **{a: values[a] * factor for a in angles}}


# -- slips in one output -----------------------------------------------------------------------------


def _of_output(case: _Case, i: int) -> Mistake:
    """Return what is wrong with one output."""
    if any(not MP.isfinite(v) for v in case.given[i]):
        return Mistake(i, "not a number", f"output {i} is not a finite number at some points")
    source = _source(case, i)
    if source is not None:
        name = case.system.state_names[source]
        return Mistake(i, "another output", f"output {i} holds the rate of {name}")
    whole = fitted(case.given[i], case.true[i], case.size[i])
    if whole is not None:
        return _scaled(i, whole)
    if case.system.mass_matrix is not None:
        return _unknown(case, i)
    return _by_terms(case, i) or _unknown(case, i)


def _scaled(i: int, factor: Fit) -> Mistake:
    if factor.words == "-1":
        return Mistake(i, "wrong sign", f"output {i} has the wrong sign")
    return Mistake(i, "wrong factor", f"output {i} is {factor.words} times what it should be")


def _by_terms(case: _Case, i: int) -> Mistake | None:
    difference = [a - b for a, b in zip(case.given[i], case.true[i], strict=True)]
    own = []
    for candidate in candidates(case.system, i):
        own += [candidate] if candidate.own else []
        if not likely(difference, case.values(candidate.expression, FEW), case.size[i]):
            continue
        fit = fitted(difference, case.values(candidate.expression), case.size[i])
        if fit is not None and candidate.accepts(fit):
            kind, text = candidate.worded(fit)
            return Mistake(i, kind, f"{text} in output {i}", str(candidate.expression))
    pair = paired(difference, [case.values(c.expression) for c in own], case.size[i])
    if pair is None:
        return None
    text = " and ".join(dict.fromkeys(own[k].worded(fit)[1] for k, fit in pair))
    return Mistake(i, "two slips", f"{text} in output {i}")


def _unknown(case: _Case, i: int) -> Mistake:
    errors = [
        abs(a - b) / s for a, b, s in zip(case.given[i], case.true[i], case.size[i], strict=True)
    ]
    text = f"output {i} differs by up to {float(max(errors)):.2g} of its terms; no named term explains it"
    return Mistake(i, "unexplained", text)


MAX_TERMS = 60
MAX_SLIPS = 600


@dataclass(frozen=True)
class Candidate:
    """A term whose multiple the difference may be.

    ``own``: a term of the rate; ``right``: the term in whose place a wrong one stands, if it is that.
    """

    expression: Expr
    own: bool = False
    right: Expr | None = None
    wrong: Expr | None = None

    def accepts(self, fit: Fit) -> bool:
        """Whether a factor makes sense: a term that stands for another one does so once."""
        return self.right is None or fit.words == "1"

    def worded(self, fit: Fit) -> tuple[str, str]:
        """Return the kind of a slip and its words, for the factor of the difference."""
        if self.right is not None:
            return "wrong term", f"{self.wrong} instead of {self.right}"
        if not self.own:
            times = "" if fit.words == "1" else f"{fit.words} times "
            return "term too much", f"term too much: {times}{self.expression}"
        if fit.words == "-1":
            return "missing term", f"missing term {self.expression}"
        if fit.words == "-2":
            return "wrong sign", f"wrong sign of term {self.expression}"
        return "wrong factor", f"term {self.expression} is {_more(fit)} times what it should be"


def _more(fit: Fit) -> str:
    try:
        return str(Fraction(fit.words) + 1)
    except ValueError:
        return f"1 + {fit.words}"


def candidates(system: System, i: int) -> Iterator[Candidate]:
    """Yield what may be too much or missing in a rate, each expression once."""
    own = terms(system, system.rates[i])
    others = [t for k, r in enumerate(system.rates) if k != i for t in terms(system, r)]
    yield from (Candidate(t, own=True) for t in own)
    made = (c for t in own for c in _slips(system, t))
    yield from (c for _, c in zip(range(MAX_SLIPS), made, strict=False))
    yield from (Candidate(t) for t in dict.fromkeys(others) if t not in own)


def terms(system: System, rate: Expr) -> list[Expr]:
    """Return the terms of a rate: as it stands, multiplied out, and with definitions written out."""
    forms = (
        _distributed(rate),
        sp.expand(rate),
        _distributed(system.expand(rate)),
        sp.expand(system.expand(rate)),
    )
    found = [t for form in forms for t in sp.Add.make_args(form)]
    return [t for t in dict.fromkeys(found) if not t.is_number][:MAX_TERMS]


def _distributed(rate: Expr) -> Expr:
    """Divide every term of a numerator by the denominator, and nothing more."""
    above, below = sp.fraction(rate)
    return sp.Add(*(t / below for t in sp.Add.make_args(above)))


def _slips(system: System, term: Expr) -> Iterator[Candidate]:
    """Yield what the difference is if a term has one slip."""
    for wrong in dict.fromkeys(_changed(system, term)):
        if wrong != term and not wrong.has(sp.zoo, sp.nan):
            yield Candidate(wrong - term, right=term, wrong=wrong)


def _changed(system: System, term: Expr) -> Iterator[Expr]:
    """Yield a term with one symbol for another, one function for another, or another power."""
    variables = (*system.states, *system.parameters, *system.inputs)
    units = {q.symbol: q.unit for q in (*variables, *(d.quantity for d in system.definitions))}
    places = sorted(term.free_symbols & units.keys(), key=str)
    for a in places:
        for b, unit in units.items():
            if a != b and units[a] == unit:
                yield from _with_exchanged(term, a, b)
        yield term * a
        yield term / a
    for f in sorted(term.atoms(sp.sin, sp.cos), key=sp.default_sort_key):
        other = sp.cos if f.func is sp.sin else sp.sin
        yield term.subs(f, other(*f.args))
        yield term.subs(f, f.args[0])
        yield term / f


def _with_exchanged(term: Expr, a: Expr, b: Expr) -> Iterator[Expr]:
    """Yield a term with one symbol for another: everywhere, and exchanged."""
    yield term.xreplace({a: b})
    yield term.xreplace({a: b, b: a})


RIGHT = 9.0
"""Digits from which on doubles are taken for equal: rounding in code of any order leaves more."""
LARGEST = 12
"""Numerators and denominators of factors that are printed as fractions."""

FEW = 3
"""Points that are looked at first."""

_SPECIAL: tuple[tuple[str, Number], ...] = (
    ("pi/180", MP.pi / 180),
    ("180/pi", 180 / MP.pi),
    ("2*pi", 2 * MP.pi),
    ("1/(2*pi)", 1 / (2 * MP.pi)),
)


@dataclass(frozen=True)
class Fit:
    """A factor in words and as a number."""

    words: str
    value: Number


def digits(given: Sequence[Number], true: Sequence[Number], size: Sequence[Number]) -> float:
    """Return to how many digits values agree at all points, measured by ``size``; 17 at most."""
    worst = MP.mpf(0)
    for a, b, s in zip(given, true, size, strict=True):
        if not (MP.isfinite(a) and MP.isfinite(b)):
            return 0.0
        error = abs(a - b)
        worst = max(worst, error / s if s else error)
    return 17.0 if worst == 0 else min(17.0, float(-MP.log10(worst)))


def likely(values: Sequence[Number], term: Sequence[Number], size: Sequence[Number]) -> bool:
    """Return whether a term may make the values, by the first of the points."""
    if not all(map(MP.isfinite, (*values[:FEW], *term))) or not term[0]:
        return False
    factor = values[0] / term[0]
    made = [factor * t for t in term]
    return digits(values[: len(term)], made, size[: len(term)]) >= RIGHT - 1


def fitted(values: Sequence[Number], term: Sequence[Number], size: Sequence[Number]) -> Fit | None:
    """Return the factor by which a term makes the values at all points, if it can be found."""
    weight = MP.fsum(t * t for t in term)
    if not weight or not all(map(MP.isfinite, (*values, *term))):
        return None
    factor = MP.fsum(v * t for v, t in zip(values, term, strict=True)) / weight
    fit = named(factor)
    made = [fit.value * t for t in term] if fit is not None else []
    return fit if fit is not None and digits(values, made, size) >= RIGHT else None


def paired(
    values: Sequence[Number], terms: Sequence[Sequence[Number]], size: Sequence[Number]
) -> tuple[tuple[int, Fit], tuple[int, Fit]] | None:
    """Return two terms by their places, with factors that can be found, that make the values."""
    for j, k in combinations(range(len(terms)), 2):
        solved = _solved(values[: FEW + 1], terms[j][: FEW + 1], terms[k][: FEW + 1])
        fits = [named(c) for c in solved] or [None, None]
        a, b = fits
        if a is not None and b is not None:
            made = [a.value * x + b.value * y for x, y in zip(terms[j], terms[k], strict=True)]
            if digits(values, made, size) >= RIGHT:
                return (j, a), (k, b)
    return None


def _solved(v: Sequence[Number], x: Sequence[Number], y: Sequence[Number]) -> tuple[Number, ...]:
    """Return the factors of two terms by least squares; none where the terms are as good as one."""
    xx, yy, xy = _dot(x, x), _dot(y, y), _dot(x, y)
    vx, vy = _dot(v, x), _dot(v, y)
    determinant = xx * yy - xy * xy
    if determinant <= MP.mpf(10) ** -12 * xx * yy:
        return ()
    return (vx * yy - vy * xy) / determinant, (vy * xx - vx * xy) / determinant


def _dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    return MP.fsum(x * y for x, y in zip(a, b, strict=True))


def named(factor: Number) -> Fit | None:
    """Return a number as a small fraction, or as one of the factors between units of angles."""
    if not MP.isfinite(factor) or abs(factor) > 1000:
        return None
    fraction = Fraction(float(factor)).limit_denominator(LARGEST)
    exact = MP.mpf(fraction.numerator) / fraction.denominator
    if fraction and abs(factor - exact) <= MP.mpf(10) ** -8 and abs(fraction.numerator) <= LARGEST:
        return Fit(str(fraction), exact)
    for words, value in _SPECIAL:
        if abs(factor / value - 1) <= MP.mpf(10) ** -8:
            return Fit(words, value)
        if abs(factor / value + 1) <= MP.mpf(10) ** -8:
            return Fit(f"-{words}", -value)
    return None
